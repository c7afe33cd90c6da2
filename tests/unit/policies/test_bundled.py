"""The checkpoints that come with the project are what their cards say."""

import numpy as np
import pytest

from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint, examples
from shared.policies.high_level import BASE_VERSION, HighLevel
from shared.policies.low_level import LowLevel
from shared.workcell.objects import OBJECT_NAMES
from tests.unit.policies.scenes import gripping, observation, senses


@pytest.mark.parametrize("name", ["low_level", "high_level", "demonstrations"])
def test_a_bundled_checkpoint_has_a_whole_card_and_is_small(name: str) -> None:
    folder = checkpoint.bundled(name)
    tensors, card = checkpoint.load(folder)
    assert card.licence == "Apache-2.0"
    assert len(card.data_sha256) == 64
    assert card.recipe
    assert sum(array.nbytes for array in tensors.values()) < 10_000_000
    assert name == "demonstrations" or card.figures


def test_the_bundled_low_level_acts() -> None:
    low_level = LowLevel.load(checkpoint.bundled("low_level"))
    chunk = low_level.act(*senses(), LanguageGoal(text="wait"))
    assert np.isfinite(chunk).all()


@pytest.mark.parametrize(
    ("text", "objection"),
    [
        ("drop the cheddar in the bin", ""),
        ("throw it away", ""),
        ("drop the ham in the bin", "what it names is not what is in the hand"),
        ("pick up the ham", ""),
    ],
)
def test_what_is_to_be_put_must_be_what_is_held(text: str, objection: str) -> None:
    low_level = LowLevel.load(checkpoint.bundled("low_level"))
    body, objects = gripping(OBJECT_NAMES.index("cheese"))
    why = low_level.objection(body, objects, LanguageGoal(text=text))
    assert why == "" if not objection else objection in why


def test_the_bundled_high_level_proposes() -> None:
    policy = HighLevel.load(checkpoint.bundled("high_level"))
    assert policy.version == BASE_VERSION
    seen = examples.load(checkpoint.bundled("demonstrations"))
    proposals = policy.propose(observation(seen.images[0], seen.previous[0]))
    assert {proposal.goal.text for proposal in proposals} == set(policy.bank.phrases)
    assert set(seen.labels) <= set(policy.bank.phrases)
