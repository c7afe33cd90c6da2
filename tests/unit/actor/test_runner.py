"""One robot of an actor over a bus in memory: real outbox, real inbox, counted steps."""

import threading
import time

import numpy as np
import pytest

from services.actor.act import Logbook, Runner
from services.actor.config import ActorSettings, FrameSettings
from services.actor.obey import Inbox
from services.actor.observe import Observer
from services.actor.record import Recorder
from shared.clock import SystemClock
from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode, Outcome
from shared.messages.frame import Frame
from shared.messages.heartbeat import RobotHeartbeat, RobotState
from shared.messages.policy import Version
from shared.messages.receipt import Receipt
from shared.rollout.thinking import Lockstep
from shared.seeds import purpose
from shared.wire.codec import decode, encode
from shared.wire.delivery import Courier
from shared.wire.keys import any_robot, robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from shared.wire.outbox import Outbox
from tests.unit.rollout.fakes import CountingRobot, EchoingLowLevel, SayingHighLevel, said

DEADLINE_S = 10.0


class Newest:
    """What a runner knows of `Refresh`."""

    def __init__(self):
        self.newest = SayingHighLevel("left")


class Bench:
    """A runner, and somebody who listens on the bus."""

    def __init__(self, folder, **settings):
        rollout = {"max_steps": 30, **settings.pop("rollout", {})}
        base = {"pace": "lockstep", "rollout": rollout, "data": folder}
        self.settings = ActorSettings.model_validate({**base, **settings})
        self.folder, self.clock = folder, SystemClock()
        router = MemoryRouter()
        self.bus, self.people = MemoryBus(router), MemoryBus(router)
        self.outbox = Outbox(folder / "outbox.sqlite")
        self.courier = Courier(self.bus, self.outbox, self.clock)
        self.recorder = Recorder(self.bus, self.outbox, self.courier, "lab")
        self.refresh, self.robot = Newest(), CountingRobot()
        self.heard = {"decision": [], "episode": [], "heartbeat": []}
        for name, kind in (
            ("decision", Decision),
            ("episode", Episode),
            ("heartbeat", RobotHeartbeat),
        ):
            self.people.subscribe(any_robot("lab", name), self.listen(name, kind))
        self.runner = self.make_runner()

    def listen(self, name, kind):
        return lambda _, payload: self.heard[name].append(decode(kind, payload))

    def make_runner(self):
        return Runner(
            "robot-1",
            0,
            settings=self.settings,
            robot=self.robot,
            low_level=EchoingLowLevel(),
            source=self.refresh,
            thinking=Lockstep(),
            recorder=self.recorder,
            observer=Observer(self.bus, "lab", "robot-1", self.clock, FrameSettings(rate_hz=60)),
            inbox=Inbox(self.bus, "lab", "robot-1", threading.Event()),
            logbook=Logbook(self.folder / "robot-1.json"),
            clock=self.clock,
        )

    def tick_until(self, ready):
        deadline = time.monotonic() + DEADLINE_S
        while not ready():
            assert time.monotonic() < deadline, f"not in time: {self.heard}"
            if not self.runner.tick():
                time.sleep(0.001)

    def say(self, correction):
        """Ask the robot as the API does; the loop goes on turning meanwhile."""
        answers = []
        key = robot_key("lab", "robot-1", "correction")
        asking = threading.Thread(
            target=lambda: answers.append(self.people.ask(key, encode(correction), timeout_s=5))
        )
        asking.start()
        self.tick_until(lambda: answers)
        asking.join()
        return decode(Receipt, answers[0])

    def close(self):
        self.runner.close()
        self.recorder.close(farewell_s=0)
        self.courier.close()
        self.outbox.close()
        self.people.close()
        self.bus.close()


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


def test_between_two_episodes_only_what_is_said_of_the_past_is_taken(bench):
    actor = bench(rollout={"max_steps": 3}, episodes_per_version=1)
    actor.tick_until(lambda: actor.heard["episode"])
    over = actor.heard["episode"][0].id
    late = actor.say(said(Kind.OVERRIDE, "up", episode=over))
    assert late.reason == f"episode {over} is over and the next one has not begun"
    past = said(Kind.RELABEL, "up", episode=over, first_step=0, end_step=2)
    assert (actor.say(past).step, actor.say(past).reason) == (0, "")
