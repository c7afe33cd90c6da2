"""A robot in doubt over a bus in memory, with a clock of the test's own: it waits, and goes on."""

import pytest

from services.actor.ask import Asker
from services.actor.config import ActorSettings, HelpSettings
from services.actor.logbook import Logbook
from shared.budget import HOUR_NS
from shared.clock import ManualClock
from shared.messages.correction import Kind
from shared.messages.help import Reason
from tests.unit.rollout.fakes import (
    ScoringHighLevel,
    rollout_of,
    said,
)

S = 1_000_000_000


class Bench:
    """A rollout whose high level hesitates from the first look on, and who asks for it."""

    def __init__(self, folder, *scores, rollout=None, **settings):
        self.clock, self.folder = ManualClock(), folder
        self.settings = HelpSettings.model_validate(
            {"threshold": 0.4, "wait_s": 10, "pause_steps": 30} | settings
        )
        self.decisions = []
        high_level = ScoringHighLevel(*(scores or (0.5,)))
        self.rollout = rollout_of(high_level=high_level, **(rollout or {}))
        self.rollout._decided = self._decided
        self.start()

    def start(self):
        self.asker = Asker("robot-1", self.settings, Logbook(self.folder / "r.json"), self.clock)

    def _decided(self, decision):
        self.decisions.append(self.asker.look(self.rollout, decision, lambda: False))

    def say(self, kind, text=None, **fields):
        correction = said(kind, text, **fields)
        receipt = self.rollout.correct(correction)
        self.asker.hear(self.rollout, correction, receipt)
        return receipt

    def turn(self, steps=1):
        """So many turns of a loop that takes 20 ms each; how many of them moved the robot."""
        moved = 0
        for _ in range(steps):
            moved += self.rollout.advance()
            self.asker.mind(self.rollout)
            self.clock.advance(S // 50)
        return moved


@pytest.fixture
def bench(tmp_path):
    return lambda *scores, **settings: Bench(tmp_path, *scores, **settings)


def test_an_unsure_robot_stands_still_and_carries_on_when_nobody_comes(bench):
    bench = bench()
    assert bench.turn(500) == 0
    assert bench.asker.waiting
    assert bench.asker.call.waits_s == pytest.approx(0)
    assert bench.turn(20) >= 19
    assert (bench.asker.waiting, bench.asker.expired) == (False, 1)
    assert (bench.asker.call.decision, bench.asker.call.waits_s) == ("ep-1-0", 0)


def test_the_decision_says_that_it_asks_why_and_how_long_it_waits(bench):
    bench = bench(1.0, 0.5, measure="margin")
    bench.turn(21)
    sure, unsure = bench.decisions
    assert sure.help is None
    assert (unsure.help.reason, unsure.help.doubt) == (Reason.MARGIN, 1.0)
    assert (unsure.help.decision, unsure.help.waits_s) == (unsure.id, 10)
    assert not unsure.awaits_verdict
    assert bench.rollout.awaited is unsure


@pytest.mark.parametrize(
    ("kind", "text"), [(Kind.OVERRIDE, "up"), (Kind.APPROVE, None), (Kind.PASS, None)]
)
def test_any_word_about_the_robot_ends_its_waiting_at_once(bench, kind, text):
    bench = bench()
    bench.turn(5)
    assert bench.say(kind, text).accepted
    assert bench.turn(10) == 10
    assert bench.asker.call is None
    assert bench.asker.expired == 0


def test_also_a_word_about_an_earlier_decision_does(bench):
    bench = bench(1.0, 0.5)
    bench.turn(25)
    assert bench.asker.waiting
    bench.say(Kind.APPROVE, decision="ep-1-0")
    assert bench.turn(5) == 5


def test_a_word_that_is_refused_or_only_pauses_leaves_it_waiting(bench):
    bench = bench()
    bench.turn(5)
    assert not bench.say(Kind.RELEASE).accepted
    assert not bench.say(Kind.OVERRIDE, "up", episode="ep-0").accepted
    assert bench.say(Kind.PAUSE).accepted
    assert bench.say(Kind.RESUME).accepted
    assert bench.turn(5) == 0


def test_a_release_answers_a_robot_that_is_stuck_with_a_persons_word(bench):
    bench = bench(1.0, threshold=None, stuck_steps=40)
    bench.turn(1)
    bench.say(Kind.OVERRIDE, "up")
    bench.turn(100)
    assert bench.asker.call.reason is Reason.STUCK
    bench.say(Kind.RELEASE)
    assert bench.turn(5) == 5
    assert bench.rollout.command.text == "left"


def test_with_no_time_to_wait_it_only_says_that_it_is_in_doubt(bench):
    bench = bench(wait_s=0)
    assert bench.turn(40) == 40
    assert not bench.asker.waiting
    assert {decision.help.decision for decision in bench.decisions} == {"ep-1-0"}


def test_an_answer_gives_rest_for_a_while_and_then_it_asks_again(bench):
    bench = bench()
    bench.turn(1)
    bench.say(Kind.APPROVE)
    bench.turn(100)
    asked = [decision.help and decision.help.decision for decision in bench.decisions]
    assert asked == ["ep-1-0", None, "ep-1-2"]


def test_in_supervised_lockstep_the_verdict_is_waited_for_and_no_clock(bench):
    bench = bench(rollout={"supervised": True})
    assert bench.turn(1000) == 0
    assert not bench.asker.waiting
    assert bench.rollout.awaited.help.waits_s == 0
    bench.say(Kind.PASS)
    assert bench.turn(5) == 5
    assert bench.asker.call is None


def test_the_budget_holds_within_an_hour_and_over_a_restart(bench):
    bench = bench(per_hour=2, pause_steps=0, wait_s=0)
    for _ in range(2):
        bench.turn(20)
        assert bench.asker.call
        bench.say(Kind.APPROVE)
    bench.turn(20)
    assert bench.asker.call is None
    bench.start()  # As after a crash.
    bench.turn(20)
    assert bench.asker.call is None
    bench.clock.advance(HOUR_NS)
    bench.turn(20)
    assert bench.asker.call


def test_another_episode_begins_without_a_call(bench):
    bench = bench()
    bench.turn(2)
    assert bench.asker.news()
    assert not bench.asker.news()
    bench.asker.begin()
    assert (bench.asker.call, bench.asker.waiting, bench.asker.news()) == (None, False, True)


def test_by_completion_alone_a_stuck_robot_is_looked_at_all_the_same(bench):
    rollout = {"replan": "completion", "stuck_steps": 70}
    bench = bench(1.0, threshold=None, stuck_steps=70, rollout=rollout)
    bench.turn(75)
    assert bench.asker.waiting
    assert bench.asker.call.reason is Reason.STUCK


def test_by_completion_alone_who_is_to_call_when_stuck_has_a_stuck_timer():
    settings = ActorSettings.model_validate(
        {"rollout": {"replan": "completion"}, "help": {"stuck_steps": 70}}
    )
    assert settings.hierarchy.patience_steps == 70
    for tree in ({"rollout": {"replan": "completion"}}, {"help": {"stuck_steps": 70}}):
        made = ActorSettings.model_validate(tree)
        assert made.hierarchy == made.rollout
