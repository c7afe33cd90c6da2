"""Checkpoints on disk."""

from pathlib import Path

import numpy as np
import pytest

from shared.errors import PolicyError
from shared.policies import checkpoint
from shared.policies.checkpoint import Card, Figure, Tensors, sha256_tensors


def card() -> Card:
    return Card(
        name="thing",
        title="A thing",
        version="1.0",
        date="2026-11-23",
        recipe=("Thought about it.", "Made it."),
        command="hld pretrain",
        seed=7,
        data_sha256="0" * 64,
        tensors_sha256="",
        figures=(Figure(name="tasks", value=0.5, n=10, interval=(0.24, 0.76)),),
        limits=("It can't fly.",),
        settings={"width": 3},
    )


def test_tensors_and_card_come_back_as_they_were(tmp_path: Path) -> None:
    tensors: Tensors = {
        "b": np.arange(6, dtype=np.float32).reshape(2, 3),
        "a": np.zeros(0, np.int64),
    }
    checkpoint.save(tmp_path, tensors, card())
    again, found = checkpoint.load(tmp_path)
    assert sorted(again) == ["a", "b"]
    assert np.array_equal(again["b"], tensors["b"])
    assert found.settings == {"width": 3}
    assert found.tensors_sha256 == sha256_tensors(tensors)


def test_the_page_for_people_tells_figures_recipe_and_limits(tmp_path: Path) -> None:
    checkpoint.save(tmp_path, {"a": np.zeros(3)}, card())
    page = (tmp_path / "README.md").read_text()
    for part in ("| tasks | 0.500 | 10 | 0.240 to 0.760 |", "2. Made it.", "can't fly", "seed 7"):
        assert part in page


def test_the_hash_knows_names_types_and_shapes_but_no_order() -> None:
    one, other = np.arange(4, dtype=np.float32), np.ones(2, np.float32)
    first = sha256_tensors({"a": one, "b": other})
    assert first == sha256_tensors({"b": other, "a": one})
    assert first != sha256_tensors({"b": one, "a": other})
    assert sha256_tensors({"a": one}) != sha256_tensors({"a": one.reshape(2, 2)})
    assert sha256_tensors({"a": one}) != sha256_tensors({"a": one.view(np.int32)})


def test_changed_tensors_are_noticed(tmp_path: Path) -> None:
    checkpoint.save(tmp_path / "one", {"a": np.zeros(3)}, card())
    checkpoint.save(tmp_path / "two", {"a": np.ones(3)}, card())
    changed = (tmp_path / "two" / "model.safetensors").read_bytes()
    (tmp_path / "one" / "model.safetensors").write_bytes(changed)
    with pytest.raises(PolicyError, match="its card says"):
        checkpoint.load(tmp_path / "one")


def test_a_folder_without_a_card_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match="cannot read"):
        checkpoint.load(tmp_path)


def test_a_card_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "card.json").write_text('{"name": "thing"}')
    with pytest.raises(PolicyError, match="no model card"):
        checkpoint.load_card(tmp_path)


def test_an_unknown_bundled_checkpoint_is_refused_with_the_known_ones() -> None:
    with pytest.raises(PolicyError, match="no checkpoint 'middle_level'"):
        checkpoint.bundled("middle_level")
