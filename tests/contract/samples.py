"""One message of each kind, with every field set; `python -m tests.contract.samples` writes the
golden bytes of those that have none yet.

When a message changes, its sample is changed and gets the next number in `NUMBERS`; the files of
the numbers before stay, since there are stores and logs that hold such bytes.
"""

from pathlib import Path

import numpy as np

from shared.messages.correction import Correction, Kind
from shared.messages.decision import Asked, Choice, Decision, Proposal
from shared.messages.episode import Episode, Outcome
from shared.messages.frame import Frame
from shared.messages.goal import LanguageGoal
from shared.messages.heartbeat import LearnerHeartbeat, LearnerState, RobotHeartbeat, RobotState
from shared.messages.help import Help, Reason
from shared.messages.learned import LearnedAnswer, LearnedQuestion
from shared.messages.lineage import (
    Compared,
    Lineage,
    RoundTold,
    RulingTold,
    Share,
    VersionTold,
)
from shared.messages.message import Message
from shared.messages.observation import Observation
from shared.messages.phrase import Near, PhraseAnswer, PhraseQuestion
from shared.messages.policy import PolicyAnnouncement, TensorRef, Version
from shared.messages.receipt import Receipt
from shared.messages.recording import Recorded, Recording, RecordingQuery, Still, StillQuery
from shared.messages.ruling import Ruling, Verb
from shared.messages.trial import TrialOrder, TrialReport, TrialResult
from shared.wire.codec import encode

GOLDEN = Path(__file__).parent / "golden"

NUMBERS: dict[type[Message], int] = {
    Correction: 3,
    Decision: 3,
    Episode: 2,
    Frame: 1,
    LearnedAnswer: 1,
    LearnedQuestion: 1,
    LearnerHeartbeat: 1,
    Lineage: 2,
    Observation: 1,
    PhraseAnswer: 2,
    PhraseQuestion: 2,
    PolicyAnnouncement: 2,
    Receipt: 1,
    Recording: 1,
    RecordingQuery: 1,
    RobotHeartbeat: 3,
    Ruling: 1,
    Still: 1,
    StillQuery: 1,
    TrialOrder: 1,
    TrialReport: 1,
}

UNFIT: dict[type[Message], set[str]] = {
    Correction: {"goal", "decision", "hold_steps"},
    Ruling: {"round", "version"},
}
"""Fields that can't be set together with those that are."""

CHEESE = LanguageGoal(text="pick up the cheese")
HAM = LanguageGoal(text="pick up the ham")
TIME_NS = 1_795_000_000_123_456_789
HELP = Help(
    decision="dec-1", step=150, time_ns=TIME_NS, reason=Reason.MARGIN, doubt=0.75, waits_s=12.5
)


def arrays() -> dict[str, np.ndarray]:
    """What a policy sees, small and the same each time."""
    images = np.arange(2 * 64 * 64 * 3, dtype=np.uint32).astype(np.uint8)
    return {
        "images": images.reshape(2, 64, 64, 3),
        "proprioception": np.linspace(-1, 1, 22, dtype=np.float32),
        "objects": np.linspace(0, 2, 81, dtype=np.float32).reshape(9, 9),
    }


def samples() -> dict[type[Message], Message]:
    """The message of each class."""
    made: tuple[Message, ...] = (
        correction(), decision(), episode(), frame(), learner(), observation(), policy(),
        receipt(), robot(), ruling(), order(), report(), phrase_question(), phrase_answer(),
        learned_question(), learned_answer(), recording(), still(), lineage(),
        RecordingQuery(episode="ep-1", first=3, limit=50),
        StillQuery(decision="dec-1", camera="top"),
    )  # fmt: skip
    return {type(message): message for message in made}


def observation() -> Observation:
    return Observation(step=7, prompt="a cheese sandwich", previous=("wait",), arrays=arrays())


def decision() -> Decision:
    return Decision(
        id="dec-1",
        robot="robot-1",
        episode="ep-1",
        index=3,
        step=150,
        time_ns=TIME_NS,
        asked=Asked.COMPLETION,
        task="sandwich",
        prompt="a cheese sandwich, please – schön dick",
        previous=("pick up the bread", "put it on the plate"),
        past=(0, 1, 2),
        proposed=(Proposal(goal=HAM, score=0.75), Proposal(goal=CHEESE, score=0.25)),
        executed=HAM,
        chosen_by="1.2",
        choice=Choice.BEST,
        version=Version(1, 2),
        awaits_verdict=True,
        help=HELP,
        truth={"held": [None, "ham"], "position_m": [0.5, -0.25, 1e-3], "steps": 4},
        arrays=arrays(),
    )


def correction() -> Correction:
    return Correction(
        id="cor-1",
        robot="robot-1",
        episode="ep-1",
        kind=Kind.RETIME,
        author="anna",
        target="cor-0",
        first_step=140,
        end_step=240,
        seen_step=150,
        delay_steps=5,
        begun_ns=TIME_NS,
        created_ns=TIME_NS + 1,
        heard="no the cheese first",
        note="the cheese first",
    )


def receipt() -> Receipt:
    return Receipt(
        correction="cor-1",
        robot="robot-1",
        episode="ep-1",
        accepted=True,
        step=151,
        replaced="cor-0",
        time_ns=TIME_NS,
    )


def episode() -> Episode:
    return Episode(
        id="ep-1",
        robot="robot-1",
        number=12,
        task="sandwich",
        prompt="a cheese sandwich",
        site="kitchen",
        seed=1_000_000_012,
        version=Version(1, 2),
        low_level_sha256="ab" * 32,
        outcome=Outcome.SUCCESS,
        steps=800,
        decisions=16,
        corrections=2,
        asked={Asked.START: 1, Asked.INTERVAL: 13, Asked.INTERJECTION: 2},
        started_ns=TIME_NS,
        ended_ns=TIME_NS + 16_000_000_000,
    )


def frame() -> Frame:
    return Frame(
        robot="robot-1",
        episode="ep-1",
        step=150,
        camera="top",
        sequence=9,
        time_ns=TIME_NS,
        arrays={"jpeg": np.frombuffer(b"\xff\xd8 a picture \xff\xd9", np.uint8)},
    )


def robot() -> RobotHeartbeat:
    return RobotHeartbeat(
        robot="robot-1",
        actor="actor-1",
        time_ns=TIME_NS,
        state=RobotState.ASKING,
        task="sandwich",
        prompt="a cheese sandwich",
        site="kitchen",
        episode="ep-1",
        number=12,
        step=150,
        command=HAM,
        chosen_by="1.2",
        version=Version(1, 2),
        supervised=True,
        real_time=False,
        pending=3,
        help=HELP,
        pictures=0.25,
    )


def learner() -> LearnerHeartbeat:
    return LearnerHeartbeat(
        learner="learner-1",
        time_ns=TIME_NS,
        state=LearnerState.TRAINING,
        version=Version(1, 2),
        round=3,
        episodes=40,
        successes=25,
        corrections=171,
        decisions=640,
        reason="none",
        progress=0.5,
    )


def policy() -> PolicyAnnouncement:
    ref = TensorRef(
        name="head.weight", sha256="cd" * 32, dtype="float32", shape=(384, 256), size_bytes=393_216
    )
    return PolicyAnnouncement(
        version=Version(2, 7),
        learner="learner-1",
        created_ns=TIME_NS,
        tensors=(ref,),
        bank=("pick up the cheese", "wait"),
        low_level_sha256="ab" * 32,
        settings={"width": 128, "temperature": 0.5, "head": "linear", "deep": False},
        robots=("robot-1",),
    )


def order() -> TrialOrder:
    return TrialOrder(
        policy=policy(),
        policy_sha256="12" * 32,
        plan={"site": "far", "tasks": ["sandwich"], "skills": None},
        plan_sha256="34" * 32,
        seed=2_140_000_003,
        task="sandwich",
    )


def result() -> TrialResult:
    return TrialResult(
        policy_sha256="12" * 32,
        plan_sha256="34" * 32,
        seed=2_140_000_003,
        success=True,
        row={"steps": 412, "failure": "", "attempts": []},
    )


def report() -> TrialReport:
    return TrialReport(evaluator="eval-1", low_level_sha256="ab" * 32, result=result())


def ruling() -> Ruling:
    return Ruling(
        id="rule-1",
        verb=Verb.ALIAS,
        author="anna",
        phrase="grab the yellow slice",
        means="pick up the cheese",
        reason="it is the only yellow slice – sicher",
        created_ns=TIME_NS,
    )


def phrase_question() -> PhraseQuestion:
    text = "grab the yellow slice – bitte schön"
    return PhraseQuestion(robot="robot-1", text=text, anywhere=True)


def phrase_answer() -> PhraseAnswer:
    return PhraseAnswer(
        robot="robot-1",
        step=150,
        text="grab the yellow slice – bitte schön",
        commands=("pick up the cheese", "wait"),
        means="pick up the cheese",
        refused="nothing is in the hands",
        known=True,
        nearest=(Near(command="pick up the cheese", score=0.75),),
        low_level_sha256="5d" * 32,
    )


def learned_question() -> LearnedQuestion:
    return LearnedQuestion(corrections=("cor-1", "cor-2"))


def learned_answer() -> LearnedAnswer:
    return LearnedAnswer(learned={"cor-1": Version(1, 2)}, held_out=("cor-2",))


def recording() -> Recording:
    told = decision()
    names = set(Recorded.model_fields) - {"arrays", "entropy"}
    fields = {name: getattr(told, name) for name in names}
    recorded = Recorded(**fields, entropy=told.entropy)
    return Recording(episode="ep-1", robot="robot-1", decisions=(recorded,), next=4)


def still() -> Still:
    jpeg = np.frombuffer(b"\xff\xd8 a picture \xff\xd9", np.uint8)
    return Still(decision="dec-1", camera="top", step=150, arrays={"jpeg": jpeg})


def lineage() -> Lineage:
    before = Share(share=0.52, n=200, low=0.45, high=0.59)
    after = Share(share=0.71, n=200, low=0.64, high=0.77)
    compared = Compared(before=before, after=after)
    told = RoundTold(
        number=2,
        epoch=1,
        parent=1,
        made=2,
        state="passed",
        episodes=24,
        corrections=14,
        labels=433,
        held_out=compared,
        retained=compared,
        unjudged="held out 19 labels, needs 20: not judged",
        trials=compared,
        trials_p=0.0625,
        seconds=99.5,
        promotable=False,
        reason="none",
        begun_ns=TIME_NS,
        ended_ns=TIME_NS + 1,
    )
    version = VersionTold(
        number=2,
        epoch=1,
        created_ns=TIME_NS,
        round=2,
        again=0,
        ruling="rule-1",
        robots=("robot-1",),
    )
    ruled = RulingTold(ruling=ruling(), answered_ns=TIME_NS, made=2, reason="none")
    return Lineage(version=Version(1, 2), versions=(version,), rounds=(told,), rulings=(ruled,))


def golden_file(cls: type[Message], number: int) -> Path:
    suffix = "safetensors" if cls.ARRAYS else "json"
    return GOLDEN / f"{cls.__name__.lower()}-{number}.{suffix}"


def write_missing() -> None:
    """Write the golden bytes that don't exist; those that do are never touched."""
    for cls, message in samples().items():
        path = golden_file(cls, NUMBERS[cls])
        if not path.exists():
            path.write_bytes(encode(message))


if __name__ == "__main__":
    write_missing()
