"""The low level as a function: shapes, hashes, both arms alike."""

from pathlib import Path

import numpy as np
import pytest
import torch

from shared.errors import PolicyError
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.checkpoint import Card
from shared.policies.geometry import BODY_FEATURES, TOKEN_FEATURES
from shared.policies.low_level import LowLevel, build
from shared.policies.low_net import squash, targets
from tests.unit.policies.scenes import low_net, senses

WAIT = LanguageGoal(text="wait")


def turned(proprioception: np.ndarray, objects: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same scene turned by half a circle, and the arms with it."""
    joints, tools = proprioception[:14].reshape(2, 7)[::-1], proprioception[14:].reshape(2, 4)
    tools = tools[::-1] * [-1, -1, 1, 1]
    signs = np.array([-1, -1, 1, -1, -1, 1, -1, -1, 1])
    both = np.concatenate([joints.ravel(), tools.ravel()]).astype(np.float32)
    return both, (objects * signs).astype(np.float32)


def test_a_chunk_is_ten_steps_of_fourteen_targets() -> None:
    chunk = LowLevel(low_net()).act(*senses(), WAIT)
    assert chunk.shape == (10, 14)
    assert chunk.dtype == np.float32
    assert np.isfinite(chunk).all()
    assert set(np.unique(chunk[:, [6, 13]].round(3))) <= {np.float32(0.08), np.float32(-0.02)}


def test_equal_senses_give_equal_chunks_alone_and_in_company() -> None:
    low_level = LowLevel(low_net())
    first, second = senses(1), senses(2)
    alone = low_level.act(*first, WAIT)
    both = low_level.act_all(
        np.stack([first[0], second[0]]), np.stack([first[1], second[1]]), (WAIT, WAIT)
    )
    assert np.array_equal(alone, low_level.act(*first, WAIT))
    assert np.allclose(both[0], alone, atol=1e-5)


def test_each_arm_sees_the_world_from_its_own_base() -> None:
    net = low_net()
    here, there = senses(3), turned(*senses(3))
    left = net.geometry(torch.tensor(here[0][None]), torch.tensor(here[1][None]), torch.tensor([0]))
    right = net.geometry(
        torch.tensor(there[0][None]), torch.tensor(there[1][None]), torch.tensor([1])
    )
    assert left.tokens.shape == (1, 10, TOKEN_FEATURES)
    assert left.body.shape == (1, BODY_FEATURES)
    assert torch.allclose(left.tokens, right.tokens, atol=1e-4)
    assert (left.body - right.body).abs().gt(1e-4).sum() == 1  # Which arm it is.


def test_targets_undo_squashing() -> None:
    now, change = torch.zeros(1, 6), torch.full((1, 10, 6), 0.03)
    changes = torch.cat([squash(change), torch.ones(1, 10, 1)], -1)
    assert torch.allclose(targets(changes, now)[..., :6], change, atol=1e-6)


def test_the_hash_is_that_of_the_tensors_and_survives_the_disk(tmp_path: Path) -> None:
    low_level = LowLevel(low_net())
    checkpoint.save(tmp_path, low_level.tensors(), card())
    again = LowLevel.load(tmp_path)
    assert again.sha256 == low_level.sha256 == checkpoint.load_card(tmp_path).tensors_sha256
    assert LowLevel(low_net(1)).sha256 != low_level.sha256
    assert np.array_equal(again.act(*senses(), WAIT), low_level.act(*senses(), WAIT))


def test_other_tensors_are_refused() -> None:
    tensors = LowLevel(low_net()).tensors()
    del tensors["enter.weight"]
    with pytest.raises(PolicyError, match="no low level"):
        build(tensors)


def card() -> Card:
    return Card(
        name="low-level",
        title="A low level",
        version="1",
        date="2026-11-23",
        recipe=("Made up.",),
        command="hld pretrain",
        seed=0,
        data_sha256="0" * 64,
        tensors_sha256="",
    )
