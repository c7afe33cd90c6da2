"""Demonstrations in the tones of the site, and eyes that learn faster than what is behind them."""

from dataclasses import replace

import numpy as np
import pytest

from shared.goals.language.encoder import shared_encoder
from shared.policies.examples import Examples
from shared.policies.fit import sources_of
from shared.policies.fitter import FitSettings
from shared.policies.sources import Source
from shared.policies.tones import retoned, tones_of
from tests.unit.policies.scenes import moving
from tests.unit.policies.test_high_level import QUICK, high_level, learn

DIM = np.random.default_rng(1).integers(60, 100, (9, 2, 64, 64, 3), np.uint8)
BRIGHT = np.random.default_rng(2).integers(120, (180, 200, 160), (5, 2, 64, 64, 3), np.uint8)
"""Levels that no channel leaves on the way from one to the other."""


def sources(share: float) -> tuple[list[Source], Examples, Examples]:
    """Demonstrations and corrections that look otherwise, and where batches of both come from."""
    policy, shown = high_level(), moving(40)
    count = len(shown.images)
    shown = replace(shown, images=np.resize(DIM, (count, *DIM.shape[1:])))
    site = replace(shown, images=np.resize(BRIGHT, (count, *DIM.shape[1:])))
    settings = FitSettings(batch=400, retoned=share)
    found = sources_of(shown, site, settings, policy.bank, shared_encoder(), policy.net)
    return found, shown, site


def test_pictures_take_the_tones_of_others_view_by_view() -> None:
    others = BRIGHT.copy()
    others[:, 1] //= 2
    new = tones_of(others)
    assert np.abs(new.mean[0] - others[:, 0].mean((0, 1, 2))).max() < 0.01
    assert np.abs(new.spread[1] - others[:, 1].std((0, 1, 2))).max() < 0.01
    found = tones_of(retoned(DIM, tones_of(DIM), new))
    assert np.abs(found.mean - new.mean).max() < 0.5
    assert np.abs(found.spread - new.spread).max() < 0.5


def test_what_is_where_stays_as_it_is() -> None:
    made = retoned(DIM, tones_of(DIM), tones_of(BRIGHT))
    for channel in range(3):
        before, after = DIM[0, 0, ..., channel].ravel(), made[0, 0, ..., channel].ravel()
        order = np.argsort(before, kind="stable")
        assert (np.diff(after[order].astype(int)) >= 0).all()


def test_a_view_of_one_colour_is_moved_and_not_stretched() -> None:
    plain = np.full((2, 2, 64, 64, 3), 40, np.uint8)
    new = tones_of(np.full((1, 2, 64, 64, 3), 90, np.uint8))
    assert (retoned(plain, tones_of(plain), new) == 90).all()


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_share_of_the_demonstrations_is_shown_in_the_tones_of_the_corrections(
    share: float,
) -> None:
    (demonstrated, corrected), shown, site = sources(share)
    rng = np.random.default_rng(0)
    batch, others = demonstrated.draw(rng), corrected.draw(rng)
    dim, bright = shown.images.mean(), site.images.mean()
    for pictures in (batch.images, batch.glimpses[batch.seen]):
        levels = pictures.reshape(len(pictures), -1).mean(1)
        assert np.minimum(np.abs(levels - dim), np.abs(levels - bright)).max() < 5
        assert np.mean(levels > (dim + bright) / 2) == pytest.approx(share, abs=0.15)
    assert np.abs(others.images.mean() - bright) < 1
    assert np.array_equal(demonstrated.at(np.arange(40)).images, shown.present)  # As ever.


def test_what_is_behind_the_eyes_learns_by_its_own_rate() -> None:
    policy = high_level()
    before = policy.tensors()
    learn(policy, None, QUICK.model_copy(update={"steps": 5, "mind_rate": 0.001}))
    moved = {
        name: float(np.abs(array - before[name]).max()) for name, array in policy.tensors().items()
    }
    fast = {name for name in moved if name.startswith(("eyes.", "glance.", "text."))}
    slow = [change for name, change in moved.items() if name not in fast]
    assert 0 < max(slow) < 1e-4
    for part in ("eyes.", "glance.", "text."):
        assert max(moved[name] for name in fast if name.startswith(part)) > 1e-4
