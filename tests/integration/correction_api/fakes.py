"""A robot and a learner that speak on a bus as the real ones do, and remember what they heard."""

import threading
import time
from typing import Any

import numpy as np
import simplejpeg

from shared.messages.correction import AFTERWARDS, Correction, Kind
from shared.messages.decision import Decision, Proposal
from shared.messages.episode import Episode, Outcome
from shared.messages.frame import Channel, Frame, Rate
from shared.messages.goal import LanguageGoal
from shared.messages.heartbeat import LearnerHeartbeat, LearnerState, RobotHeartbeat, RobotState
from shared.messages.help import Help, Reason
from shared.messages.learned import LearnedAnswer, LearnedQuestion
from shared.messages.observation import CAMERAS
from shared.messages.phrase import Near, PhraseAnswer, PhraseQuestion
from shared.messages.policy import PolicyAnnouncement, TensorRef, Version
from shared.messages.receipt import Receipt
from shared.wire.bus import Bus, Urgency
from shared.wire.codec import decode, encode
from shared.wire.keys import any_service, robot_key, service_key

FLEET = "lab"
COMMANDS = (
    "pick up the cheese",
    "pick up the tomato",
    "put it on the plate",
    "pick up the bread",
    "wait",
)
BEAT_S = 0.1


class FakeRobot:
    """Obeys on its own bus thread; its steps go on with the heartbeats.

    heard: every correction that arrived, also repeated ones. receipts: what was answered, by id.
    reason: why it refuses whatever it is told; empty: it obeys.
    pictures: what it says of their rate.
    answering: cleared, it hears and answers nothing until it is set again.
    A phrase with "dance" would be refused, any other would be taken for the first command.
    """

    def __init__(self, bus: Bus, name: str = "robot-1", *, supervised: bool = False) -> None:
        self.bus, self.name, self.supervised = bus, name, supervised
        self.episode: str | None = f"{name}-e1"  # None: between two.
        self.step, self.index = 0, 0
        self.command, self.chosen_by = COMMANDS[0], "1.0"
        self.version = Version(1, 0)
        self.state = RobotState.ACTING
        self.help: Help | None = None
        self.pictures = 1.0
        self.heard: list[Correction] = []
        self.receipts: dict[str, Receipt] = {}
        self.deaf, self.reason = False, ""
        self.answering = threading.Event()
        self.answering.set()
        self.low_level_sha256 = "5d" * 32
        self._serving = [
            bus.serve(robot_key(FLEET, name, "correction"), self._obey),
            bus.serve(robot_key(FLEET, name, "phrase"), self._read),
        ]
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self.answering.set()
        self._thread.join()
        for serving in self._serving:
            serving.close()

    def kinds(self) -> list[Kind]:
        """Of what it heard."""
        return [one.kind for one in self.heard]

    def decide(self, *, truth: dict[str, Any] | None = None) -> Decision:
        """Publish a decision that keeps the command in force."""
        scores = np.linspace(0.4, 0.05, len(COMMANDS))
        decision = Decision(
            id=f"{self.episode}-{self.index}",
            robot=self.name,
            episode=self.episode,
            index=self.index,
            step=self.step,
            time_ns=time.time_ns(),
            task="sandwich",
            prompt="make a sandwich with cheese and tomato",
            previous=(COMMANDS[3],),
            proposed=tuple(
                Proposal(goal=LanguageGoal(text=text), score=float(score))
                for text, score in zip(COMMANDS, scores, strict=True)
            ),
            executed=LanguageGoal(text=self.command),
            chosen_by=self.chosen_by,
            version=self.version,
            awaits_verdict=self.supervised,
            help=self.help,
            truth=truth or {},
            arrays={
                "images": np.zeros((2, 64, 64, 3), np.uint8),
                "proprioception": np.zeros(22, np.float32),
                "objects": np.zeros((9, 9), np.float32),
            },
        )
        self.index += 1
        self.repeat(decision)
        return decision

    def ask(self, doubt: float = 0.6, waits_s: float = 0.0) -> Decision:
        """Publish a decision at which it begins to ask for help."""
        self.help = Help(
            decision=f"{self.episode}-{self.index}",
            step=self.step,
            time_ns=time.time_ns(),
            reason=Reason.ENTROPY,
            doubt=doubt,
            waits_s=waits_s,
        )
        self.state = RobotState.ASKING if waits_s else self.state
        return self.decide()

    def repeat(self, decision: Decision) -> None:
        """Publish a decision (again)."""
        self.bus.put(robot_key(FLEET, self.name, "decision"), encode(decision))

    def end(self, outcome: Outcome = Outcome.SUCCESS, corrections: int = 2) -> Episode:
        """End the episode, and begin the next one."""
        number = int(self.episode.rpartition("e")[2])
        episode = Episode(
            id=self.episode,
            robot=self.name,
            number=number,
            task="sandwich",
            prompt="make a sandwich with cheese and tomato",
            site="far",
            seed=1_000_000_000 + number,
            version=self.version,
            low_level_sha256="5d" * 32,
            outcome=outcome,
            steps=self.step,
            decisions=self.index,
            corrections=corrections,
            started_ns=time.time_ns() - 10**9,
            ended_ns=time.time_ns(),
        )
        self.episode, self.step, self.index = f"{self.name}-e{number + 1}", 0, 0
        self.help = None
        self.bus.put(robot_key(FLEET, self.name, "episode"), encode(episode))
        self.beat()
        return episode

    def beat(self) -> None:
        """Give a sign of life, and in an episode a picture for each camera that is watched."""
        episode = self.episode  # Once: a test may end it in the middle of this.
        heartbeat = RobotHeartbeat(
            robot=self.name,
            actor="actor-1",
            time_ns=time.time_ns(),
            state=self.state,
            task="sandwich",
            prompt="make a sandwich with cheese and tomato",
            site="far",
            episode=episode,
            number=1,
            step=self.step,
            command=LanguageGoal(text=self.command),
            chosen_by=self.chosen_by,
            version=self.version,
            supervised=self.supervised,
            help=self.help,
            pictures=self.pictures,
        )
        self.bus.put(robot_key(FLEET, self.name, "heartbeat"), encode(heartbeat))
        if episode is None:
            return
        for camera in CAMERAS:
            for rate in Rate:
                if self.bus.watched(robot_key(FLEET, self.name, Channel(camera, rate).message)):
                    self.show(camera, rate=rate, episode=episode)

    def show(
        self,
        camera: str,
        size: tuple[int, int] = (48, 64),
        rate: Rate = Rate.FULL,
        episode: str | None = None,
    ) -> None:
        """Publish a picture. episode: None: the current one."""
        noise = np.random.default_rng(self.step).integers(0, 255, (*size, 3), np.uint8)
        frame = Frame(
            robot=self.name,
            episode=episode or self.episode,
            step=self.step,
            camera=camera,
            sequence=self.step,
            time_ns=time.time_ns(),
            arrays={"jpeg": np.frombuffer(simplejpeg.encode_jpeg(noise), np.uint8)},
        )
        key = robot_key(FLEET, self.name, Channel(camera, rate).message)
        self.bus.put(key, encode(frame), Urgency.BACKGROUND, droppable=True)

    def _live(self) -> None:
        while not self._ended.wait(BEAT_S):
            if not self.deaf:
                self.step += 5
                self.beat()

    def _obey(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        correction = decode(Correction, payload)
        self.answering.wait()
        self.heard.append(correction)
        if correction.id not in self.receipts:
            self.receipts[correction.id] = self._judge(correction)
        return encode(self.receipts[correction.id])

    def _read(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        text = decode(PhraseQuestion, payload).text
        if text is None:
            told = PhraseAnswer(robot=self.name, step=self.step, commands=COMMANDS)
            return encode(told.model_copy(update={"low_level_sha256": self.low_level_sha256}))
        refused = f"the low level doesn't understand {text!r}" if "dance" in text else ""
        answer = PhraseAnswer(
            robot=self.name,
            step=self.step,
            text=text,
            means=None if refused else COMMANDS[0],
            refused=refused,
            known=text in COMMANDS,
            low_level_sha256=self.low_level_sha256,
            nearest=(Near(command=COMMANDS[0], score=0.5), Near(command=COMMANDS[4], score=0.25)),
        )
        return encode(answer)

    def _judge(self, correction: Correction) -> Receipt:
        never_late = AFTERWARDS | {Kind.PAUSE}
        stale = correction.episode != self.episode and correction.kind not in never_late
        replaced = None
        if correction.target == self.chosen_by:
            replaced = correction.target
            if correction.kind is Kind.EDIT and correction.goal:
                self.command = correction.goal.text
        if not stale and correction.kind in (Kind.OVERRIDE, Kind.RELEASE):
            replaced = self.chosen_by if self.chosen_by in self.receipts else None
        if not stale and correction.kind is Kind.OVERRIDE and correction.goal:
            self.command, self.chosen_by = correction.goal.text, correction.id
        if not stale and correction.kind is Kind.RELEASE:
            self.command, self.chosen_by = COMMANDS[0], "1.0"
        over = f"episode {correction.episode} is over; the current one is {self.episode}"
        if not stale and correction.kind in (Kind.PAUSE, Kind.RESUME):
            paused = correction.kind is Kind.PAUSE
            self.state = RobotState.PAUSED if paused else RobotState.ACTING
        if correction.kind is Kind.RETRACT and replaced:
            self.command, self.chosen_by = COMMANDS[0], "1.0"
        reason = over if stale else self.reason
        if not reason and correction.kind.answers:
            self.help, self.state = None, RobotState.ACTING
        return Receipt(
            correction=correction.id,
            robot=self.name,
            episode=correction.episode,
            accepted=not reason,
            step=None if reason else self.step,
            replaced=replaced,
            reason=reason,
            time_ns=time.time_ns(),
        )


class FakeLearner:
    """Takes corrections and receipts, and tells what it learned.

    taken: (message, correction id), as they came. learned: versions by correction.
    asked: how many corrections it was asked about, question by question.
    """

    def __init__(self, bus: Bus) -> None:
        self.bus = bus
        self.taken: list[tuple[str, str]] = []
        self.learned: dict[str, Version] = {}
        self.held_out: set[str] = set()
        self.asked: list[int] = []
        self._serving = [
            bus.serve(any_service(FLEET, "correction-api", "correction"), self._correction),
            bus.serve(any_service(FLEET, "correction-api", "receipt"), self._receipt),
            bus.serve(service_key(FLEET, "learner", "learner-1", "learned"), self._tell),
        ]

    def close(self) -> None:
        for serving in self._serving:
            serving.close()

    def beat(self, state: LearnerState = LearnerState.COLLECTING) -> None:
        """Give a sign of life."""
        heartbeat = LearnerHeartbeat(
            learner="learner-1",
            time_ns=time.time_ns(),
            state=state,
            version=Version(1, 0),
            round=0,
            corrections=3,
        )
        key = service_key(FLEET, "learner", "learner-1", "heartbeat")
        self.bus.put(key, encode(heartbeat))

    def announce(self, version: str = "1.0", bank: tuple[str, ...] = COMMANDS) -> None:
        """Announce a policy that chooses from a bank."""
        tensor = TensorRef(name="w", sha256="0" * 64, dtype="float32", shape=(1,), size_bytes=4)
        announcement = PolicyAnnouncement(
            version=Version.parse(version),
            learner="learner-1",
            created_ns=time.time_ns(),
            tensors=(tensor,),
            bank=bank,
            low_level_sha256="5d" * 32,
        )
        key = service_key(FLEET, "learner", "learner-1", "policy")
        self.bus.latest(key, encode(announcement))

    def _tell(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        asked = decode(LearnedQuestion, payload).corrections
        self.asked.append(len(asked))
        learned = {name: self.learned[name] for name in asked if name in self.learned}
        aside = tuple(name for name in asked if name in self.held_out)
        return encode(LearnedAnswer(learned=learned, held_out=aside))

    def _correction(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        self.taken.append(("correction", decode(Correction, payload).id))
        return b"ok"

    def _receipt(self, key: str, payload: bytes) -> bytes:
        del key  # Unused.
        self.taken.append(("receipt", decode(Receipt, payload).correction))
        return b"ok"
