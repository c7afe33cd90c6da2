"""One robot of an actor over a bus in memory: real outbox, real inbox, counted steps."""

import threading
import time

from services.actor.act import Runner
from services.actor.config import ActorSettings, FrameSettings
from services.actor.logbook import Logbook
from services.actor.obey import Inbox
from services.actor.observe import Observer
from services.actor.record import Recorder
from services.actor.throttle import Throttle
from services.actor.understand import Listener
from shared.clock import SystemClock
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.heartbeat import RobotHeartbeat
from shared.messages.receipt import Receipt
from shared.rollout.thinking import Lockstep
from shared.wire.codec import decode, encode
from shared.wire.delivery import Courier
from shared.wire.keys import any_robot, robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from shared.wire.outbox import Outbox
from tests.unit.rollout.fakes import CountingRobot, EchoingLowLevel, SayingHighLevel

DEADLINE_S = 60.0


class Newest:
    """What a runner knows of `Refresh`."""

    def __init__(self):
        self.newest = SayingHighLevel("left")


class Bench:
    """A runner, and somebody who listens on the bus; router: what others are on, too."""

    def __init__(self, folder, router=None, **settings):
        rollout = {"max_steps": 30, **settings.pop("rollout", {})}
        base = {"pace": "lockstep", "rollout": rollout, "data": folder}
        self.settings = ActorSettings.model_validate({**base, **settings})
        self.folder, self.clock = folder, SystemClock()
        router = router or MemoryRouter()
        self.bus, self.people = MemoryBus(router), MemoryBus(router)
        self.outbox = Outbox(folder / "outbox.sqlite")
        self.courier = Courier(self.bus, self.outbox, self.clock)
        self.recorder = Recorder(self.bus, self.outbox, self.courier, "lab")
        self.refresh, self.robot = Newest(), CountingRobot()
        self.low_level = EchoingLowLevel()
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
            low_level=self.low_level,
            source=self.refresh,
            thinking=Lockstep(),
            recorder=self.recorder,
            observer=Observer(
                self.bus, "lab", "robot-1", self.clock, FrameSettings(rate_hz=60), Throttle()
            ),
            inbox=Inbox(self.bus, "lab", "robot-1", threading.Event()),
            listener=Listener(self.bus, "lab", "robot-1", self.low_level),
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
