"""The composition root of the actor: the only file here that names concrete classes."""

import threading
from contextlib import ExitStack
from importlib.metadata import entry_points

import torch

from services.actor.act import Runner
from services.actor.config import ActorSettings, Pace
from services.actor.logbook import Logbook
from services.actor.obey import Inbox
from services.actor.observe import Observer
from services.actor.record import Recorder
from services.actor.refresh import Refresh
from shared.clock import SystemClock
from shared.errors import ConfigError, nearest
from shared.messages.policy import Version
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout.robot import Robot
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
            observer=Observer(bus, fleet, name, self.clock, settings.frames),
            inbox=Inbox(bus, fleet, name, self.wake),
            logbook=Logbook(settings.data / f"{name}.json"),
            clock=self.clock,
        )

    def close(self) -> None:
        """Deliver no more, and leave the bus; what was not delivered stays on disk."""
        self._closing.close()


def newest_on_disk(settings: ActorSettings) -> HighLevel:
    """The version that was taken up last, or the checkpoint to begin with."""
    cached = settings.data / "high_level"
    if cached.exists():
        return HighLevel.load(cached, settings.rollout.head)
    start = HighLevel.load(settings.high_level or bundled("high_level"), settings.rollout.head)
    start.version = NEVER_ANNOUNCED
    return start


def make_thinking(settings: ActorSettings) -> Thinking:
    """Beside the loop in real time, counted in steps in lockstep."""
    if settings.pace is Pace.REAL_TIME:
        return Beside()
    return Lockstep(settings.rollout.latency_steps)


def make_robot(kind: str, site: str, skills: int | None = None) -> Robot:
    """A robot of the kind that some installed package offers.

    Raises:
        ConfigError: no package offers such a kind; the message names those that are there.
    """
    offered = {entry.name: entry for entry in entry_points(group="hl_dagger.robots")}
    if kind not in offered:
        raise ConfigError(f"no robot of kind {kind!r}{nearest(kind, offered)}")
    made = offered[kind].load()
    robot: Robot = made(site) if skills is None else made(site, skills)
    return robot
