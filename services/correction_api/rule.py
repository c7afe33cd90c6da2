"""Rule: a person puts a version in force, or goes back to one; kept, and taken to the learner."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, JsonValue, model_validator

from services.correction_api.archive import Archive
from services.correction_api.problems import Problem
from services.correction_api.utterance import Line
from shared.messages.lineage import Lineage
from shared.messages.message import Id, new_id
from shared.messages.ruling import Ruling, Verb

EXAMPLES: list[JsonValue] = [
    {"verb": "rollback", "version": 1, "reason": "1.2 drops the bread", "author": "anna"},
    {"verb": "promote", "round": 3, "reason": "the gate had a bad scene", "author": "anna"},
]


class RulingBody(BaseModel):
    """What somebody decides about versions.

    verb: promote (what `round` made goes out, although the gate held it back) or rollback (the
        weights of `version` are in force again, under a new number).
    version: the number of a version, the second half of "1.2".
    reason: why, in one line; it is kept for ever. author: who decides.
    id: a name of your own, so that it can be sent again without being decided twice.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", json_schema_extra={"examples": [*EXAMPLES]}
    )

    verb: Literal[Verb.PROMOTE, Verb.ROLLBACK]
    round: Annotated[int, Field(strict=True, ge=1, le=2**31 - 1)] | None = None
    version: Annotated[int, Field(strict=True, ge=0, le=2**31 - 1)] | None = None
    reason: Line
    author: Id
    id: Id | None = None

    @model_validator(mode="after")
    def _check_verb(self) -> Self:
        needs, other = ("round", "version") if self.verb is Verb.PROMOTE else ("version", "round")
        if getattr(self, needs) is None:
            raise ValueError(f"{self.verb} needs {needs}: the number of the {needs} that is meant")
        if getattr(self, other) is not None:
            raise ValueError(f"{self.verb} has no {other}; it has {needs}")
        return self

    def formulate(self, now_ns: int) -> Ruling:
        """The ruling that it is."""
        return Ruling(
            id=self.id or new_id("rule"),
            verb=self.verb,
            author=self.author,
            round=self.round,
            version=self.version,
            reason=self.reason,
            created_ns=now_ns,
        )


def same(one: Ruling, other: Ruling) -> bool:
    """Whether both decide the same; when doesn't matter."""
    return one.model_copy(update={"created_ns": other.created_ns}) == other


def check(ruling: Ruling, archive: Archive) -> bool:
    """Hold a ruling against what the learner has; False where no learner answers.

    Raises:
        Problem: 409, it can't be done; the detail says what could.
    """
    try:
        lineage = archive.lineage()
    except Problem:
        return False
    reason = _unknown_version(ruling, lineage) or _unfit_round(ruling, lineage)
    if reason:
        raise Problem(409, "not-to-be-done", "The learner could not do this", reason)
    return True


def _unknown_version(ruling: Ruling, lineage: Lineage) -> str:
    if ruling.verb is not Verb.ROLLBACK:
        return ""
    # While some robots run a later version first, to go back to the one in force ends that.
    on_trial = bool(lineage.versions and lineage.versions[-1].robots)
    known = [
        one.number for one in lineage.versions if one.number != lineage.version.number or on_trial
    ]
    if ruling.version == lineage.version.number and not on_trial:
        return f"version {lineage.version} is in force; {_one_of(known)}"
    return "" if ruling.version in known else f"no version {ruling.version}; {_one_of(known)}"


def _unfit_round(ruling: Ruling, lineage: Lineage) -> str:
    if ruling.verb is not Verb.PROMOTE:
        return ""
    fit = [one.number for one in lineage.rounds if one.promotable]
    found = next((one for one in lineage.rounds if one.number == ruling.round), None)
    if found is None:
        return f"no round {ruling.round}; {_one_of(fit)}"
    if not found.promotable:
        return f"round {ruling.round} {_STANDS[found.state]}; {_one_of(fit)}"
    return ""


_STANDS = {
    "running": "is not over yet",
    "passed": "passed the gate, and its version went out: roll back to that",
    "refused": "made nothing that can run",
    "failed": "made nothing that can run",
}


def _one_of(numbers: list[int]) -> str:
    return f"possible: {', '.join(map(str, numbers))}" if numbers else "there is none to choose"
