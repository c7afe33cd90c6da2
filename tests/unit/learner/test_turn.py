"""What stands between a candidate and the robots: trials, some robots first, people's rulings."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from services.learner.canary import CanarySettings
from services.learner.gate import GateSettings
from services.learner.store.store import Answer, RoundState
from services.learner.trials import TrialSettings, policy_sha256
from shared.errors import RefusedError
from shared.messages.episode import Outcome
from shared.messages.heartbeat import LearnerState
from shared.messages.policy import PolicyAnnouncement, Version
from shared.messages.ruling import Ruling, Verb
from shared.messages.trial import TrialOrder, TrialReport, TrialResult
from shared.seeds import GATE
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key, service_key
from tests.unit.learner.bench import Bench
from tests.unit.learner.records import episode, ruling

PAIRS = 4
TRIALS = GateSettings(trials=TrialSettings(episodes=PAIRS, patience_s=60, again_s=30))
CANARY = GateSettings(canary=CanarySettings(robots=("robot-1",), episodes=3, within_s=900))


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.learner.close()


def trained(bench: Bench, gate: GateSettings, value: float = 1.0) -> Bench:
    """A learner with this gate whose first round has just been trained."""
    bench.restart(gate)
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate(value)
    bench.beat()
    return bench


class Evaluator:
    """An actor in evaluation mode, without a cell."""

    def __init__(self, bench: Bench, name: str = "eval-1") -> None:
        self._bench, self._name = bench, name
        self._key = robot_key("lab", name, "trial")

    def ask(self, result: TrialResult | None = None, low: str = "") -> TrialOrder | None:
        low = low or self._bench.low_sha256
        report = TrialReport(evaluator=self._name, low_level_sha256=low, result=result)
        answer = self._bench.robots.ask(self._key, encode(report))
        return decode(TrialOrder, answer) if answer else None

    def work(self, better: bool, orders: int = 99) -> list[TrialOrder]:
        """Hand in results until there is nothing left; the candidate wins if `better`."""
        done, result = [], None
        while len(done) < orders and (order := self.ask(result)):
            mine = len(order.policy.bank) == 2  # The candidate learned a phrase.
            result = outcome(order, mine == better)
            done.append(order)
        if result:
            self.ask(result)
        return done


def outcome(order: TrialOrder, success: bool) -> TrialResult:
    return TrialResult(
        policy_sha256=order.policy_sha256,
        plan_sha256=order.plan_sha256,
        seed=order.seed,
        success=success,
        row={"steps": 3},
    )


# -- labels


def judged_by_few(bench: Bench, gate: GateSettings) -> Bench:
    """A learner whose first candidate had fewer labels held out than it takes to be judged."""
    bench.restart(gate)
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate(held_out=3)
    bench.beat()
    return bench


def test_a_candidate_that_nothing_could_judge_stays_here_until_somebody_promotes_it(
    bench: Bench,
) -> None:
    judged_by_few(bench, GateSettings())
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.REFUSED
    assert round_.reason.startswith("held out 3 labels, needs 20: not judged; corrections go on")
    assert round_.figures["unjudged"] == "held out 3 labels, needs 20: not judged"
    assert str(bench.announced().version) == "2.0"
    rule(bench, verb=Verb.PROMOTE, round=1)
    assert str(bench.announced().version) == "2.1"


def test_what_goes_out_unjudged_by_setting_has_that_on_record(bench: Bench) -> None:
    judged_by_few(bench, GateSettings(unjudged="let-out"))
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.PASSED
    assert "not judged" in round_.figures["unjudged"]
    assert str(bench.announced().version) == "2.1"


def test_where_labels_are_too_few_trials_judge_and_the_record_says_both(bench: Bench) -> None:
    judged_by_few(bench, TRIALS)
    assert bench.state() is LearnerState.JUDGING
    Evaluator(bench).work(better=True)
    bench.beat()
    (round_,) = bench.store.rounds()
    assert (round_.state, round_.figures["trials"]["candidate"]["n"]) == (RoundState.PASSED, PAIRS)
    assert "not judged" in round_.figures["unjudged"]


# -- trials


def test_a_candidate_is_tried_in_pairs_before_it_goes_out(bench: Bench) -> None:
    trained(bench, TRIALS)
    assert bench.state() is LearnerState.JUDGING
    assert str(bench.announced().version) == "2.0"
    orders = Evaluator(bench).work(better=True)
    assert [order.seed for order in orders] == [
        GATE.start + pair for pair in range(PAIRS) for _ in range(2)
    ]
    assert len({order.policy_sha256 for order in orders}) == 2
    assert bench.learner.heartbeat().progress == 1.0
    bench.beat()
    assert str(bench.announced().version) == "2.1"
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.PASSED
    assert round_.figures["trials"]["candidate"]["success"] == 1.0
    assert round_.figures["trials"]["in_force"]["success"] == 0.0


def test_a_candidate_that_does_worse_stays_here_and_the_reason_tells_both(bench: Bench) -> None:
    trained(bench, TRIALS)
    Evaluator(bench).work(better=False)
    bench.beat()
    assert str(bench.announced().version) == "2.0"
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.REFUSED
    assert "in 0 of 4 scenes, the version in force in 4 of" in round_.reason


def test_the_tensors_of_a_candidate_can_be_fetched_by_who_tries_it(bench: Bench) -> None:
    trained(bench, TRIALS, value=3.0)
    order = Evaluator(bench).ask()
    assert order
    key = service_key("lab", "learner", "learner", "tensor")
    for ref in order.policy.tensors:
        assert bench.robots.ask(f"{key}/{ref.sha256}/0") == bench.files.get(ref.sha256)


def test_a_restart_trains_nothing_and_tries_nothing_twice(bench: Bench) -> None:
    trained(bench, TRIALS)
    first = Evaluator(bench).work(better=True, orders=3)
    bench.learner.close()
    bench.restart(TRIALS)
    assert bench.trainer.begun == []
    assert bench.state() is LearnerState.JUDGING
    rest = Evaluator(bench).work(better=True)
    done = {(order.policy_sha256, order.seed) for order in (*first, *rest)}
    assert (len(done), len(first) + len(rest)) == (2 * PAIRS, 2 * PAIRS)
    bench.beat()
    assert str(bench.announced().version) == "3.1"
    assert bench.trainer.forgotten == [1]


def test_what_other_code_tried_makes_no_pairs(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    trained(bench, TRIALS)
    before = Evaluator(bench).work(better=True, orders=3)
    bench.learner.close()
    monkeypatch.setattr("services.learner.trials.code_version", lambda: "another")
    bench.restart(TRIALS)
    assert bench.state() is LearnerState.JUDGING
    after = Evaluator(bench).work(better=True)
    assert len(after) == 2 * PAIRS
    assert {one.plan_sha256 for one in before}.isdisjoint(one.plan_sha256 for one in after)


def test_an_episode_that_nobody_hands_in_is_given_to_another(bench: Bench) -> None:
    trained(bench, TRIALS)
    lost = Evaluator(bench).ask()
    other = Evaluator(bench, "eval-2").work(better=True)
    assert lost is not None
    assert lost.seed not in [o.seed for o in other if o.policy_sha256 == lost.policy_sha256]
    bench.clock.advance(31 * 10**9)
    again = Evaluator(bench, "eval-2").ask()
    assert again == lost


def test_without_any_evaluator_a_candidate_is_refused_and_told_what_is_missing(
    bench: Bench,
) -> None:
    trained(bench, TRIALS)
    bench.beat(61)
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.REFUSED
    assert "mode=evaluation" in round_.reason
    assert Evaluator(bench).ask() is None


def test_an_evaluator_with_another_low_level_gets_no_work(bench: Bench) -> None:
    trained(bench, TRIALS)
    with pytest.raises(RefusedError, match="made for the low level"):
        Evaluator(bench).ask(low="b" * 64)


def test_what_a_policy_is_called_does_not_make_it_another(bench: Bench) -> None:
    told = bench.announced()
    renamed = told.model_copy(update={"version": Version(9, 9), "created_ns": 7})
    assert policy_sha256(renamed) == policy_sha256(told)
    assert policy_sha256(told.model_copy(update={"bank": ("wait", "go")})) != policy_sha256(told)


# -- some robots first


def ran(bench: Bench, name: str, version: str, robot: str = "robot-1", **over: object) -> None:
    """An episode that ran a version."""
    ended = episode(name, robot=robot, version=Version.parse(version), **over)
    bench.store.add(ended.model_copy(update={"low_level_sha256": bench.low_sha256}), 1)


def canary(bench: Bench) -> PolicyAnnouncement:
    key = service_key("lab", "learner", "learner", "canary")
    return decode(PolicyAnnouncement, bench.robots.ask(key))


def test_some_robots_run_a_version_first_and_then_all(bench: Bench) -> None:
    trained(bench, CANARY)
    assert (str(canary(bench).version), canary(bench).robots) == ("2.1", ("robot-1",))
    assert str(bench.announced().version) == "2.0"
    for number in range(3):
        ran(bench, f"first-{number}", "2.1")
        ran(bench, f"other-{number}", "2.0", robot="robot-2")
    bench.beat()
    assert str(bench.announced().version) == "2.1"
    assert bench.announced().robots == ()
    (round_,) = bench.store.rounds()
    assert (round_.state, round_.made) == (RoundState.PASSED, 1)
    version = bench.store.version()
    assert version is not None
    assert (version.number, version.robots) == (1, ())


@pytest.mark.parametrize(
    ("under_it", "why"),
    [({"outcome": Outcome.TIMEOUT}, "success fell"), ({"corrections": 9}, "had to correct")],
)
def test_a_version_that_does_worse_on_a_robot_is_taken_back_from_it(
    bench: Bench, under_it: dict[str, object], why: str
) -> None:
    trained(bench, CANARY)
    for number in range(3):
        ran(bench, f"before-{number}", "2.0", robot="robot-2")
        ran(bench, f"first-{number}", "2.1", **under_it)
    bench.beat()
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.REFUSED
    assert why in round_.reason
    assert str(bench.announced().version) == "2.2"
    assert bench.announced().tensors == bench.origin().tensors
    version = bench.store.version()
    assert version is not None
    assert (version.number, version.again) == (2, 0)


def test_a_version_passes_on_no_robot_while_there_is_nothing_to_compare_it_with(
    bench: Bench,
) -> None:
    trained(bench, GateSettings())
    bench.restart(CANARY)
    bench.happens("e-2")  # Under the version that is no longer in force.
    bench.beat()
    bench.trainer.outcome = bench.candidate(2.0)
    bench.beat()
    for number in range(3):
        ran(bench, f"first-{number}", "3.2")
    bench.beat()
    waiting = bench.store.rounds()[1]
    assert (waiting.state, bench.state()) == (RoundState.RUNNING, LearnerState.JUDGING)
    assert waiting.reason.startswith("no episode ended under the version before")
    assert "900 s at most" in waiting.reason
    ran(bench, "other-0", "3.1", robot="robot-2")
    bench.beat()
    assert str(bench.announced().version) == "3.2"
    assert bench.store.rounds()[1].reason == ""


def test_a_version_that_was_put_back_is_compared_by_what_it_did_under_its_earlier_number(
    bench: Bench,
) -> None:
    trained(bench, GateSettings())
    rule(bench, version=0)
    bench.restart(CANARY)
    bench.happens("e-2")
    bench.beat()
    bench.trainer.outcome = bench.candidate(2.0)
    bench.beat()
    for number in range(3):
        ran(bench, f"first-{number}", "3.3")
    bench.beat()  # Version 2 has the weights of 0, under which e-1 and e-2 were run.
    assert str(bench.announced().version) == "3.3"


def test_a_rollback_to_what_is_in_force_takes_a_version_back_from_the_robots_that_go_first(
    bench: Bench,
) -> None:
    trained(bench, CANARY)
    assert str(canary(bench).version) == "2.1"
    said = rule(bench, version=0)
    assert bench.store.answers()[0].made == 2
    told = bench.announced()
    assert (str(told.version), told.robots) == ("2.2", ())
    assert told.tensors == bench.origin().tensors
    version = bench.store.version()
    assert version is not None
    assert (version.again, version.ruling) == (0, said.id)
    (round_,) = bench.store.rounds()
    assert (round_.state, round_.reason) == (
        RoundState.FAILED,
        "version 2 was put in force while it ran",
    )
    for number in range(9):
        ran(bench, f"first-{number}", "2.1")
    bench.beat()
    assert str(bench.announced().version) == "2.2"
    refused_now = rule(bench, version=2)
    assert "version 2 is in force" in bench.store.answers()[1].reason
    assert refused_now.version == 2


def test_a_robot_that_never_finishes_its_episodes_takes_the_version_back(bench: Bench) -> None:
    trained(bench, CANARY)
    ran(bench, "first-0", "2.1")
    ran(bench, "first-1", "2.1", outcome=Outcome.ABORTED)
    bench.beat(800)
    assert bench.state() is LearnerState.JUDGING
    bench.beat(200)
    assert "finished 1 of 3 episodes" in bench.store.rounds()[0].reason
    assert str(bench.announced().version) == "2.2"


def test_a_restart_goes_on_watching_the_robots_that_go_first(bench: Bench) -> None:
    trained(bench, CANARY)
    bench.learner.close()
    bench.restart(CANARY)
    assert bench.trainer.begun == []
    assert str(bench.announced().version) == "3.0"
    assert str(canary(bench).version) == "3.1"
    for number in range(3):
        ran(bench, f"first-{number}", "3.1")
    bench.beat()
    assert str(bench.announced().version) == "3.1"


# -- rulings


def rule(bench: Bench, **about: object) -> Ruling:
    made = ruling(f"rule-{len(bench.store.answers())}", **about)
    bench.store.add(made, 1)
    bench.beat()
    return made


def refused(bench: Bench) -> Bench:
    """A learner whose first round made a candidate that the gate held back."""
    trained(bench, TRIALS)
    Evaluator(bench).work(better=False)
    bench.beat()
    return bench


def test_a_refused_candidate_goes_out_when_somebody_promotes_it(bench: Bench) -> None:
    refused(bench)
    said = rule(bench, verb=Verb.PROMOTE, round=1)
    assert str(bench.announced().version) == "2.1"
    assert len(bench.announced().bank) == 2
    version = bench.store.version()
    assert version is not None
    assert version.ruling == said.id
    assert bench.store.rounds()[0].state is RoundState.REFUSED
    assert bench.store.answers()[0].made == 1


def test_a_rollback_puts_earlier_weights_in_force_under_a_new_number(bench: Bench) -> None:
    trained(bench, GateSettings())
    assert str(bench.announced().version) == "2.1"
    rule(bench, version=0)
    assert str(bench.announced().version) == "2.2"
    assert bench.announced().tensors == bench.origin().tensors
    bench.happens("e-2")
    bench.beat()
    assert bench.trainer.begun[-1].parent == 2
    bench.trainer.outcome = bench.candidate(5.0)
    bench.beat()
    assert str(bench.announced().version) == "2.3"


@pytest.mark.parametrize(
    ("about", "why"),
    [
        ({"version": 7}, "no version 7; those that there are: 0, 1"),
        ({"version": 1}, "version 1 is in force"),
        ({"verb": Verb.PROMOTE, "round": 1}, "roll back to it"),
        ({"verb": Verb.PROMOTE, "round": 4}, "no round 4"),
    ],
)
def test_a_ruling_that_can_not_be_done_is_answered_with_the_reason(
    bench: Bench, about: dict[str, object], why: str
) -> None:
    trained(bench, GateSettings())
    rule(bench, **about)
    (answer,) = bench.store.answers()
    assert answer.answered_ns is not None
    assert answer.made is None
    assert why in answer.reason
    assert str(bench.announced().version) == "2.1"


def test_a_round_at_work_gives_way_to_what_somebody_put_in_force(bench: Bench) -> None:
    trained(bench, GateSettings())
    bench.happens("e-2")
    bench.beat()
    assert bench.state() is LearnerState.TRAINING
    rule(bench, version=0)
    assert bench.state() is LearnerState.COLLECTING
    assert bench.trainer.stopped
    assert bench.store.rounds()[1].reason == "version 2 was put in force while it ran"


def test_a_round_gives_way_also_if_its_learner_died_before_it_could(bench: Bench) -> None:
    trained(bench, GateSettings())
    bench.happens("e-2")
    bench.beat()
    bench.learner.close()
    back = bench.origin().model_copy(update={"number": 2, "epoch": 2, "again": 0})
    bench.store.add(ruling("rule-0"), 1)
    bench.store.answer(Answer(ruling=ruling("rule-0"), answered_ns=2, made=2), back)
    bench.restart()
    assert bench.trainer.begun == []
    assert bench.store.rounds()[1].reason == "version 2 was put in force while it ran"
    assert str(bench.announced().version) == "3.2"


def test_a_ruling_is_done_once_also_by_the_next_learner(bench: Bench) -> None:
    trained(bench, GateSettings())
    bench.learner.close()
    bench.store.add(ruling("rule-0"), 1)
    bench.restart()
    bench.beat()
    bench.learner.close()
    bench.restart()
    bench.beat()
    assert len(bench.store.versions()) == 3
