"""What people call a thing's colour is its colour at each site."""

import colorsys

import mujoco
import pytest

from shared.workcell.objects import OBJECT_NAMES, OBJECTS
from shared.workcell.scene import scene_xml
from shared.workcell.site import Shades, Site, load_site, site_names

FIXTURES = {"plate": "white", "bin": "blue", "tub": "grey"}
"""What the words that the reader is taught call them."""
CALLED = {item.name: item.colour for item in OBJECTS} | FIXTURES
HUES = (
    (15, "red"), (40, "brown"), (70, "yellow"), (170, "green"), (260, "blue"), (330, "purple"),
    (360, "red"),
)  # fmt: skip
"""Up to how many degrees of the circle of hues each colour goes."""
LEAST_COLOURED, LEAST_WHITE = 0.2, 0.85
"""Less saturation is white or grey, and white is brighter than that."""
PINK_SATURATION, PINK_VALUE = 0.6, 0.8
"""A red that is paler and brighter is pink."""


def named(red, green, blue):
    """The colour's name by its hue and brightness; each part 0 to 1."""
    hue, saturation, value = colorsys.rgb_to_hsv(red, green, blue)
    if saturation < LEAST_COLOURED:
        return "white" if value > LEAST_WHITE else "grey"
    name = next(name for end, name in HUES if hue * 360 <= end)
    pale = saturation < PINK_SATURATION and value > PINK_VALUE
    return "pink" if name == "red" and pale else name


def test_colours_are_told_by_hue_and_brightness():
    assert named(1.0, 0.0, 0.0) == named(0.8, 0.0, 0.1) == "red"
    assert named(1.0, 0.7, 0.75) == "pink"
    assert [named(*rgb) for rgb in ((0.4, 0.25, 0.1), (1.0, 0.9, 0.0))] == ["brown", "yellow"]
    assert [named(*rgb) for rgb in ((0.0, 0.5, 0.0), (0.0, 0.0, 1.0))] == ["green", "blue"]
    assert [named(*[level] * 3) for level in (0.95, 0.6)] == ["white", "grey"]


def seen_at(site):
    """The colour of each thing's body, or crust, as it is in white light, by its name."""
    model = mujoco.MjModel.from_xml_string(scene_xml(site))
    return {name: named(*colour_of(model, name)) for name in CALLED}


@pytest.mark.parametrize("site", site_names())
def test_a_thing_has_the_colour_that_it_is_called_by(site):
    """A seed changes no colour."""
    assert seen_at(load_site(site)) == CALLED


def test_a_site_that_turned_hues_too_far_would_be_noticed():
    seen = seen_at(Site(name="x", shades=Shades(hue=0.05)))
    assert {name for name in CALLED if seen[name] != CALLED[name]} >= {"cup", "can", "tomato"}


def colour_of(model, name):
    """Of the first part of a thing that is seen: others are laid on it."""
    body = model.body(name)
    first = int(body.geomadr[0]) + (name in OBJECT_NAMES)  # Before it lies what collides.
    material = model.geom_matid[first]
    rgba = model.geom_rgba[first] if material < 0 else model.mat_rgba[material]
    return [float(part) for part in rgba[:3]]
