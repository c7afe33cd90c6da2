"""The low level does not change by one bit, or the learner says so."""

from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from services.learner.frozen import FrozenLowLevel
from shared.errors import FrozenError, PolicyError
from tests.unit.learner.checkpoints import small_low_level, tamper


def test_an_untouched_low_level_passes_as_often_as_one_looks(tmp_path: Path) -> None:
    frozen = FrozenLowLevel(small_low_level(tmp_path))
    frozen.check()
    frozen.check()
    frozen.check_against(frozen.sha256)


def test_a_tampered_tensor_is_named(tmp_path: Path) -> None:
    folder = small_low_level(tmp_path)
    frozen = FrozenLowLevel(folder)
    tamper(folder)
    with pytest.raises(FrozenError, match="1 of 2 tensors: exit"):
        frozen.check()


def test_the_smallest_change_is_seen(tmp_path: Path) -> None:
    folder = small_low_level(tmp_path)
    frozen = FrozenLowLevel(folder)
    tensors = load_file(folder / "model.safetensors")
    tensors["enter"][0] = np.nextafter(tensors["enter"][0], np.float32(2))
    save_file(tensors, folder / "model.safetensors")
    with pytest.raises(FrozenError, match="enter"):
        frozen.check()


def test_a_low_level_that_went_away_has_changed(tmp_path: Path) -> None:
    folder = small_low_level(tmp_path)
    frozen = FrozenLowLevel(folder)
    (folder / "model.safetensors").unlink()
    with pytest.raises(FrozenError, match="unreadable"):
        frozen.check()


def test_another_low_level_than_the_versions_were_made_for_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FrozenError, match="b" * 64):
        FrozenLowLevel(small_low_level(tmp_path)).check_against("b" * 64)


def test_a_checkpoint_that_is_not_what_its_card_says_is_refused_at_the_start(
    tmp_path: Path,
) -> None:
    folder = small_low_level(tmp_path)
    tamper(folder)
    with pytest.raises(PolicyError, match="its card says"):
        FrozenLowLevel(folder)
