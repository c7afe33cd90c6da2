"""What the rollout promises, held against parts that only count: who is asked when, and its end."""

from concurrent.futures import Future

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.rollout.thinking import Lockstep
from tests.unit.rollout.fakes import CountingRobot, SayingHighLevel, advance, rollout_of, said


def test_the_high_level_is_asked_every_n_steps_and_the_low_level_moves_in_between():
    decisions: list[Decision] = []
    rollout = rollout_of("go left", decisions=decisions, decision_steps=20)
    advance(rollout, 65)
    assert [decision.step for decision in decisions] == [0, 20, 40, 60]
    assert [decision.index for decision in decisions] == [0, 1, 2, 3]
    assert {decision.executed.text for decision in decisions} == {"go left"}
    assert {decision.chosen_by for decision in decisions} == {"1.0"}


def test_the_high_level_looks_at_once_after_an_interjection():
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions, decision_steps=100)
    advance(rollout, 13)
    rollout.correct(said(Kind.OVERRIDE, "up"))
    advance(rollout, 1)
    assert [decision.step for decision in decisions] == [0, 13]


def test_the_high_level_is_shown_the_commands_that_were_in_force_before():
    high_level = SayingHighLevel("a", "b", "c")
    rollout = rollout_of(high_level=high_level, decision_steps=10, history=2)
    advance(rollout, 12)
    rollout.correct(said(Kind.OVERRIDE, "x"))
    advance(rollout, 20)
    assert high_level.seen[0].previous == ()
    assert high_level.seen[1].previous == ("a",)
    assert high_level.seen[-1].previous[-1] == "x"
    assert all(len(seen.previous) <= 2 for seen in high_level.seen)


def test_an_answer_that_comes_late_is_in_force_late_but_says_what_was_seen():
    robot = CountingRobot()
    decisions: list[Decision] = []
    thinking = Lockstep(latency_steps=4)
    rollout = rollout_of(
        "left",
        "rightward",
        thinking=thinking,
        robot=robot,
        decisions=decisions,
        decision_steps=10,
        latency_steps=4,
    )
    advance(rollout, 20)
    assert [decision.step for decision in decisions] == [0, 10]
    assert [int(action[0]) for action in robot.actions] == [4] * 14 + [9] * 6


def test_a_slow_high_level_never_stalls_the_robot():
    class Never:
        def __init__(self):
            self.answers = [True]
            self.future: Future = Future()

        def ask(self, high_level, observation, past):
            self.proposals = high_level.propose(observation, past)

        def answer(self, step):
            del step
            return self.proposals if self.answers and self.answers.pop() else None

        def close(self):
            pass

    decisions: list[Decision] = []
    rollout = rollout_of("left", thinking=Never(), decisions=decisions, decision_steps=5)
    advance(rollout, 50)
    assert len(decisions) == 1


def test_the_episode_ends_at_success():
    rollout = rollout_of("left", robot=CountingRobot(done_at=4))
    advance(rollout, 4)
    assert rollout.over
    assert rollout.done


def test_a_correction_after_the_end_is_refused():
    rollout = rollout_of("left", max_steps=3)
    advance(rollout, 3)
    assert rollout.over
    assert not rollout.advance()
    assert "over" in rollout.correct(said(Kind.OVERRIDE, "up")).reason


def test_a_paused_robot_stands_and_its_steps_do_not_count():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot)
    advance(rollout, 2)
    rollout.correct(said(Kind.PAUSE))
    assert not rollout.advance()
    assert rollout.step == len(robot.actions) == 2
    rollout.correct(said(Kind.RESUME))
    assert rollout.advance()
