"""Evaluation mode: no robots of its own; rolls out what the learner's gate wants compared.

It asks, rolls out one episode, and asks again with what came of it. If the learner is gone it asks
on; a result that was not acknowledged is handed in again.
"""

from collections.abc import Sequence
from contextlib import ExitStack

import numpy as np
import structlog
import torch
from numpy.typing import NDArray

from services.actor.config import ActorSettings
from services.actor.refresh import as_array, by_hash
from shared.errors import HldError, NoAnswerError, RefusedError
from shared.evaluation.episode import Evaluator, Levels
from shared.evaluation.plan import Case, Plan
from shared.messages.decision import Proposal
from shared.messages.observation import Observation
from shared.messages.trial import TrialOrder, TrialReport, TrialResult
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.service import Stop
from shared.wire.bus import Bus, open_bus
from shared.wire.codec import decode, encode
from shared.wire.keys import any_service, robot_key
from shared.wire.tensors import TensorFetcher
from shared.workcell.station import Station

IDLE_S = 1.0
REFUSED_S = 5.0
ASK_S = 5.0
FETCH_WITHIN_S = 60.0
HELD = 4
"""Policies that are kept ready: a candidate and what it is compared with, and those before."""
log = structlog.get_logger()


class Contestant:
    """A high level that becomes another one between two episodes."""

    def __init__(self, policy: HighLevel) -> None:
        self.become(policy)

    def become(self, policy: HighLevel) -> None:
        """Be this one from now on."""
        self.version, self._policy = policy.version, policy

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8]] = ()
    ) -> tuple[Proposal, ...]:
        """See `shared.rollout.robot.HighLevel`."""
        return self._policy.propose(observation, past)


class Contest:
    """Rolls out orders; keeps cell and policies from one to the next."""

    def __init__(self, bus: Bus, fleet: str, low_level: LowLevel, start: HighLevel) -> None:
        """start: a version whose tensors are here and need not be fetched."""
        self._low_level, self._contestant = low_level, Contestant(start)
        tensors = any_service(fleet, "learner", "tensor")
        self._fetcher = TensorFetcher(bus, tensors, by_hash(start.tensors()))
        self._policies: dict[str, HighLevel] = {}
        self._evaluator: Evaluator | None = None
        self._plan_sha256 = ""

    def roll_out(self, order: TrialOrder) -> TrialResult:
        """One episode.

        Raises:
            HldError: tensors could not be fetched, or the plan names something unknown here.
        """
        evaluator = self._evaluator_for(order)
        self._contestant.become(self._policy_of(order, evaluator.plan))
        row = evaluator(Case(order.seed, order.task))
        return TrialResult(
            policy_sha256=order.policy_sha256,
            plan_sha256=order.plan_sha256,
            seed=order.seed,
            success=row.success,
            row=row.model_dump(mode="json"),
        )

    def close(self) -> None:
        """Give the cell back."""
        self._fetcher.close()
        if self._evaluator:
            self._evaluator.close()

    def _evaluator_for(self, order: TrialOrder) -> Evaluator:
        if self._evaluator is None or self._plan_sha256 != order.plan_sha256:
            if self._evaluator:
                self._evaluator.close()
            plan = Plan.model_validate(order.plan)
            self._evaluator = Evaluator(plan, self._levels)
            self._plan_sha256 = order.plan_sha256
        return self._evaluator

    def _levels(self, plan: Plan, station: Station) -> Levels:
        del plan, station  # Unused: whoever is tried, tries in the same cell.
        return Levels(self._contestant, self._low_level)

    def _policy_of(self, order: TrialOrder, plan: Plan) -> HighLevel:
        held = self._policies.pop(order.policy_sha256, None)
        if held is None:
            payloads = self._fetcher.fetch(order.policy.tensors, FETCH_WITHIN_S)
            refs = order.policy.tensors
            tensors = {ref.name: as_array(ref, payloads[ref.sha256]) for ref in refs}
            held = HighLevel.build(order.policy, tensors, plan.rollout.head)
        self._policies[order.policy_sha256] = held  # The last one used is the last in the row.
        while len(self._policies) > HELD:
            del self._policies[next(iter(self._policies))]
        return held


def run(settings: ActorSettings, stop: Stop) -> None:
    """Ask and roll out until the end is asked for.

    Raises:
        HldError: a checkpoint, or an endpoint of the bus, can't be used.
    """
    torch.set_num_threads(settings.threads)
    with ExitStack() as closing:
        bus = closing.enter_context(open_bus(settings.bus))
        low_level = LowLevel.load(settings.low_level or bundled("low_level"))
        start = HighLevel.load(settings.high_level or bundled("high_level"))
        contest = Contest(bus, settings.bus.fleet, low_level, start)
        closing.callback(contest.close)
        work(bus, settings, low_level.sha256, contest, stop)


def work(
    bus: Bus, settings: ActorSettings, low_level_sha256: str, contest: Contest, stop: Stop
) -> None:
    """The loop of `run`."""
    key = robot_key(settings.bus.fleet, settings.id, "trial")
    result: TrialResult | None = None
    done = 0
    while not stop:
        report = TrialReport(
            evaluator=settings.id, low_level_sha256=low_level_sha256, result=result
        )
        try:
            answer = bus.ask(key, encode(report), timeout_s=ASK_S)
        except NoAnswerError:
            stop.wait(IDLE_S)
            continue
        except RefusedError as error:
            log.warning("no work for this actor", reason=str(error))
            stop.wait(REFUSED_S)
            continue
        done, result = done + (result is not None), None
        if not answer:
            stop.wait(IDLE_S)
            continue
        result = _rolled_out(decode(TrialOrder, answer), contest, stop)
    log.info("trials", done=done)


def _rolled_out(order: TrialOrder, contest: Contest, stop: Stop) -> TrialResult | None:
    try:
        return contest.roll_out(order)
    except (HldError, ValueError) as error:  # ValueError: a plan of another version of hl-dagger.
        log.error("a trial could not be rolled out", seed=order.seed, reason=str(error))
        stop.wait(REFUSED_S)
        return None
