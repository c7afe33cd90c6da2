"""Sites: where the cell stands, as a settings file. Light, shades, cameras, slipping hands."""

import tomllib
from importlib import resources
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from shared.errors import nearest
from shared.workcell import clutter
from shared.workcell.errors import InvalidSite
from shared.workcell.tasks.manners import Manner

Level = Annotated[float, Field(ge=0.0, le=1.0)]
Colour = tuple[Level, Level, Level]
Rate = Annotated[float, Field(ge=0.0, le=60.0)]
Offset = tuple[float, float, float]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Light(_Part):
    """The lamp above the table.

    level: brightness of the direct light. ambient: brightness of the shade.
    direction: where the light goes, need not have unit length. tint: its colour.
    """

    level: Level = 0.55
    ambient: Level = 0.30
    direction: Offset = (0.25, 0.35, -1.0)
    tint: Colour = (1.0, 0.98, 0.94)


class Shades(_Part):
    """Colours of the furniture, and how far the objects' colours differ from the usual.

    hue: turn of the hue as a part of the circle. value: factor on the brightness.
    saturation: factor. They hold for all objects, `objects` overrides hue by name.
    """

    table: Colour = (0.50, 0.34, 0.22)
    tray: Colour = (0.27, 0.26, 0.26)
    plate: Colour = (0.93, 0.92, 0.88)
    bin: Colour = (0.16, 0.36, 0.68)
    tub: Colour = (0.62, 0.64, 0.66)
    wall: Colour = (0.72, 0.77, 0.80)
    hue: Annotated[float, Field(ge=-0.05, le=0.05)] = 0.0
    saturation: Annotated[float, Field(ge=0.5, le=1.5)] = 1.0
    value: Annotated[float, Field(ge=0.5, le=1.5)] = 1.0
    objects: dict[str, Annotated[float, Field(ge=-0.05, le=0.05)]] = {}


class CameraShift(_Part):
    """How far a camera stands, and aims, off its place in the lab, [m]."""

    position_m: Offset = (0.0, 0.0, 0.0)
    aim_m: Offset = (0.0, 0.0, 0.0)


class People(_Part):
    """What people do at the table while the robot works: how often, a minute, on average.

    move_plate: push the plate a few centimetres. put_back: take something that was put away, and
    lay it on the table again. move_thing: lay something on the table elsewhere.
    """

    move_plate: Rate = 0.0
    put_back: Rate = 0.0
    move_thing: Rate = 0.0


class Prompts(_Part):
    """How prompts are put here.

    manner: plain, polite or chatty. constraints: share of prompts that say what fits ("a vegetarian
    sandwich"), not what is wanted.
    """

    manner: Manner = "plain"
    constraints: Level = 0.0


class Site(_Part):
    """One place where the cell stands.

    name: as in the file's name. slip_rate: chance that a holding hand opens in a control step.
    slip_steps: how long it stays open. distractors: things that lie around outside the tray and
    belong to no task.
    """

    name: str
    light: Light = Light()
    shades: Shades = Shades()
    top: CameraShift = CameraShift()
    angle: CameraShift = CameraShift()
    slip_rate: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0
    slip_steps: Annotated[int, Field(ge=1, le=100)] = 10
    people: People = People()
    prompts: Prompts = Prompts()
    distractors: Annotated[int, Field(ge=0, le=clutter.MOST)] = 0


def site_names() -> tuple[str, ...]:
    """The sites that come with the cell."""
    folder = resources.files("shared.workcell") / "sites"
    return tuple(sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".toml")))


def load_site(name_or_path: str | Path) -> Site:
    """Read a site by its name, or from a file of one's own that ends in .toml.

    Raises:
        InvalidSite: no such site, or the file says something that a site cannot say.
    """
    text = str(name_or_path)
    if text.endswith(".toml"):
        return _read(Path(text))
    if text not in site_names():
        raise InvalidSite(f"unknown site {text!r}; the sites are {', '.join(site_names())}")
    return _parse((resources.files("shared.workcell") / "sites" / f"{text}.toml").read_text(), text)


def _read(path: Path) -> Site:
    try:
        return _parse(path.read_text(), path.name)
    except OSError as error:
        raise InvalidSite(f"cannot read the site {path}: {error.strerror}") from error


def _parse(text: str, source: str) -> Site:
    try:
        return Site.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InvalidSite(f"{source}: {error}") from error
    except ValidationError as error:
        raise InvalidSite(f"{source}: {_explain(error)}") from error


def _explain(error: ValidationError) -> str:
    first = error.errors()[0]
    where = [str(part) for part in first["loc"]]
    if first["type"] != "extra_forbidden":
        return f"{'.'.join(where)}: {first['msg']}"
    part: type[BaseModel] = Site
    for name in where[:-1]:
        annotation = part.model_fields[name].annotation
        assert isinstance(annotation, type)  # only parts nest, and a part is a model
        part = annotation
    return f"unknown key {'.'.join(where)!r}{nearest(where[-1], part.model_fields)}"
