"""The composition root of the actor: the only file here that names concrete classes."""

import threading
from contextlib import ExitStack

import torch

from services.actor.act import Runner
from services.actor.config import ActorSettings, Pace
from services.actor.draw import Drawer
from services.actor.kinds import make_robot
from services.actor.logbook import Logbook
from services.actor.obey import Inbox
from services.actor.observe import Observer
from services.actor.record import Recorder
from services.actor.refresh import Refresh
from services.actor.throttle import Throttle
from services.actor.understand import Listener
from shared.clock import SystemClock
from shared.messages.policy import Version
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout.thinking import Beside, Lockstep, Thinking
from shared.wire.bus import Bus, open_bus
from shared.wire.delivery import Courier
from shared.wire.outbox import Outbox

NEVER_ANNOUNCED = Version(0, 0)  # Whatever a learner announces is newer.


class Actor:
    """The parts of one actor process, joined; close it to give everything back."""

    def __init__(self, settings: ActorSettings) -> None:
        self._closing = ExitStack()
        try:
            self._build(settings)
        except BaseException:
            self._closing.close()
            raise

    def _build(self, settings: ActorSettings) -> None:
        torch.set_num_threads(settings.threads)
        settings.data.mkdir(parents=True, exist_ok=True)
        self.clock = SystemClock()
        self.wake = threading.Event()
        self.throttle = Throttle()
        bus = self._closing.enter_context(open_bus(settings.bus))
        outbox = self._closing.enter_context(Outbox(settings.data / "outbox.sqlite"))
        courier = Courier(bus, outbox, self.clock)
        self._closing.callback(courier.close)
        recorder = Recorder(bus, outbox, courier, settings.bus.fleet)
        self._closing.callback(recorder.close)
        low_level = LowLevel.load(settings.low_level or bundled("low_level"))
        self.refresh = Refresh(
            bus,
            settings.bus.fleet,
            newest_on_disk(settings),
            low_level.sha256,
            settings.data / "high_level",
            settings.robots,
        )
        self._closing.callback(self.refresh.close)
        self._drawer = Drawer(settings.kind, settings.site, settings.skills)
        self._closing.callback(self._drawer.close)
        self.runners = [
            self._runner(index, name, settings, bus, recorder, low_level)
            for index, name in enumerate(settings.robots, settings.first_index)
        ]

    def _runner(
        self,
        index: int,
        name: str,
        settings: ActorSettings,
        bus: Bus,
        recorder: Recorder,
        low_level: LowLevel,
    ) -> Runner:
        fleet = settings.bus.fleet
        return Runner(
            name,
            index,
            settings=settings,
            robot=make_robot(settings.kind, settings.site, settings.skills),
            low_level=low_level,
            source=self.refresh.of(name),
            thinking=make_thinking(settings),
            recorder=recorder,
            observer=self._observer(name, settings, bus),
            inbox=Inbox(bus, fleet, name, self.wake),
            listener=Listener(bus, fleet, name, low_level),
            logbook=Logbook(settings.data / f"{name}.json"),
            clock=self.clock,
        )

    def _observer(self, name: str, settings: ActorSettings, bus: Bus) -> Observer:
        fleet, drawn = settings.bus.fleet, self._drawer.photographer
        return Observer(bus, fleet, name, self.clock, settings.frames, self.throttle, drawn)

    def close(self) -> None:
        """Deliver no more, and leave the bus; what was not delivered stays on disk."""
        self._closing.close()


def newest_on_disk(settings: ActorSettings) -> HighLevel:
    """The version that was taken up last, or the checkpoint to begin with."""
    cached = settings.data / "high_level"
    begun = cached.exists()
    folder = cached if begun else settings.high_level or bundled("high_level")
    start = HighLevel.load(folder, settings.rollout.head)
    start.check_memory(settings.rollout.looks, settings.rollout.history)
    if not begun:
        start.version = NEVER_ANNOUNCED
    return start


def make_thinking(settings: ActorSettings) -> Thinking:
    """Beside the loop in real time, counted in steps in lockstep."""
    if settings.pace is Pace.REAL_TIME:
        return Beside()
    return Lockstep(settings.rollout.latency_steps)
