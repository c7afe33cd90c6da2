"""Paired episodes in simulation: a candidate against the version in force, on the same scenes.

The third part of the gate. Actors in evaluation mode ask for an episode, roll it out and hand in
what came of it; the learner itself has no simulator. What was rolled out is kept, so that a
restart under the same code repeats nothing and the version in force is tried once.
"""

import hashlib
import json
import threading
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

import structlog
from pydantic import Field

from services.learner.code import code_version
from services.learner.store.store import PolicyRecord, Store, Trial
from shared.clock import Clock
from shared.config import Settings
from shared.errors import RefusedError
from shared.intervals import mcnemar, paired_difference, rate
from shared.messages.policy import PolicyAnnouncement
from shared.messages.trial import TrialOrder, TrialReport
from shared.rollout.settings import RolloutSettings
from shared.seeds import GATE
from shared.wire.bus import Bus, Subscription
from shared.wire.codec import decode, encode
from shared.wire.keys import ACTOR, any_service
from shared.workcell.tasks import TASKS

NOTHING = b""  # The answer where there is nothing to do.


class TrialSettings(Settings):
    """Episodes of the gate.

    episodes: pairs; 0: none, as where there is no simulator.
    site, tasks, skills, rollout: as in an evaluation. max_fall: by which success may fall.
    chance: a greater fall is borne as well where McNemar's p is above this: few pairs scatter, and
        good candidates shall not be lost by chance. More episodes find smaller falls.
    patience_s: without any result for so long, a candidate is refused. again_s: an episode that
        was given out is given to another actor after this.
    """

    episodes: Annotated[int, Field(ge=0, le=10_000)] = 0
    site: str = "far"
    tasks: Annotated[tuple[str, ...], Field(min_length=1)] = tuple(TASKS)
    skills: Annotated[int, Field(ge=1, le=64)] | None = None
    rollout: RolloutSettings = RolloutSettings()
    max_fall: Annotated[float, Field(ge=0, le=1)] = 0.05
    chance: Annotated[float, Field(gt=0, le=1)] = 0.2
    patience_s: Annotated[float, Field(gt=0)] = 600.0
    again_s: Annotated[float, Field(gt=0)] = 300.0

    def plan(self) -> dict[str, Any]:
        """What an evaluation is told, as JSON values."""
        return self.model_dump(mode="json", include={"site", "tasks", "skills", "rollout"})


class _Side(NamedTuple):
    policy: PolicyAnnouncement
    sha256: str


class Trials:
    """The desk where episodes are handed out; one candidate at a time."""

    def __init__(
        self, bus: Bus, fleet: str, store: Store, settings: TrialSettings, clock: Clock
    ) -> None:
        self._bus, self._fleet, self._store = bus, fleet, store
        self._settings, self._clock = settings, clock
        self._plan = settings.plan()
        # By other code the same policy may do otherwise: what it did before makes no pairs.
        self._plan_sha256 = _sha256([self._plan, code_version()])
        self._lock = threading.Lock()
        self._sides: tuple[_Side, ...] = ()
        self._given: dict[tuple[str, int], int] = {}  # When, by the monotonic clock.
        self._done: dict[tuple[str, int], bool] = {}
        self._heard_ns = 0
        self._served: Subscription | None = None
        self._log = structlog.get_logger()

    def start(self) -> None:
        """Begin to answer."""
        if self._settings.episodes:
            self._served = self._bus.serve(any_service(self._fleet, ACTOR, "trial"), self._answer)

    def close(self) -> None:
        """Answer nobody any more."""
        if self._served:
            self._served.close()

    def begin(self, candidate: PolicyAnnouncement, in_force: PolicyAnnouncement) -> None:
        """Want both tried; what is known of either is not tried again."""
        sides = tuple(_Side(policy, policy_sha256(policy)) for policy in (candidate, in_force))
        done = {
            (side.sha256, seed): trial.success
            for side in sides
            for seed, trial in self._store.trials(side.sha256, self._plan_sha256).items()
        }
        with self._lock:
            self._sides, self._done, self._given = sides, done, {}
            self._heard_ns = self._clock.monotonic_ns()

    def stop(self) -> None:
        """Want nothing any more."""
        with self._lock:
            self._sides = ()

    def progress(self) -> float:
        """How much is done, 0 to 1."""
        with self._lock:
            wanted = [*self._wanted()]
            return sum(place in self._done for place in wanted) / max(1, len(wanted))

    def outcomes(self) -> tuple[list[bool], list[bool]] | None:
        """Success of the candidate and of the version in force by scene; None until all is done.

        Raises:
            RefusedError: nobody has handed in anything for too long.
        """
        with self._lock:
            if all(place in self._done for place in self._wanted()):
                mine, its = (
                    [self._done[side.sha256, seed] for seed in self._seeds()]
                    for side in self._sides
                )
                return mine, its
            waited_s = (self._clock.monotonic_ns() - self._heard_ns) / 1e9
            done = sum(place in self._done for place in self._wanted())
        if waited_s > self._settings.patience_s:
            raise RefusedError(
                f"no actor in evaluation mode handed in an episode for {waited_s:.0f} s "
                f"({done} of {2 * self._settings.episodes} are there): start one with `hld "
                "actor --set mode=evaluation`, or set gate.trials.episodes=0"
            )
        return None

    def _seeds(self) -> range:
        return GATE[: self._settings.episodes]

    def _wanted(self) -> Iterator[tuple[str, int]]:
        """Scene by scene, so that pairs are complete early."""
        return ((side.sha256, seed) for seed in self._seeds() for side in self._sides)

    # -- what bus threads call

    def _answer(self, key: str, payload: bytes) -> bytes:
        del key  # Unused: the report says who asks.
        report = decode(TrialReport, payload)
        if report.result:
            self._take(report)
        with self._lock:
            order = self._next(report.low_level_sha256)
        return encode(order) if order else NOTHING

    def _take(self, report: TrialReport) -> None:
        result = report.result
        assert result is not None  # The caller looked.
        trial = Trial(
            policy=result.policy_sha256,
            plan=result.plan_sha256,
            seed=result.seed,
            success=result.success,
            row=result.row,
        )
        if self._store.add_trial(trial):
            self._log.debug("a trial came in", evaluator=report.evaluator, seed=result.seed)
        if result.plan_sha256 == self._plan_sha256:
            with self._lock:
                self._done[result.policy_sha256, result.seed] = result.success
                self._heard_ns = self._clock.monotonic_ns()

    def _next(self, low_level_sha256: str) -> TrialOrder | None:
        now = self._clock.monotonic_ns()
        late_ns = int(self._settings.again_s * 1e9)
        for side in self._sides:
            if side.policy.low_level_sha256 != low_level_sha256:
                raise RefusedError(
                    f"the candidate was made for the low level {side.policy.low_level_sha256}, "
                    f"and this actor runs {low_level_sha256}"
                )
        sides = {side.sha256: side for side in self._sides}
        for place in self._wanted():
            given = self._given.get(place)
            if place in self._done or (given is not None and now - given < late_ns):
                continue
            self._given[place] = now
            return self._order(sides[place[0]], place[1])
        return None

    def _order(self, side: _Side, seed: int) -> TrialOrder:
        tasks = self._settings.tasks
        return TrialOrder(
            policy=side.policy,
            policy_sha256=side.sha256,
            plan=self._plan,
            plan_sha256=self._plan_sha256,
            seed=seed,
            task=tasks[(seed - GATE.start) % len(tasks)],
        )


def compare(
    mine: list[bool], its: list[bool], settings: TrialSettings
) -> tuple[str, dict[str, Any]]:
    """Why a candidate is worse than the version in force, "" if it isn't; and the figures."""
    gap, p = paired_difference(mine, its), mcnemar(mine, its)
    figures = {
        "candidate": rate(mine),
        "in_force": rate(its),
        "difference": round(gap.value, 4),
        "interval": [round(gap.low, 4), round(gap.high, 4)],
        "p": round(p, 4),
    }
    if gap.value < -settings.max_fall and p <= settings.chance:
        return (
            f"it succeeds in {sum(mine)} of {len(mine)} scenes, the version in force in "
            f"{sum(its)} of the same (p = {p:.3f}); {settings.max_fall} less is allowed"
        ), figures
    if any(its) and not any(mine):  # Of a weak version in force too little is left to fall.
        return (
            f"it succeeds in none of {len(mine)} scenes, the version in force in {sum(its)} of the "
            "same; one at least is wanted"
        ), figures
    return "", figures


def policy_sha256(policy: PolicyAnnouncement | PolicyRecord) -> str:
    """Over all that makes a policy act: tensors, bank and settings, and not how it is called."""
    tensors = sorted((ref.name, ref.sha256) for ref in policy.tensors)
    return _sha256([tensors, policy.bank, policy.settings])


def _sha256(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
