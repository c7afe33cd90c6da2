"""Act: one robot, episode after episode. `tick` is one turn of its control loop."""

import structlog

from services.actor.ask import Asker
from services.actor.config import ActorSettings, Pace, Refresh
from services.actor.logbook import Logbook
from services.actor.obey import Inbox
from services.actor.observe import Observer
from services.actor.record import Recorder
from services.actor.understand import Listener, Moment
from shared.clock import Clock
from shared.messages.correction import AFTERWARDS, Correction, Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode, Outcome
from shared.messages.heartbeat import RobotHeartbeat, RobotState
from shared.messages.message import new_id
from shared.messages.receipt import Receipt
from shared.rollout.answering import answer
from shared.rollout.robot import LowLevel, PolicySource, Robot
from shared.rollout.rollout import Rollout
from shared.rollout.thinking import Thinking
from shared.seeds import collection_seed

REPEAT_NS = 500_000_000
log = structlog.get_logger()


class Runner:
    """Everything that belongs to one robot of this actor."""

    def __init__(
        self,
        name: str,
        index: int,
        *,
        settings: ActorSettings,
        robot: Robot,
        low_level: LowLevel,
        source: PolicySource,
        thinking: Thinking,
        recorder: Recorder,
        observer: Observer,
        inbox: Inbox,
        listener: Listener,
        logbook: Logbook,
        clock: Clock,
    ) -> None:
        self.name, self._index, self._settings, self._clock = name, index, settings, clock
        self._robot, self._low_level, self._source = robot, low_level, source
        self._thinking, self._recorder, self._observer = thinking, recorder, observer
        self._inbox, self._listener, self._logbook = inbox, listener, logbook
        self._asker = Asker(name, settings.help, logbook, clock)
        self._rollout: Rollout | None = None
        self._halted = False  # Told to stand still between two episodes: the next begins so.
        self._started_ns = self._seed = 0
        self._resting_until = self._waiting_since = 0
        self._repeat_due = self._verdict_due = 0
        self._tell_broken_off()

    def tick(self) -> bool:
        """One turn: obey, move by one control step, tell. True when the robot moved."""
        if self._rollout is None and self._may_begin():
            self._begin()
        moved = False
        self._inbox.obey(self._correct)
        self._listener.offer(self._moment)
        if self._rollout is not None:
            moved = self._rollout.advance()
            self._mind_waiting(self._rollout)
            self._observer.show(self._robot, self._rollout)
        if self._asker.news() or self._observer.heartbeat_due():
            self._beat()
        if self._rollout is not None and self._rollout.over:
            self._end(Outcome.SUCCESS if self._rollout.done else Outcome.TIMEOUT)
        return moved

    def close(self) -> None:
        """Break off the episode and give the robot back."""
        if self._rollout is not None:
            self._end(Outcome.ABORTED)
        self._inbox.close()
        self._listener.close()
        self._observer.close()
        self._thinking.close()
        self._robot.close()

    # -- episodes

    def _may_begin(self) -> bool:
        quota = self._settings.episodes_per_version
        version = str(self._source.newest.version)
        now = self._clock.monotonic_ns()
        if not (quota and self._logbook.version == version and self._logbook.finished >= quota):
            self._waiting_since = 0
            return now >= self._resting_until
        self._waiting_since = self._waiting_since or now
        patience_s = self._settings.wait_for_version_s
        if patience_s and now - self._waiting_since > patience_s * 1e9:
            log.warning("no newer version came, going on", robot=self.name, version=version)
            self._logbook.renew()
        return False

    def _begin(self) -> None:
        high_level = self._source.newest
        number = self._logbook.number
        self._logbook.begin(str(high_level.version))
        self._seed = collection_seed(self._index, number, self._settings.seed)
        task = self._settings.tasks[(number + self._index) % len(self._settings.tasks)]
        scene = self._robot.reset(self._seed, task, None)
        self._started_ns = self._clock.now_ns()
        self._asker.begin()
        self._rollout = Rollout(
            self._robot,
            high_level,
            self._low_level,
            self._thinking,
            self._clock,
            self._settings.hierarchy,
            name=self.name,
            episode=new_id("ep"),
            scene=scene,
            decided=self._decided,
        )
        self._rollout.paused, self._halted = self._halted, False
        self._beat()

    def _end(self, outcome: Outcome) -> None:
        assert self._rollout is not None
        episode = self._episode(self._rollout, outcome, self._low_level.fingerprint())
        self._rollout = None
        self._asker.begin()
        if self._settings.pace is Pace.REAL_TIME:
            self._resting_until = self._clock.monotonic_ns() + int(self._settings.rest_s * 1e9)
        self._recorder.ended(episode)
        self._logbook.close(finished=outcome is not Outcome.ABORTED)

    def _tell_broken_off(self) -> None:
        """The episode in which this robot's actor died, if it did."""
        if self._logbook.draft is not None:
            self._recorder.ended(self._logbook.draft)
            self._logbook.close(finished=False)

    def _draft(self, rollout: Rollout) -> Episode:
        """The episode at work, as it would be told if this actor died now."""
        return self._episode(rollout, Outcome.ABORTED, self._low_level.sha256)

    def _episode(self, rollout: Rollout, outcome: Outcome, low_level_sha256: str) -> Episode:
        return Episode(
            id=rollout.episode,
            robot=self.name,
            number=self._logbook.number - 1,
            task=rollout.scene.task,
            prompt=rollout.scene.prompt,
            site=rollout.scene.site,
            seed=self._seed,
            version=rollout.version,
            low_level_sha256=low_level_sha256,
            outcome=outcome,
            steps=rollout.step,
            decisions=rollout.decisions,
            corrections=rollout.corrections,
            asked=dict(rollout.asked),
            started_ns=self._started_ns,
            ended_ns=self._clock.now_ns(),
        )

    # -- decisions and people

    def _decided(self, decision: Decision) -> None:
        assert self._rollout is not None  # It has just decided.
        decision = self._asker.look(self._rollout, decision, lambda: self._achieved(decision))
        self._recorder.decided(decision)
        self._logbook.note(self._draft(self._rollout))
        now = self._clock.monotonic_ns()
        self._repeat_due = now + REPEAT_NS
        self._verdict_due = now + int(self._settings.verdict_timeout_s * 1e9)
        if self._settings.refresh is Refresh.DECISION:
            self._rollout.take_up(self._source.newest)

    def _achieved(self, decision: Decision) -> bool:
        """Whether what is in force is done, says the low level's classifier."""
        completion = self._low_level.completion(*self._robot.sense(), decision.executed)
        return completion >= self._settings.rollout.completion_threshold

    def _correct(self, correction: Correction) -> Receipt:
        if self._rollout is not None:
            receipt = self._rollout.correct(correction)
            self._asker.hear(self._rollout, correction, receipt)
            self._logbook.note(self._draft(self._rollout))
            return receipt
        now_ns = self._clock.now_ns()
        if correction.kind in AFTERWARDS:  # Never too late, and nothing to do here.
            return answer(correction, self.name, 0, now_ns)
        if correction.kind is Kind.PAUSE:
            self._halted = True
            return answer(correction, self.name, 0, now_ns)
        why = f"episode {correction.episode} is over and the next one has not begun"
        return answer(correction, self.name, None, now_ns, why=why)

    def _moment(self) -> Moment | None:
        """What the robot senses now; None between two episodes."""
        return Moment(self._robot.sense(), self._rollout.step) if self._rollout else None

    def _mind_waiting(self, rollout: Rollout) -> None:
        """While a decision awaits a word: show it again, and in the end go on without."""
        self._asker.mind(rollout)
        if rollout.awaited is None:
            return
        now = self._clock.monotonic_ns()
        if now >= self._repeat_due:
            self._repeat_due = now + REPEAT_NS
            self._recorder.repeat(rollout.awaited)
        limited = rollout.awaited.awaits_verdict and self._settings.verdict_timeout_s
        if limited and now >= self._verdict_due:
            log.warning("no verdict came, going on", robot=self.name, decision=rollout.awaited.id)
            rollout.awaited = None

    def _beat(self) -> None:
        rollout, settings = self._rollout, self._settings
        episode = {}
        if rollout is not None:
            episode = {
                "task": rollout.scene.task,
                "prompt": rollout.scene.prompt,
                "site": rollout.scene.site,
                "episode": rollout.episode,
                "step": rollout.step,
                "command": rollout.command,
                "chosen_by": rollout.chosen_by,
            }
        self._observer.beat(
            RobotHeartbeat(
                robot=self.name,
                actor=settings.id,
                time_ns=self._clock.now_ns(),
                state=self._state(),
                number=max(0, self._logbook.number - 1),
                version=rollout.version if rollout else self._source.newest.version,
                supervised=settings.rollout.supervised,
                real_time=settings.pace is Pace.REAL_TIME,
                pending=self._recorder.pending,
                help=self._asker.call,
                pictures=self._observer.share,
                **episode,
            )
        )

    def _state(self) -> RobotState:
        if self._rollout is None:
            return RobotState.PAUSED if self._halted else RobotState.IDLE
        if self._rollout.paused:
            return RobotState.PAUSED
        if self._asker.waiting:
            return RobotState.ASKING
        return RobotState.AWAITING if self._rollout.awaited else RobotState.ACTING
