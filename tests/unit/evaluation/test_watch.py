"""What a watch sees, with the real cell and the expert's hand."""

import pytest

from shared.evaluation.watch import Watch, mistake
from shared.workcell import expert
from shared.workcell.env import WorkcellEnv
from shared.workcell.skills import ATTEMPT_STEPS, parse, pick


class Episode:
    """A cell, a watch, and commands that somebody gives."""

    def __init__(self, prompt="make a sandwich with cheese"):
        self.env = WorkcellEnv(max_steps=10_000)
        self.env.reset(seed=5, options={"prompt": prompt})
        self.watch, self.step = Watch(self.env), 0

    def obey(self, command, steps):
        for count in range(steps):
            if count % 20 == 0:
                self.watch.decided(command)
            self.env.step(expert.act(self.env.state, parse(command)))
            self.step += 1
            self.watch.stepped(command, self.step)

    def right(self, previous=None):
        return self.env.task.next_command(self.env.state, self.env.brief, previous)


@pytest.fixture
def episode():
    return Episode()


def test_each_stretch_of_a_command_is_an_attempt_that_succeeds_if_it_was_achieved(episode):
    episode.obey("pick up the bread", 80)
    episode.obey("put it on the plate", 60)
    first, second = episode.watch.finish(episode.step, True)
    assert (first.skill, first.success, first.begin) == ("pick up", True, 0)
    assert (second.skill, second.success, second.begin) == ("put on the plate", True, 80)
    assert 20 < first.steps <= 80
    assert first.flawless


def test_an_attempt_that_was_cut_off_by_another_command_failed(episode):
    episode.obey("pick up the bread", 10)
    episode.obey("pick up the ham", 70)
    first, second = episode.watch.finish(episode.step, False)
    assert (first.success, first.steps) == (False, 10)
    assert second.success


def test_an_attempt_that_the_end_cut_off_counts_only_after_its_time_or_if_achieved(episode):
    episode.obey("pick up the bread", 10)
    assert episode.watch.finish(10, False) == ()
    late = Episode()
    late.obey("put it in the bin", ATTEMPT_STEPS)  # With empty hands.
    (attempt,) = late.watch.finish(ATTEMPT_STEPS, False)
    assert not attempt.success


def test_the_first_wrong_decision_is_named_and_counted(episode):
    episode.obey("pick up the ham", 60)
    episode.obey("put it on the plate", 60)
    attempts = episode.watch.finish(episode.step, False)
    assert (episode.watch.failure, episode.watch.failed_step) == ("wrong object", 0)
    assert episode.watch.wrong >= 3
    assert not attempts[0].flawless
    assert attempts[0].success


def test_a_right_command_that_isnt_achieved_is_the_skills_failure(episode):
    episode.watch.decided("pick up the bread")
    for step in range(1, 4):
        episode.watch.stepped("pick up the bread", step)  # And nobody moves.
    episode.watch.stepped("wait", 4)
    episode.watch.finish(4, False)
    assert (episode.watch.failure, episode.watch.failed_step) == ("pick up failed", 3)


def test_to_change_from_one_right_command_to_another_is_named():
    episode = Episode("put the ham and the cheese in the bin")
    episode.obey("pick up the ham", 20)
    episode.watch.decided("pick up the cheese")
    assert (episode.watch.failure, episode.watch.wrong) == ("changed its mind", 0)


def test_who_succeeds_has_failed_nowhere(episode):
    episode.obey("pick up the ham", 30)
    episode.watch.finish(30, True)
    assert (episode.watch.failure, episode.watch.failed_step) == ("", -1)


def test_a_right_command_in_other_words_is_right(episode):
    episode.watch.decided("pick up the bread")
    assert episode.watch.wrong == 0
    episode.watch.decided("dance")
    assert episode.watch.failure == "unknown command"


@pytest.mark.parametrize(
    ("said", "fine", "name"),
    [
        ("pick up the ham", {"pick up the bread"}, "wrong object"),
        ("put it on the plate", {"pick up the bread"}, "put too soon"),
        ("put it in the bin", {"put it down"}, "wrong place"),
        ("put it in the bin", {"put it down", "pick up the ham"}, "wrong place"),
        ("wait", {"pick up the bread"}, "waited"),
        ("pick up the ham", {"wait"}, "went on when done"),
    ],
)
def test_mistakes_have_names(episode, said, fine, name):
    assert mistake(parse(said), fine, episode.env.state) == name


def test_to_go_on_lifting_what_is_lifted_is_to_put_it_too_late(episode):
    episode.obey("pick up the bread", 70)
    state = episode.env.state
    assert mistake(parse(pick(0)), {"put it on the plate"}, state) == "put too late"
    assert mistake(parse(pick(3)), {"put it on the plate"}, state) == "wrong object"
