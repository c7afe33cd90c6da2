"""One robot of an actor, episode after episode, and what people say to it."""

import time

import numpy as np
import pytest

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode, Outcome
from shared.messages.frame import Frame
from shared.messages.heartbeat import RobotState
from shared.messages.policy import Version
from shared.seeds import purpose
from shared.wire.codec import decode
from shared.wire.keys import any_robot, robot_key
from tests.unit.actor.bench import DEADLINE_S, Bench
from tests.unit.rollout.fakes import SayingHighLevel, ScoringHighLevel, said


@pytest.fixture
def bench(tmp_path):
    made = []

    def make(**settings):
        made.append(Bench(tmp_path, **settings))
        return made[-1]

    yield make
    for one in made:
        one.close()


def current(bench):
    return bench.runner._rollout.episode


def test_episodes_follow_one_another_with_seeds_of_their_own(bench):
    bench = bench()
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 3)
    episodes = bench.heard["episode"]
    assert [episode.number for episode in episodes[:3]] == [0, 1, 2]
    assert len({episode.seed for episode in episodes}) == len(episodes)
    assert {purpose(episode.seed) for episode in episodes} == {"collection"}
    assert [episode.task for episode in episodes[:3]] == ["sandwich", "pack", "bus"]
    assert {episode.outcome for episode in episodes} == {Outcome.TIMEOUT}
    assert {episode.steps for episode in episodes} == {30}


def test_what_the_learner_has_not_taken_stays_in_the_outbox_and_goes_in_order(bench):
    bench = bench()
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 2)
    assert len(bench.outbox) >= 6
    taken = []

    def take(key, payload):
        del key
        taken.append(payload)
        return b"ok"

    bench.people.serve(any_robot("lab", "decision"), take)
    bench.people.serve(any_robot("lab", "episode"), take)
    assert bench.courier.drained(DEADLINE_S)
    first = [decode(Decision, payload).index for payload in taken[:2]]
    assert first == [0, 1]
    assert decode(Episode, taken[2]).decisions == 2


def test_a_correction_over_the_bus_is_obeyed_and_answered_with_its_step(bench):
    bench = bench(rollout={"max_steps": 100_000})
    bench.tick_until(lambda: bench.heard["decision"])
    correction = said(Kind.OVERRIDE, "sideways", episode=current(bench))
    receipt = bench.say(correction)
    assert receipt.accepted
    actions = [int(action[0]) for action in bench.robot.actions]
    assert set(actions[: receipt.step]) == {len("left")}
    assert set(actions[receipt.step :]) <= {len("sideways")}


def test_a_repeated_correction_gets_the_receipt_it_got_before(bench):
    bench = bench(rollout={"max_steps": 100_000})
    bench.tick_until(lambda: bench.heard["decision"])
    correction = said(Kind.OVERRIDE, "sideways", episode=current(bench))
    first, again = bench.say(correction), bench.say(correction)
    assert again == first
    assert bench.runner._rollout.corrections == 1


def test_a_correction_for_an_episode_that_is_over_is_refused_with_the_current_one(bench):
    bench = bench(rollout={"max_steps": 100_000})
    bench.tick_until(lambda: bench.heard["decision"])
    receipt = bench.say(said(Kind.OVERRIDE, "up", episode="ep-old"))
    assert not receipt.accepted
    assert current(bench) in receipt.reason


def test_new_weights_are_taken_up_only_between_two_episodes(bench):
    bench = bench()
    bench.tick_until(lambda: len(bench.robot.actions) == 5)
    newer = SayingHighLevel("right")
    newer.version = Version(1, 1)
    bench.refresh.newest = newer
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 2)
    assert [str(episode.version) for episode in bench.heard["episode"][:2]] == ["1.0", "1.1"]
    versions = [
        {str(d.version) for d in bench.heard["decision"] if d.episode == episode.id}
        for episode in bench.heard["episode"][:2]
    ]
    assert versions == [{"1.0"}, {"1.1"}]


def test_a_robot_waits_for_a_newer_version_when_its_share_is_done_also_after_a_restart(bench):
    bench = bench(episodes_per_version=2)
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 2)
    bench.tick_until(lambda: bench.heard["heartbeat"][-1].state is RobotState.IDLE)
    bench.runner.close()
    bench.runner = bench.make_runner()
    for _ in range(50):
        assert not bench.runner.tick()
    newer = SayingHighLevel("right")
    newer.version = Version(1, 1)
    bench.refresh.newest = newer
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 3)
    assert bench.heard["episode"][2].number == 2


def test_a_robot_whose_new_version_never_comes_goes_on_with_the_one_it_has(bench):
    bench = bench(episodes_per_version=1, wait_for_version_s=0.2)
    bench.tick_until(lambda: len(bench.heard["episode"]) >= 3)
    assert {str(episode.version) for episode in bench.heard["episode"]} == {"1.0"}


def test_a_waiting_decision_is_shown_again_and_a_verdict_frees_the_robot(bench):
    bench = bench(rollout={"supervised": True})
    bench.tick_until(lambda: len(bench.heard["decision"]) >= 2)
    ids = {decision.id for decision in bench.heard["decision"]}
    assert len(ids) == 1
    assert len(bench.robot.actions) == 0
    bench.say(said(Kind.PASS, episode=current(bench), decision=ids.pop()))
    bench.tick_until(lambda: len(bench.robot.actions) > 0)


def test_without_a_verdict_the_robot_goes_on_after_the_time_that_was_set(bench):
    bench = bench(rollout={"supervised": True}, verdict_timeout_s=0.05)
    bench.tick_until(lambda: bench.robot.actions)


def test_a_robot_in_doubt_stands_still_tells_it_at_once_and_obeys_who_answers(bench):
    bench = bench(rollout={"max_steps": 100_000}, help={"threshold": 0.4, "wait_s": 3600})
    bench.refresh.newest = ScoringHighLevel(0.5)
    bench.tick_until(lambda: len(bench.heard["heartbeat"]) >= 2)
    asking = bench.heard["heartbeat"][1]  # Sooner than it were due: the first one began it all.
    assert asking.state is RobotState.ASKING
    bench.tick_until(lambda: len(bench.heard["decision"]) >= 2)  # It is shown again meanwhile.
    assert bench.robot.actions == []
    decision, call = bench.heard["decision"][0], asking.help
    assert call.decision == decision.help.decision == decision.id
    assert 0 < call.waits_s <= 3600
    bench.say(said(Kind.OVERRIDE, "sideways", episode=current(bench), decision=decision.id))
    bench.tick_until(lambda: len(bench.robot.actions) > 30)
    assert {int(action[0]) for action in bench.robot.actions} == {len("sideways")}
    bench.tick_until(lambda: bench.heard["heartbeat"][-1].state is RobotState.ACTING)
    assert bench.heard["heartbeat"][-1].help is None


def test_an_episode_that_is_broken_off_is_told_as_aborted(bench):
    bench = bench(rollout={"max_steps": 100_000})
    bench.tick_until(lambda: bench.heard["decision"])
    bench.runner.close()
    deadline = time.monotonic() + DEADLINE_S
    while not bench.heard["episode"]:
        assert time.monotonic() < deadline
        time.sleep(0.005)
    assert bench.heard["episode"][0].outcome is Outcome.ABORTED


def test_an_episode_in_which_the_actor_died_is_told_as_aborted_by_the_next_one(bench):
    bench = bench(rollout={"max_steps": 100_000, "decision_steps": 10})
    bench.tick_until(lambda: len(bench.robot.actions) == 25)
    broken = current(bench)
    bench.runner._inbox.close()
    bench.runner = bench.make_runner()  # As a new process does after a kill.
    bench.tick_until(lambda: bench.heard["episode"])
    told = bench.heard["episode"][0]
    assert told.id == broken
    assert told.outcome is Outcome.ABORTED
    assert told.decisions == 3
    bench.tick_until(lambda: bench.runner._rollout is not None)
    assert current(bench) != broken


def test_pictures_are_made_only_while_somebody_watches(bench):
    bench = bench(rollout={"max_steps": 100_000})
    made = []
    picture = bench.robot.picture
    bench.robot.picture = lambda *size: made.append(size) or picture(*size)
    bench.tick_until(lambda: len(bench.robot.actions) > 200)
    assert not made
    frames = []
    subscription = bench.people.subscribe(
        robot_key("lab", "robot-1", "frame-top"),
        lambda _, payload: frames.append(decode(Frame, payload)),
    )
    bench.tick_until(lambda: len(frames) >= 3)
    subscription.close()
    assert {camera for _, camera, *_ in made} == {"top"}
    sequence = [frame.sequence for frame in frames]
    assert sequence == sorted(set(sequence))
    assert bytes(frames[0].arrays["jpeg"][:2]) == b"\xff\xd8"
    assert frames[0].arrays["jpeg"].dtype == np.uint8


def test_a_stop_between_two_episodes_holds_in_the_next_one_until_somebody_says_resume(bench):
    actor = bench(rollout={"max_steps": 3}, pace="real-time", rest_s=0.2)
    actor.tick_until(lambda: actor.heard["episode"])
    over = actor.heard["episode"][0].id
    assert (actor.say(said(Kind.PAUSE, episode=over)).step, actor.runner._rollout) == (0, None)
    actor.tick_until(lambda: actor.heard["heartbeat"][-1].state is RobotState.PAUSED)
    actor.tick_until(lambda: actor.heard["heartbeat"][-1].episode not in (None, over))
    moved, last = len(actor.robot.actions), actor.heard["heartbeat"][-1]
    for _ in range(20):
        actor.runner.tick()
    assert (len(actor.robot.actions), last.state) == (moved, RobotState.PAUSED)
    assert actor.say(said(Kind.RESUME, episode=last.episode)).accepted
    actor.tick_until(lambda: len(actor.robot.actions) > moved)


def test_a_stop_that_comes_after_its_episode_has_ended_stops_the_one_that_runs(bench):
    actor = bench(rollout={"max_steps": 100})
    actor.tick_until(lambda: actor.heard["episode"] and actor.runner._rollout)
    late = actor.say(said(Kind.PAUSE, episode=actor.heard["episode"][-1].id))
    assert late.accepted
    assert actor.runner._rollout.paused


def test_between_two_episodes_only_what_is_said_of_the_past_is_taken(bench):
    actor = bench(rollout={"max_steps": 3}, episodes_per_version=1)
    actor.tick_until(lambda: actor.heard["episode"])
    over = actor.heard["episode"][0].id
    late = actor.say(said(Kind.OVERRIDE, "up", episode=over))
    assert late.reason == f"episode {over} is over and the next one has not begun"
    past = said(Kind.RELABEL, "up", episode=over, first_step=0, end_step=2)
    assert (actor.say(past).step, actor.say(past).reason) == (0, "")
