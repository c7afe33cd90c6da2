"""A robot says what it would make of a phrase, and its control loop never waits for that."""

import threading

import pytest

from shared.errors import RefusedError
from shared.messages.phrase import PhraseAnswer, PhraseQuestion
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key
from tests.unit.actor.bench import Bench

KEY = robot_key("lab", "robot-1", "phrase")


@pytest.fixture
def bench(tmp_path):
    made = Bench(tmp_path, rollout={"max_steps": 100_000})
    yield made
    made.close()


class Asking:
    """A question that is asked beside the test's own thread."""

    def __init__(self, bench, text, robot="robot-1", anywhere=False):
        self.answer = self.error = None
        self._question = encode(PhraseQuestion(robot=robot, text=text, anywhere=anywhere))
        self._bus = bench.people
        self._thread = threading.Thread(target=self._ask)
        self._thread.start()

    def _ask(self):
        try:
            self.answer = decode(PhraseAnswer, self._bus.ask(KEY, self._question, timeout_s=10))
        except RefusedError as error:
            self.error = error

    def __bool__(self):
        return bool(self.answer or self.error)


def test_a_phrase_is_read_and_not_obeyed(bench):
    asking = Asking(bench, "to the left")
    bench.tick_until(lambda: asking)
    answer = asking.answer
    assert (answer.means, answer.known, answer.refused) == ("left", False, "")
    assert [near.command for near in answer.nearest] == ["left", "right"]
    assert bench.runner._rollout.corrections == 0
    assert not bench.runner._rollout._overrides.held


def test_without_a_phrase_it_tells_its_commands(bench):
    asking = Asking(bench, None)
    bench.tick_until(lambda: asking)
    assert asking.answer.commands == ("left", "right")


def test_why_it_would_be_refused_is_told(bench):
    bench.low_level.objection = lambda *_: "nothing is in the hands"
    asking = Asking(bench, "put it down")
    bench.tick_until(lambda: asking)
    assert (asking.answer.means, asking.answer.refused) == (None, "nothing is in the hands")


def test_the_control_loop_goes_on_while_a_phrase_is_read(bench):
    reading, read = threading.Event(), threading.Event()
    bench.low_level.nearest = lambda *_: [reading.set(), read.wait(10)][:0]
    asking = Asking(bench, "a phrase with many words")
    bench.tick_until(reading.is_set)
    before = len(bench.robot.actions)
    bench.tick_until(lambda: len(bench.robot.actions) > before + 100)
    assert not asking
    read.set()
    bench.tick_until(lambda: asking)
    assert asking.answer.text == "a phrase with many words"


def test_a_question_about_another_robot_is_refused(bench):
    asking = Asking(bench, "wait", robot="robot-2")
    bench.tick_until(lambda: asking)
    assert "robot-2" in str(asking.error)


def test_whether_it_is_understood_at_all_needs_no_scene_and_no_turn_of_the_loop(bench):
    bench.low_level.objection = lambda *_: "that isn't in the scene"
    asking = Asking(bench, "to the left", anywhere=True)
    asking._thread.join(10)
    answer = asking.answer
    assert (answer.means, answer.refused) == ("left", "")
    assert answer.low_level_sha256 == bench.low_level.sha256
