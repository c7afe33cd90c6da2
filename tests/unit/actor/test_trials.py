"""An actor in evaluation mode: what it rolls out is what an evaluation would, and none is lost."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from services.actor.config import ActorSettings
from services.actor.trials import Contest, work
from services.learner.build import origin
from services.learner.publish import Publisher, announcement
from services.learner.shelf import Shelf
from services.learner.store.tensors import TensorFiles, unpack
from services.learner.trials import TrialSettings, policy_sha256
from shared.errors import NoAnswerError, RefusedError
from shared.evaluation.episode import Evaluator
from shared.evaluation.plan import Case, Plan
from shared.messages.trial import TrialOrder, TrialReport, TrialResult
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout.settings import RolloutSettings
from shared.seeds import GATE
from shared.service import Stop
from shared.wire.codec import decode, encode
from shared.wire.hub import MemoryRouter
from shared.wire.keys import ACTOR, any_service
from shared.wire.memory import MemoryBus

SETTINGS = TrialSettings(
    episodes=1, site="lab", tasks=("pack",), rollout=RolloutSettings(max_steps=60)
)


@pytest.fixture(scope="module")
def order(tmp_path_factory: pytest.TempPathFactory) -> TrialOrder:
    """The bundled high level in one short episode."""
    files = TensorFiles(tmp_path_factory.mktemp("tensors"))
    low_level_sha256 = LowLevel.load(bundled("low_level")).sha256
    policy = announcement(origin(None, files, low_level_sha256, 1), 1, "learner")
    return TrialOrder(
        policy=policy,
        policy_sha256=policy_sha256(policy),
        plan=SETTINGS.plan(),
        plan_sha256="0" * 64,
        seed=GATE.start,
        task="pack",
    )


@pytest.fixture
def contest() -> Iterator[Contest]:
    low_level, start = (
        LowLevel.load(bundled("low_level")),
        HighLevel.load(bundled("high_level")),
    )
    made = Contest(MemoryBus(MemoryRouter()), "lab", low_level, start)
    yield made
    made.close()


def test_a_trial_is_what_an_evaluation_would_have_done(order: TrialOrder, contest: Contest) -> None:
    plan = Plan(**SETTINGS.plan())
    evaluator = Evaluator(plan)
    expected = evaluator(Case(order.seed, "pack"))
    evaluator.close()
    result = contest.roll_out(order)
    assert result.row == expected.model_dump(mode="json")
    assert (result.success, result.policy_sha256) == (expected.success, order.policy_sha256)
    assert contest.roll_out(order) == result


def test_tensors_that_nobody_has_are_an_error_and_no_result(
    order: TrialOrder, contest: Contest, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.actor.trials.FETCH_WITHIN_S", 0.2)
    ref = order.policy.tensors[0].model_copy(update={"sha256": "f" * 64})
    missing = order.policy.model_copy(update={"tensors": (ref,)})
    with pytest.raises(NoAnswerError, match="f" * 8):
        contest.roll_out(order.model_copy(update={"policy": missing, "policy_sha256": "e" * 64}))


class Learner:
    """Gives one order after another, and remembers what was handed in."""

    def __init__(self, bus: MemoryBus, answers: list[Callable[[], bytes]], stop: Stop) -> None:
        self.reports: list[TrialReport] = []
        self._answers, self._stop = answers, stop
        bus.serve(any_service("lab", ACTOR, "trial"), self._answer)

    def _answer(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        self.reports.append(decode(TrialReport, payload))
        if not self._answers:
            self._stop.set()
            return b""
        return self._answers.pop(0)()


class Quick:
    """A contest without a cell."""

    def roll_out(self, order: TrialOrder) -> TrialResult:
        return TrialResult(
            policy_sha256=order.policy_sha256,
            plan_sha256=order.plan_sha256,
            seed=order.seed,
            success=True,
            row={},
        )


def test_a_result_that_was_not_taken_is_handed_in_again(
    order: TrialOrder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.actor.trials.REFUSED_S", 0.01)
    monkeypatch.setattr("services.actor.trials.IDLE_S", 0.01)

    def busy() -> bytes:
        raise RefusedError("the store is locked")

    router, stop = MemoryRouter(), Stop()
    bus = MemoryBus(router)
    learner = Learner(MemoryBus(router), [lambda: encode(order), busy], stop)
    work(bus, ActorSettings(id="eval-1"), "a" * 64, Quick(), stop)  # type: ignore[arg-type]
    results = [report.result for report in learner.reports]
    assert results[0] is None
    assert results[1] == results[2] == Quick().roll_out(order)
    assert {report.evaluator for report in learner.reports} == {"eval-1"}


def test_a_trial_of_a_candidate_fetches_its_tensors_over_the_bus(
    tmp_path: Path, order: TrialOrder
) -> None:
    router = MemoryRouter()
    files = TensorFiles(tmp_path / "tensors")
    low_level = LowLevel.load(bundled("low_level"))
    record = origin(None, files, low_level.sha256, 1)
    changed = [
        files.add(ref.name, unpack(ref, files.get(ref.sha256)) * 2)
        if ref.name == "temperature"
        else ref
        for ref in record.tensors
    ]
    record = record.model_copy(update={"tensors": tuple(changed)})
    shelf = Shelf(tmp_path / "versions", files)
    publisher = Publisher(MemoryBus(router), "lab", "learner", files, shelf)
    (policy,) = publisher.offer(1, record)
    contest = Contest(MemoryBus(router), "lab", low_level, HighLevel.load(bundled("high_level")))
    result = contest.roll_out(
        order.model_copy(update={"policy": policy, "policy_sha256": policy_sha256(policy)})
    )
    contest.close()
    publisher.close()
    assert result.policy_sha256 != order.policy_sha256
