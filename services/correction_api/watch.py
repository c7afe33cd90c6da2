"""Watch: the newest state of robots and learner, as the bus tells it; newest wins.

Bus threads write, everybody else reads; one lock, held for moments only.
"""

import threading
from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from services.correction_api.views import Presence
from shared.clock import Clock
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.heartbeat import LearnerHeartbeat, RobotHeartbeat
from shared.messages.policy import PolicyAnnouncement
from shared.messages.receipt import Receipt

Changed = Callable[[str, str], None]
REMEMBERED = 64  # decisions, commands and episodes of a robot


class Force(NamedTuple):
    """A command in force, chosen by a version or a correction, as of the actor's time.

    episode, step: where it was first heard of.
    """

    text: str
    chosen_by: str
    time_ns: int
    episode: str | None = None
    step: int = 0

    def same(self, other: "Force") -> bool:
        """It is the same choice, heard of again."""
        return self[:2] == other[:2] and self.episode == other.episode


@dataclass
class Robot:
    """What is known of one robot.

    heard_ns: when its last heartbeat came, by the monotonic clock here.
    decisions: heads of the last ones by id, the newest last. over: episodes that have ended.
    course: the commands of the episode so far, each from when it came in force.
    """

    heartbeat: RobotHeartbeat
    heard_ns: int
    force: Force | None = None
    decisions: OrderedDict[str, Decision] = field(default_factory=OrderedDict)
    over: OrderedDict[str, None] = field(default_factory=OrderedDict)
    course: deque[Force] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    @property
    def decision(self) -> Decision | None:
        """The newest decision."""
        return next(reversed(self.decisions.values()), None)

    @property
    def episode(self) -> str | None:
        """The current episode, by decision or heartbeat, whichever is newer; None between two."""
        newest = self.decision
        if newest and newest.time_ns > self.heartbeat.time_ns and newest.episode not in self.over:
            return newest.episode
        return self.heartbeat.episode if self.heartbeat.episode not in self.over else None

    def choose(self, force: Force) -> None:
        """A command came in force; what is older than what is known does not count."""
        if self.force and force.time_ns < self.force.time_ns:
            return
        if self.course and self.course[-1].episode != force.episode:
            self.course.clear()
        if not (self.course and self.course[-1].same(force)):
            self.course.append(force)
        self.force = force


class Sight(NamedTuple):
    """A robot as it was at one look."""

    heartbeat: RobotHeartbeat
    force: Force | None
    decision: Decision | None
    episode: str | None
    heard_ns: int
    course: tuple[Force, ...]


class Watch:
    """The board that bus threads write on."""

    def __init__(self, clock: Clock, stale_s: float, offline_s: float) -> None:
        self._clock = clock
        self._changed: Changed = _unheard
        self._stale_ns, self._offline_ns = int(stale_s * 1e9), int(offline_s * 1e9)
        self._lock = threading.Lock()
        self._robots: dict[str, Robot] = {}
        self._early: dict[str, Decision] = {}  # Decisions of robots without a heartbeat yet.
        self._learner: LearnerHeartbeat | None = None
        self._learner_heard_ns = 0
        self._policy: PolicyAnnouncement | None = None

    def on_change(self, changed: Changed) -> None:
        """Have `changed(kind, name)` called after each change, in the thread that made it.

        kind: robot, decision, episode or learner; name: whose (a robot's id, or the learner's).
        """
        self._changed = changed

    # -- what bus threads tell

    def robot(self, heartbeat: RobotHeartbeat) -> None:
        """A robot gave a sign of life."""
        with self._lock:
            robot = self._robots.get(heartbeat.robot)
            if robot is None:
                robot = self._robots[heartbeat.robot] = Robot(heartbeat, 0)
                if early := self._early.pop(heartbeat.robot, None):
                    _remember(robot.decisions, early.id, early)
            before = robot.heartbeat.episode
            if before is not None and before != heartbeat.episode:
                _remember(robot.over, before, None)
            robot.heartbeat, robot.heard_ns = heartbeat, self._clock.monotonic_ns()
            if heartbeat.command:
                text = heartbeat.command.text
                place = heartbeat.episode, heartbeat.step
                robot.choose(Force(text, heartbeat.chosen_by, heartbeat.time_ns, *place))
        self._changed("robot", heartbeat.robot)

    def decision(self, decision: Decision) -> None:
        """A robot decided; the same one again, as a waiting robot repeats it, is no news."""
        head = decision.model_copy(update={"arrays": {}})
        with self._lock:
            robot = self._robots.get(decision.robot)
            if robot is None:
                self._early[decision.robot] = head
                return
            if decision.id in robot.decisions:
                return
            _remember(robot.decisions, decision.id, head)
            place = decision.episode, decision.step
            text, chosen_by = decision.executed.text, decision.chosen_by
            robot.choose(Force(text, chosen_by, decision.time_ns, *place))
        self._changed("decision", decision.robot)

    def episode(self, episode: Episode) -> None:
        """An episode is over."""
        with self._lock:
            if robot := self._robots.get(episode.robot):
                _remember(robot.over, episode.id, None)
        self._changed("episode", episode.robot)

    def obeyed(self, correction: Correction, receipt: Receipt) -> None:
        """An override took force, or other words: sooner known than by the next heartbeat."""
        if not (receipt.accepted and correction.goal):
            return
        if correction.kind is Kind.OVERRIDE:
            chosen_by = correction.id
        elif correction.kind is Kind.EDIT and receipt.replaced == correction.target:
            chosen_by = receipt.replaced or ""
        else:
            return
        with self._lock:
            robot = self._robots.get(correction.robot)
            if robot is None or robot.heartbeat.episode != correction.episode:
                return
            place = correction.episode, receipt.step or 0
            robot.choose(Force(correction.goal.text, chosen_by, receipt.time_ns, *place))
        self._changed("robot", correction.robot)

    def learner(self, heartbeat: LearnerHeartbeat) -> None:
        """A learner gave a sign of life; one of an older epoch is no longer obeyed."""
        with self._lock:
            known = self._learner
            if known and known.learner != heartbeat.learner and known.version > heartbeat.version:
                return
            self._learner, self._learner_heard_ns = heartbeat, self._clock.monotonic_ns()
        self._changed("learner", heartbeat.learner)

    def policy(self, announcement: PolicyAnnouncement) -> None:
        """A version was announced; it never goes back."""
        with self._lock:
            if self._policy and self._policy.version >= announcement.version:
                return
            self._policy = announcement
        self._changed("learner", announcement.learner)

    # -- what everybody reads

    def names(self) -> list[str]:
        """The robots that ever gave a sign of life."""
        with self._lock:
            return sorted(self._robots)

    def look(self, name: str) -> Sight:
        """What is known of a robot now.

        Raises:
            KeyError: no robot has this name.
        """
        with self._lock:
            robot = self._robots[name]
            sight = Sight(
                robot.heartbeat,
                robot.force,
                robot.decision,
                robot.episode,
                robot.heard_ns,
                tuple(robot.course),
            )
        return sight

    def decided(self, name: str, decision: str) -> Decision | None:
        """A decision of a known robot by its id, if it is one of the last."""
        with self._lock:
            return self._robots[name].decisions.get(decision)

    def last_of(self, name: str, episode: str) -> Decision | None:
        """The last decision that was heard of an episode of a known robot, if not long ago."""
        with self._lock:
            known = self._robots[name].decisions.values()
            made = (decision for decision in known if decision.episode == episode)
            return max(made, key=lambda decision: decision.index, default=None)

    def ended(self, name: str, episode: str) -> bool:
        """An episode of a known robot was seen to end not long ago."""
        with self._lock:
            return episode in self._robots[name].over

    def latest_episode(self, name: str) -> str | None:
        """The episode that a known robot works at, or else the one before; None: none is known."""
        with self._lock:
            robot = self._robots[name]
            return robot.episode or next(reversed(robot.over), None)

    def newest(self, name: str) -> Decision | None:
        """The newest decision of a robot, without its arrays.

        Raises:
            KeyError: no robot has this name.
        """
        with self._lock:
            return self._robots[name].decision

    @property
    def announcement(self) -> PolicyAnnouncement | None:
        """The newest policy version that was announced."""
        with self._lock:
            return self._policy

    def learner_now(self) -> tuple[LearnerHeartbeat | None, Presence, float]:
        """The learner's last heartbeat, how fresh it is, and its age in seconds."""
        with self._lock:
            heartbeat, heard_ns = self._learner, self._learner_heard_ns
        if heartbeat is None:
            return None, Presence.UNSEEN, 0.0
        presence, age_s = self.presence(heard_ns)
        return heartbeat, presence, age_s

    def presence(self, heard_ns: int) -> tuple[Presence, float]:
        """How fresh a sign of life is that was heard at `heard_ns`, and its age in seconds."""
        age_ns = self._clock.monotonic_ns() - heard_ns
        if age_ns < self._stale_ns:
            return Presence.ONLINE, age_ns / 1e9
        if age_ns < self._offline_ns:
            return Presence.STALE, age_ns / 1e9
        return Presence.OFFLINE, age_ns / 1e9


def _remember(known: "OrderedDict[str, Any]", name: str, value: Any) -> None:
    known[name] = value
    known.move_to_end(name)
    while len(known) > REMEMBERED:
        known.popitem(last=False)


def _unheard(kind: str, name: str) -> None:
    del kind, name  # Nobody listens before `on_change`.
