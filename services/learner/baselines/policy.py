"""The arms as they act: each as a high and a low level of the rollout, on the seams that are there.

What passes between the two besides words is kept in a memory that both have.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from services.learner.baselines import net
from services.learner.baselines.net import Advice, Pair
from shared.evaluation.episode import Evaluator, Levels, Oracle
from shared.evaluation.plan import ORACLE, Plan
from shared.goals.family import Floats
from shared.goals.language.bank import PhraseBank
from shared.messages.decision import Proposal
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.policies import checkpoint
from shared.policies.checkpoint import sha256_tensors
from shared.policies.geometry import View
from shared.policies.high_level import BASE_VERSION, HighLevel
from shared.policies.high_net import Answer
from shared.policies.low_level import LowLevel, as_tensors
from shared.policies.low_net import CHUNK, Motion, Orders, targets
from shared.policies.reader.reader import Reader
from shared.workcell.skills import COMMANDS
from shared.workcell.station import Station

UNSAID = Goal(text="a goal without words")
"""Stands for the goal in the decisions of an arm that has no words for it."""


class ArmPlan(Plan):
    """Episodes of an arm.

    low_level: folder of its checkpoint. high_level: the same, or "oracle".
    """

    def check_policies(self) -> None:
        load(self.low_level_folder())


def load(folder: Path) -> Pair:
    """An arm's network.

    Raises:
        PolicyError: the folder holds none.
    """
    tensors, card = checkpoint.load(folder)
    return net.build(card.settings, tensors).eval().requires_grad_(False)


def evaluator(plan: Plan) -> Evaluator:
    """What evaluates an arm's plan in each process."""
    return Evaluator(plan, levels_of)


def levels_of(plan: Plan, station: Station) -> Levels:
    """The arm as two levels."""
    pair = load(plan.low_level_folder())
    if not pair.worded:
        mind = Mind(pair)
        return Levels(mind, Follower(pair, mind), worded=False)
    high = Mind(pair) if pair.arm == "chain" else HighLevel(pair.trunk, _bank(), BASE_VERSION)
    low = Thinker(pair, high) if isinstance(high, Mind) else LowLevel(pair.mover, _reader())
    return Levels(Oracle(station) if plan.high_level == ORACLE else high, low)


def _bank() -> PhraseBank:
    return PhraseBank.of(COMMANDS)


def _reader() -> Reader:
    """The project's; an arm says commands as they are, which takes no reading."""
    return LowLevel.load(checkpoint.bundled("low_level")).reader


class Mind(HighLevel):
    """The trunk of an arm whose mover hears more than words.

    advice: of the last time that it was asked, [1].
    """

    def __init__(self, pair: Pair) -> None:
        super().__init__(pair.trunk, _bank(), BASE_VERSION)
        self._pair = pair
        self.advice: Advice | None = None

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8] | None] = ()
    ) -> tuple[Proposal, ...]:
        """See `HighLevel.propose`; without words one proposal that stands for all."""
        with torch.inference_mode():
            if not self._pair.worded:
                observation = observation.model_copy(update={"previous": ()})
            question = self.question(observation, () if self._pair.arm == "flat" else past)
            slots, wishes = self.net.see(question.images), self.net.wish(question.words)
            minds, thought = self.net.ponder(slots, wishes, question)
            answer: Answer = self.net.answer(thought)
            passed = self._pair.passed(answer.meaning, self._phrases)
            self.advice = self._pair.advise(minds, thought, passed)
            if self._pair.worded:
                return self.scored(answer)
            return (Proposal(goal=UNSAID, score=1.0),)


class Thinker(LowLevel):
    """The mover of the chain of thought: a goal in words, and what the mind had in mind."""

    def __init__(self, pair: Pair, mind: Mind) -> None:
        super().__init__(pair.mover, _reader())
        self._pair, self._mind = pair, mind

    def moved(self, view: View, orders: Orders) -> Motion:
        """See `LowLevel.moved`."""
        advice = self._mind.advice
        rows = torch.zeros(len(orders.verbs), dtype=torch.int64)
        return self._pair.move(view, orders, advice and advice.at(rows))


class Follower:
    """The mover of an arm without words; a low level of the rollout for one robot."""

    chunk_steps = CHUNK

    def __init__(self, pair: Pair, mind: Mind) -> None:
        self._pair, self._mind = pair, mind
        self.sha256 = self.fingerprint()

    def fingerprint(self) -> str:
        """Over the whole network, of which it is a part."""
        return sha256_tensors(as_tensors(self._pair))

    def act(self, proprioception: Floats, objects: Floats, goal: Goal) -> Floats:
        """See `LowLevel.act`; the goal is of no account."""
        del goal
        with torch.inference_mode():
            arm = torch.arange(2)
            felt, things = torch.from_numpy(proprioception), torch.from_numpy(objects)
            view = self._pair.mover.geometry(felt.expand(2, -1), things.expand(2, -1, -1), arm)
            assert self._mind.advice is not None  # The rollout asks above before it asks below.
            nothing = Orders(torch.zeros_like(arm), torch.full_like(arm, -1))
            motion = self._pair.move(view, nothing, self._mind.advice.at(torch.zeros_like(arm)))
            chunks: Tensor = targets(motion.changes, view.now)
            both: Floats = torch.cat([chunks[0], chunks[1]], -1).numpy()
        return both

    def completion(self, proprioception: Floats, objects: Floats, goal: Goal) -> float:
        """Never: there is no command that could be achieved."""
        del proprioception, objects, goal
        return 0.0

    def can(self, goal: Goal, objects: Floats) -> bool:
        """Always: the goal is of no account."""
        del goal, objects
        return True

    def objection(self, proprioception: Floats, objects: Floats, goal: Goal) -> str:
        """None."""
        del proprioception, objects, goal
        return ""

    def meaning(self, goal: Goal, objects: Floats) -> str | None:
        """None: there are no words."""
        del goal, objects
        return None
