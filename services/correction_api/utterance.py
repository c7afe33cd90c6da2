"""What a client says: the body of a correction, checked before anything is kept."""

import hashlib
import unicodedata
from typing import Annotated, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue, model_validator

from shared.messages.correction import BOUND, Correction, Kind, check_fields, check_span
from shared.messages.goal import LanguageGoal
from shared.messages.message import MAX_TEXT, Id

MAX_NS = 2**63 - 1
MAX_STEP = 2**31 - 1
JOINERS = "\u200c\u200d"  # Some scripts can't be written without them.
FORBIDDEN = {"Cc", "Cf", "Cs", "Zl", "Zp"}


def check_line(text: str) -> str:
    """One line without spaces around it.

    Raises:
        ValueError: nothing is left, it is too long, or a character can't be seen by a reader.
    """
    text = unicodedata.normalize("NFC", text.strip())
    if not text:
        raise ValueError("it was empty: write a line")
    if len(text) > MAX_TEXT:
        raise ValueError(f"{len(text)} characters are too many; at most {MAX_TEXT}")
    for place, letter in enumerate(text):
        if unicodedata.category(letter) in FORBIDDEN and letter not in JOINERS:
            raise ValueError(
                f"U+{ord(letter):04X} at character {place} is a control character; "
                "use letters, digits, spaces and punctuation, all in one line"
            )
    return text


def check_words(text: str) -> str:
    """What is said to a robot, as `check_line` has it.

    Raises:
        ValueError: it is none of these.
    """
    if not text.strip():
        raise ValueError("say what the robot shall do, such as 'pick up the cheese'; it was empty")
    return check_line(text)


Line = Annotated[str, AfterValidator(check_line)]
Words = Annotated[str, AfterValidator(check_words)]
Count = Annotated[int, Field(strict=True, ge=0, le=MAX_STEP)]
Nanoseconds = Annotated[int, Field(strict=True, ge=0, le=MAX_NS)]

_CALLED = {"goal": "text"}  # Here a goal is said in words.

EXAMPLES: list[JsonValue] = [
    {"kind": "override", "text": "pick up the cheese", "author": "anna"},
    {"kind": "override", "text": "wait", "hold_steps": 100, "author": "anna"},
    {"kind": "release", "author": "anna"},
    {"kind": "approve", "decision": "ep-5f1c-3", "author": "anna"},
    {"kind": "retract", "target": "say-0a1b2c3d4e5f6071", "author": "anna"},
    {
        "kind": "edit",
        "target": "say-0a1b2c3d4e5f6071",
        "text": "pick up the ham",
        "author": "anna",
    },
    {
        "kind": "retime",
        "target": "say-0a1b2c3d4e5f6071",
        "first_step": 52,
        "end_step": 180,
        "author": "anna",
    },
    {
        "kind": "relabel",
        "episode": "ep-5f1c",
        "text": "pick up the cheese",
        "first_step": 40,
        "end_step": 120,
        "author": "anna",
    },
    {"kind": "fault", "decision": "ep-5f1c-3", "note": "it slipped", "author": "anna"},
    {
        "kind": "endorse",
        "episode": "ep-5f1c",
        "first_step": 0,
        "end_step": 420,
        "author": "anna",
    },
]


class Utterance(BaseModel):
    """What somebody says about a robot. Only `kind` is always needed.

    kind: override (obey `text` instead), release (lift the override), approve (the command of
        `decision` was right), pass (seen, nothing to say), pause, resume. About the past, also of
        an episode that is over: retract, edit and retime the correction `target`; relabel (from
        `first_step` up to `end_step` `text` would have been right); fault (the command was right,
        the hand slipped); endorse (over these steps all was right where nobody spoke).
    text: the command in words of your own; up to 200 characters in one line.
    target: the id of the correction that you take back, reword or move.
    first_step, end_step: the control steps from the first up to, without, the second.
    hold_steps: control steps (50 a second) until an override expires; null holds until released.
    decision: the decision that you looked at; approve and pass need it.
    episode: the episode that it is about; that of the decision or target, or else the current one.
        A relabel and an endorsement need it, and so does a fault without a decision.
    seen_step: the control step that you saw; that of the decision if it is not given.
    begun_ns: when you began to speak, in ns since 1970; now if it is not given.
    delay_steps: in supervised lockstep, the steps until it takes effect.
    heard: where it was spoken, the words as they were recognised.
    id: a name of your own, so that it can be sent again without being said twice; the header
        `Idempotency-Key` does the same.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", json_schema_extra={"examples": [*EXAMPLES]}
    )

    kind: Kind
    text: Words | None = None
    hold_steps: Annotated[int, Field(strict=True, ge=1, le=100_000)] | None = None
    decision: Id | None = None
    target: Id | None = None
    first_step: Count | None = None
    end_step: Count | None = None
    episode: Id | None = None
    seen_step: Count | None = None
    begun_ns: Nanoseconds | None = None
    author: Id = "person"
    delay_steps: Annotated[int, Field(strict=True, ge=0, le=10_000)] = 0
    id: Id | None = None
    heard: Line | None = None
    note: Line | None = None

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        if self.kind is Kind.OVERRIDE and self.text is None:
            raise ValueError("an override needs text: the command, such as 'pick up the cheese'")
        given = {name for name in BOUND if getattr(self, _CALLED.get(name, name)) is not None}
        check_fields(self.kind, given, _CALLED)
        check_span(self.kind, self.first_step, self.end_step, self.decision)
        if self.kind in (Kind.APPROVE, Kind.PASS) and self.decision is None:
            raise ValueError(f"{self.kind} needs decision: the id of the decision that you saw")
        if self.first_step is not None and not (self.target or self.decision or self.episode):
            raise ValueError(f"{self.kind} needs episode: which one the steps are of")
        return self

    def digest(self, robot: str) -> str:
        """A hash of what was said and about whom: equal for the same request sent again."""
        said = self.model_dump_json(exclude={"id"})
        return hashlib.sha256(f"{robot}\n{said}".encode()).hexdigest()

    def formulate(
        self, name: str, robot: str, episode: str, seen_step: int | None, now_ns: int
    ) -> Correction:
        """The correction that it is, said about `robot` in `episode`."""
        return Correction(
            id=name,
            robot=robot,
            episode=episode,
            kind=self.kind,
            author=self.author,
            goal=LanguageGoal(text=self.text) if self.text else None,
            decision=self.decision,
            target=self.target,
            first_step=self.first_step,
            end_step=self.end_step,
            seen_step=self.seen_step if self.seen_step is not None else seen_step,
            hold_steps=self.hold_steps,
            delay_steps=self.delay_steps,
            begun_ns=self.begun_ns if self.begun_ns is not None else now_ns,
            created_ns=now_ns,
            heard=self.heard,
            note=self.note,
        )
