"""What a rollout answers to a person's word: why it can't be obeyed, or since when it is.

Between `rollout.py`, which obeys, and whoever waits for the receipt.
"""

from typing import NamedTuple

from shared.messages.correction import AFTERWARDS, Correction, Kind
from shared.messages.receipt import Receipt


class Moment(NamedTuple):
    """How a rollout stands when a word comes.

    over: the episode has ended. decisions: how many were taken. held: an override holds.
    """

    episode: str
    over: bool
    decisions: int
    held: bool
    paused: bool


def objection(correction: Correction, moment: Moment) -> str:
    """Why a rollout can't obey, whatever the low level says; "" if it can.

    What is said afterwards is never too late: about an episode that is over it changes nothing
    here, and whoever learns from it can tell.
    """
    episode = moment.episode
    if correction.kind is Kind.PAUSE:  # Whoever stops a robot means it as it is, in any episode.
        return ""
    if correction.kind in AFTERWARDS and (correction.episode != episode or moment.over):
        return ""
    if correction.episode != episode:
        return f"episode {correction.episode} is over; the current one is {episode}"
    if moment.over:
        return f"episode {episode} is over; wait for the next one"
    if correction.decision and not _took(correction.decision, moment):
        newest = f"the newest is {episode}-{moment.decisions - 1}" if moment.decisions else ""
        return f"no decision {correction.decision} in this episode; {newest or 'none so far'}"
    if correction.kind is Kind.RELEASE and not moment.held:
        return "no override holds, so there is nothing to release"
    if correction.kind is Kind.RESUME and not moment.paused:
        return "the robot is not paused, so there is nothing to resume"
    return ""


def answer(
    correction: Correction,
    robot: str,
    step: int | None,
    time_ns: int,
    *,
    replaced: str | None = None,
    why: str = "",
) -> Receipt:
    """The receipt: in force since control step `step`; None: refused because of `why`."""
    return Receipt(
        correction=correction.id,
        robot=robot,
        episode=correction.episode,
        accepted=step is not None,
        step=step,
        replaced=replaced,
        reason=why,
        time_ns=time_ns,
    )


def _took(decision: str, moment: Moment) -> bool:
    """Whether a decision of this id was taken in this episode."""
    episode, _, index = decision.rpartition("-")
    return episode == moment.episode and index.isdecimal() and int(index) < moment.decisions
