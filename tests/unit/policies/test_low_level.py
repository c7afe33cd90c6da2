"""The low level as a function: shapes, hashes, both arms alike."""

from pathlib import Path

import numpy as np
import pytest
import torch

from shared.errors import PolicyError
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.checkpoint import Card
from shared.policies.geometry import OBJECTS
from shared.policies.low_level import LowLevel, build
from shared.policies.low_net import squash, targets
from shared.policies.tokens import BODY_FEATURES, TOKEN_FEATURES
from tests.unit.policies.scenes import Letters, gripping, low_net, senses, words

WAIT = LanguageGoal(text="wait")


def turned(proprioception: np.ndarray, objects: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same scene turned by half a circle, and the arms with it."""
    joints, tools = proprioception[:14].reshape(2, 7)[::-1], proprioception[14:].reshape(2, 4)
    tools = tools[::-1] * [-1, -1, 1, 1]
    signs = np.array([-1, -1, 1, -1, -1, 1, -1, -1, 1])
    both = np.concatenate([joints.ravel(), tools.ravel()]).astype(np.float32)
    return both, (objects * signs).astype(np.float32)


def test_a_chunk_is_ten_steps_of_fourteen_targets() -> None:
    chunk = LowLevel(low_net(), words()).act(*senses(), WAIT)
    assert chunk.shape == (10, 14)
    assert chunk.dtype == np.float32
    assert np.isfinite(chunk).all()
    assert set(np.unique(chunk[:, [6, 13]].round(3))) <= {np.float32(0.08), np.float32(-0.02)}


def test_equal_senses_give_equal_chunks_alone_and_in_company() -> None:
    low_level = LowLevel(low_net(), words())
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
    assert left.tokens.shape == (1, OBJECTS + 1 + 4 + 4 + 3 + 1, TOKEN_FEATURES)
    assert left.body.shape == (1, BODY_FEATURES)
    seen = left.valid[0, : OBJECTS + 1]  # Things and plate; quarters and spots are each arm's own.
    assert seen.sum() == 8
    both = left.tokens[0, : OBJECTS + 1][seen], right.tokens[0, : OBJECTS + 1][seen]
    assert torch.allclose(*both, atol=1e-4)
    assert (left.body - right.body).abs().gt(1e-4).sum() == 1  # Which arm it is.


def test_targets_undo_squashing() -> None:
    now, change = torch.zeros(1, 6), torch.full((1, 10, 6), 0.03)
    changes = torch.cat([squash(change), torch.ones(1, 10, 1)], -1)
    assert torch.allclose(targets(changes, now)[..., :6], change, atol=1e-6)


def test_the_hash_is_that_of_the_tensors_and_survives_the_disk(tmp_path: Path) -> None:
    low_level = LowLevel(low_net(), words())
    checkpoint.save(tmp_path, low_level.tensors(), card())
    again = LowLevel.load(tmp_path, Letters())
    assert again.sha256 == low_level.sha256 == checkpoint.load_card(tmp_path).tensors_sha256
    assert LowLevel(low_net(1), words()).sha256 != low_level.sha256
    assert np.array_equal(again.act(*senses(), WAIT), low_level.act(*senses(), WAIT))


CHEESE = LanguageGoal(text="pick up the cheese")
ABSENT_CHEESE = senses()[1].copy()
ABSENT_CHEESE[2] = 0.0


@pytest.mark.parametrize(
    ("text", "objects", "objection"),
    [
        ("pick up the cheese", senses()[1], ""),
        ("zzz qqq", senses()[1], "doesn't understand 'zzz qqq'; nearest it knows: '"),
        ("pick up the cheese", ABSENT_CHEESE, "'pick up the cheese' can't be done here"),
    ],
)
def test_what_it_cannot_do_it_objects_to_naming_what_it_can(
    text: str, objects: np.ndarray, objection: str
) -> None:
    low_level, goal = LowLevel(low_net(), words()), LanguageGoal(text=text)
    why = low_level.objection(senses()[0], objects, goal)
    assert why == "" if not objection else objection in why
    assert low_level.can(goal, objects) is not bool(objection)


@pytest.mark.parametrize(
    ("thing", "text", "objection"),
    [
        (2, "put it down", ""),
        (2, "pick up the ham", ""),
        (None, "pick up the ham", ""),
        (None, "put it down", "since nothing is in the hands; nearest: '"),
    ],
)
def test_a_persons_word_is_also_about_what_is_in_the_hands(
    thing: int | None, text: str, objection: str
) -> None:
    body, objects = senses() if thing is None else gripping(thing)
    low_level, goal = LowLevel(low_net(), words()), LanguageGoal(text=text)
    why = low_level.objection(body, objects, goal)
    assert why == "" if not objection else objection in why
    assert low_level.can(goal, objects)  # A high level's mistake is to be seen.


def test_it_stands_still_for_what_it_objects_to() -> None:
    body, objects = senses()
    chunk = LowLevel(low_net(), words()).act(body, objects, LanguageGoal(text="zzz qqq"))
    assert np.allclose(chunk[:, :6], body[:6])
    assert np.allclose(chunk[:, 6], 0.08)
    assert LowLevel(low_net(), words()).completion(body, objects, LanguageGoal(text="zzz")) == 0.0


def test_a_probability_says_whether_the_command_is_achieved() -> None:
    assert 0.0 < LowLevel(low_net(), words()).completion(*senses(), CHEESE) < 1.0


def test_other_tensors_are_refused() -> None:
    tensors = LowLevel(low_net(), words()).tensors()
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
