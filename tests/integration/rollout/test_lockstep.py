"""Lockstep with the real cell and the real policies: equal seeds give equal episodes to the bit."""

import functools
import hashlib
import subprocess
import sys

import pytest

from shared.clock import SystemClock
from shared.evaluation.episode import Evaluator
from shared.evaluation.plan import Case, Plan
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision
from shared.messages.goal import Goal
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout.rollout import Rollout
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Lockstep
from shared.workcell.station import Station

STEPS = 130


@functools.cache
def episode_hash(seed, corrected):
    """A hash over everything that was seen, decided and done; supervised, as the oracle does it."""
    digest = hashlib.sha256()
    station = Station("far")
    scene = station.reset(seed, "sandwich", None)
    settings = RolloutSettings(supervised=True, latency_steps=3)

    def decided(decision: Decision) -> None:
        head = decision.model_dump(mode="json", exclude={"time_ns"})
        digest.update(repr(sorted(head.items())).encode())
        for name in sorted(decision.arrays):
            digest.update(decision.arrays[name].tobytes())

    rollout = Rollout(
        station,
        HighLevel.load(bundled("high_level")),
        LowLevel.load(bundled("low_level")),
        Lockstep(settings.latency_steps),
        SystemClock(),
        settings,
        name="robot-1",
        episode="ep-1",
        scene=scene,
        decided=decided,
    )
    while rollout.step < STEPS and not rollout.over:
        if not rollout.advance():
            rollout.correct(verdict(rollout, station, corrected))
        digest.update(station.snapshot().tobytes())
    station.close()
    return digest.hexdigest()


def verdict(rollout, station, corrected):
    """Passed, or corrected with what the oracle knows."""
    text = station.right_command(rollout.command.text)
    kind = Kind.OVERRIDE if corrected and text != rollout.command.text else Kind.PASS
    return Correction(
        id=f"co-{rollout.decisions}",
        robot="robot-1",
        episode="ep-1",
        kind=kind,
        author="ada",
        goal=Goal(text=text) if kind is Kind.OVERRIDE else None,
        decision=rollout.awaited.id,
        delay_steps=2,
        begun_ns=0,
        created_ns=0,
    )


@pytest.mark.parametrize("corrected", [False, True])
def test_equal_seeds_and_versions_give_equal_episodes_to_the_bit_in_another_process(corrected):
    code = (
        "from tests.integration.rollout.test_lockstep import episode_hash;"
        f"print(episode_hash(1_000_000_123, {corrected}))"
    )
    command = [sys.executable, "-c", code]
    elsewhere = subprocess.run(command, capture_output=True, text=True, check=True)
    assert elsewhere.stdout.strip() == episode_hash(1_000_000_123, corrected)


def test_another_seed_gives_another_episode():
    assert episode_hash(1_000_000_123, False) != episode_hash(1_000_000_124, False)


def test_an_evaluation_is_the_same_whatever_it_is_run_beside():
    plan = Plan(tasks=("pack",), site="far", rollout=RolloutSettings(max_steps=400))
    one, other = Evaluator(plan), Evaluator(plan)
    first = one(Case(2_000_000_001, "pack"))
    other(Case(2_000_000_000, "pack"))
    assert other(Case(2_000_000_001, "pack")) == first
