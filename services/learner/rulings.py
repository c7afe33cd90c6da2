"""What people decide about versions: a refused candidate goes out after all, or an earlier version
is in force again; done by the learner that has the store, at its next look.
"""

from services.learner.gate import Candidate
from services.learner.store.store import Answer, PolicyRecord, Round, RoundState
from services.learner.turn import Parts, again, next_number
from shared.errors import RefusedError
from shared.messages.ruling import Ruling, Verb


def carry_out(
    ruling: Ruling, parts: Parts, epoch: int, in_force: PolicyRecord
) -> tuple[Answer, PolicyRecord | None]:
    """The answer to a ruling, kept, and the version that it put in force, if it did."""
    made, reason = None, ""
    try:
        if ruling.verb is Verb.PROMOTE:
            made = _promoted(ruling, parts, epoch, in_force)
        elif ruling.verb is Verb.ROLLBACK:
            made = _back(ruling, parts, epoch, in_force)
    except RefusedError as error:
        reason = str(error)
    number = made.number if made else None
    answer = Answer(ruling=ruling, answered_ns=parts.clock.now_ns(), made=number, reason=reason)
    parts.store.answer(answer, made)
    return answer, made


def _promoted(ruling: Ruling, parts: Parts, epoch: int, in_force: PolicyRecord) -> PolicyRecord:
    """What a round made and the gate held back."""
    rounds = {round_.number: round_ for round_ in parts.store.rounds()}
    round_ = rounds.get(ruling.round or 0)
    if round_ is None:
        raise RefusedError(f"there is no round {ruling.round}; {_known(list(rounds), 'round')}")
    candidate = promotable(round_)
    return PolicyRecord(
        number=next_number(parts.store),
        epoch=epoch,
        tensors=candidate.tensors,
        bank=candidate.bank,
        settings=candidate.settings,
        low_level_sha256=in_force.low_level_sha256,
        marks=parts.store.survey(round_.manifest).marks,
        created_ns=parts.clock.now_ns(),
        ruling=ruling.id,
    )


def promotable(round_: Round) -> Candidate:
    """What a round made, if it may go out after all.

    Raises:
        RefusedError: it may not; says why.
    """
    if round_.state is RoundState.PASSED:
        raise RefusedError(
            f"round {round_.number} passed the gate; its version is {round_.made}: roll back to it"
        )
    if round_.state is RoundState.RUNNING:
        raise RefusedError(
            f"round {round_.number} is not over yet; promote it once its gate has judged"
        )
    if round_.candidate is None:
        raise RefusedError(f"round {round_.number} made nothing: {round_.reason}")
    candidate = Candidate.model_validate(round_.candidate)
    if not candidate.figures.finite:
        raise RefusedError(f"what round {round_.number} made can't run: {round_.reason}")
    return candidate


def _back(ruling: Ruling, parts: Parts, epoch: int, in_force: PolicyRecord) -> PolicyRecord:
    """An earlier version under a new number; the one in force, where a later one is on trial."""
    number = ruling.version if ruling.version is not None else -1
    record = parts.store.version(number)
    if record is None:
        known = [version.number for version in parts.store.versions()]
        raise RefusedError(f"there is no version {number}; {_known(known, 'version')}")
    on_trial = parts.store.versions()[-1].robots
    if record.number == in_force.number and not on_trial:
        raise RefusedError(f"version {number} is in force; roll back to an earlier one")
    if record.low_level_sha256 != in_force.low_level_sha256:
        raise RefusedError(
            f"version {number} was made for another low level than the one in force: its commands "
            "would be carried out otherwise; choose one that was made since"
        )
    return again(record, parts, epoch, ruling.id)


def _known(numbers: list[int], what: str) -> str:
    if not numbers:
        return f"there is no {what} yet"
    return f"those that there are: {', '.join(map(str, numbers))}"
