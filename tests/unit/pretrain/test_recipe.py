"""Practice, demonstrations and the stages that keep them."""

import dataclasses
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from services.learner.pretrain import practice, stages
from services.learner.pretrain.demonstrate import ABSENT, Demonstrations, Lesson, demonstrate
from services.learner.pretrain.low_fit import LowFitSettings, Rows, fit_low, measures
from services.learner.pretrain.practice import Steps, practise
from services.learner.pretrain.replay import choose
from services.learner.pretrain.scale import HighRound, LowRound, Scale
from services.learner.pretrain.stages import Pretraining
from shared.policies import checkpoint, examples
from shared.policies.geometry import Geometry
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.policies.low_net import VERBS, LowNet
from shared.workcell.skills import COMMANDS
from tests.unit.pretrain.lexicons import few

TINY = Scale(
    phrases=2,
    low=(LowRound(practice=320, updates=3), LowRound(practice=160, updates=2)),
    expert_episodes=1,
    learned_episodes=1,
    validation_episodes=1,
    high=(HighRound(driven=0, updates=3), HighRound(driven=1, updates=2)),
    high_batch=8,
    prompts=6,
    replay=60,
    chains=1,
    tasks=1,
    trials=1,
)


class Here(Executor):
    """Does each job at once, in this process; `jobs` counts them."""

    def __init__(self) -> None:
        self.jobs = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.jobs += 1
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


class Ledger:
    """Keeps what stages told."""

    def __init__(self) -> None:
        self.told: dict[str, list[int]] = {}

    def stage(self, name: str, total: int) -> Callable[[int], None]:
        self.told[name] = [total]
        return self.told[name].append


@pytest.fixture(scope="module")
def steps() -> Steps:
    return practise(seed=3, steps=400, folder=None)


@pytest.fixture(scope="module")
def lessons() -> Demonstrations:
    return demonstrate(Lesson(seeds=(11,)))


def test_practice_is_the_experts_word_in_unbroken_runs(steps: Steps) -> None:
    assert len(steps) == 400
    assert steps.actions.shape == (len(steps), 14)
    assert (np.diff(steps.runs) >= 0).all()
    for run in np.unique(steps.runs):
        assert len(np.unique(steps.commands[steps.runs == run])) == 1


def test_equal_seeds_give_equal_practice(steps: Steps) -> None:
    again = practise(seed=3, steps=400, folder=None)
    assert np.array_equal(again.actions, steps.actions)


def test_joined_practice_keeps_its_runs_apart(steps: Steps, tmp_path: Path) -> None:
    steps.save(tmp_path / "steps.safetensors")
    both = practice.join([steps, Steps.load(tmp_path / "steps.safetensors")])
    assert len(both) == 2 * len(steps)
    assert len(np.unique(both.runs)) == 2 * len(np.unique(steps.runs))


def test_an_answer_ends_with_its_run(steps: Steps) -> None:
    rows = Rows(steps, Geometry(measures()), seed=0)
    lot = rows.draw(np.random.default_rng(0), 64)
    assert lot.answers.shape == (64, 10, 7)
    assert lot.orders.verbs.max() < len(VERBS)
    assert (lot.weights[:, 0] == 1).all()
    assert (lot.weights.diff(dim=1) <= 0).all()


def test_fitting_makes_the_low_level_more_like_the_expert(steps: Steps) -> None:
    torch.manual_seed(0)
    losses: list[float] = []

    def listen(step: int, total: int, loss: float) -> bool:
        losses.append(loss)
        return step < total

    fit_low(LowNet(Geometry(measures())), steps, LowFitSettings(steps=101, rows=128), listen)
    assert losses[-1] < 0.75 * losses[0]


def test_a_demonstration_is_labelled_at_every_decision(
    lessons: Demonstrations, tmp_path: Path
) -> None:
    many = lessons.examples
    assert many.images.shape == (len(many), 2, 64, 64, 3)
    assert set(many.labels) <= set(COMMANDS)
    assert many.previous[0] == ()
    assert [len(past) for past in many.previous[:6]] == [0, 1, 2, 3, 4, 4]
    assert lessons.status.shape == (len(many), 18)
    there = lessons.status[0] != ABSENT
    assert np.array_equal(there, (lessons.positions[0] != 0).any(-1))
    assert 0 < there.sum() < 18
    assert many.looks[:5].tolist()[::4] == [[-1, -1, -1, 0], [1, 2, 3, 4]]
    assert many.senses.shape == (len(many), 22)
    lessons.save(tmp_path / "lessons.safetensors")
    again = Demonstrations.load(tmp_path / "lessons.safetensors").examples
    assert (again.previous, again.labels, again.prompts) == (
        many.previous,
        many.labels,
        many.prompts,
    )


def test_replay_keeps_whole_episodes_and_prefers_rare_commands(lessons: Demonstrations) -> None:
    rows = np.zeros(400, int)
    episodes = np.arange(400) // 10
    common = lessons.take(rows)
    labels = ["wait" if episode % 8 else "put it down" for episode in episodes]
    named = dataclasses.replace(common.examples, labels=labels)
    many = dataclasses.replace(common, examples=named, episodes=episodes)
    counts: Counter[str] = Counter()
    for seed in range(20):
        chosen = choose(many, 55, seed)
        assert len(chosen) == 50
        assert (np.bincount(episodes[chosen], minlength=40) % 10 == 0).all()
        counts.update(labels[row] for row in chosen)
    assert counts["put it down"] > 1.5 * counts.total() / 8
    assert len(choose(many, 5, 0)) == 10


def test_stages_are_kept_and_not_done_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stages, "exam", lambda: (few(2), few(2)))
    first, ledger = Here(), Ledger()
    run = Pretraining(tmp_path, TINY, 0, first, ledger)
    low_level = run.low_level()
    lessons = run.demonstrations(low_level)
    high_level, replay = run.high_level(lessons, low_level), run.replay(lessons)
    assert {"practice 0", "low level 1", "high level 1"} <= set(ledger.told)
    assert ledger.told["high level 1"] == [2, 1, 2, 2]
    driven = Demonstrations.load(tmp_path / "demonstrations-driven-1.safetensors").examples
    pairs = zip(driven.labels[:-1], driven.previous[1:], strict=True)
    wrong = [past[-1] != right for right, past in pairs]
    assert np.mean(wrong) > 0.5

    second = Here()
    again = Pretraining(tmp_path, TINY, 0, second, Ledger())
    assert again.high_level(again.demonstrations(low_level), again.low_level()) == high_level
    assert second.jobs == 0
    assert LowLevel.load(low_level).sha256 == checkpoint.load_card(low_level).tensors_sha256
    assert HighLevel.load(high_level).bank.phrases == COMMANDS
    assert 0 < len(examples.load(replay)) <= TINY.replay
    assert not list(tmp_path.glob("unfinished-*"))
