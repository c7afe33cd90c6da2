"""One robot first: a version that passed the gate runs on some robots before all others take it.

Held against the version before it by episodes, as people supervise them: success, and how often
they had to speak.
"""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

from pydantic import Field

from shared.config import Settings
from shared.messages.episode import Episode, Outcome
from shared.messages.message import Id


class CanarySettings(Settings):
    """robots: that go first; none named: all take a version at once.

    episodes: that they must finish under it. within_s: or else it is taken back, and so it is if
        by then there is no episode under the version before to compare with.
    max_fall: by which success may fall, against the last episodes under the version before.
    max_more: corrections an episode more than there.
    """

    robots: tuple[Id, ...] = ()
    episodes: Annotated[int, Field(ge=1)] = 10
    within_s: Annotated[float, Field(gt=0)] = 3600.0
    max_fall: Annotated[float, Field(ge=0, le=1)] = 0.2
    max_more: Annotated[float, Field(ge=0)] = 1.0


class Finding(NamedTuple):
    """What is known of a version that some robots run first.

    over: it can be said whether all shall run it. reason: why it is taken back, "" if it isn't;
    before it is over, what is waited for.
    """

    over: bool
    reason: str = ""


def judge(
    mine: Sequence[Episode], before: Sequence[Episode], waited_s: float, settings: CanarySettings
) -> Finding:
    """Hold a version against the one before it, as soon as there are episodes of both.

    mine: episodes under it. before: under the version before, the newest last; those that were
    broken off count on neither side.
    """
    mine, before = _whole(mine), _whole(before)[-4 * settings.episodes :]
    missing, hint = _missing(mine, before, settings)
    if not missing:
        return Finding(True, _worse(mine, before, settings))
    if waited_s < settings.within_s:
        return Finding(False, f"{missing}; this is waited for {settings.within_s:.0f} s at most")
    return Finding(
        True, f"{missing} in {waited_s:.0f} s; {hint}, or gate.canary.within_s allows more time"
    )


def _missing(
    mine: Sequence[Episode], before: Sequence[Episode], settings: CanarySettings
) -> tuple[str, str]:
    """What there is too little of to judge, and what would help; "" where there is enough."""
    if len(mine) < settings.episodes:
        names = ", ".join(settings.robots)
        return f"{names} finished {len(mine)} of {settings.episodes} episodes", "start it"
    if not before:
        other = "let a robot run it that is not in gate.canary.robots"
        return "no episode ended under the version before, to compare with", other
    return "", ""


def _worse(mine: Sequence[Episode], before: Sequence[Episode], settings: CanarySettings) -> str:
    """Why a version does worse than the one before; "" if it doesn't."""
    fall = _share(before) - _share(mine)
    if fall > settings.max_fall:
        return (
            f"success fell from {_share(before):.2f} (n = {len(before)}) to {_share(mine):.2f} "
            f"(n = {len(mine)}) on {', '.join(settings.robots)}; {settings.max_fall} is allowed"
        )
    more = _corrections(mine) - _corrections(before)
    if more > settings.max_more:
        return (
            f"people had to correct {', '.join(settings.robots)} {_corrections(mine):.1f} times "
            f"an episode instead of {_corrections(before):.1f}; {settings.max_more} more is allowed"
        )
    return ""


def _whole(episodes: Sequence[Episode]) -> list[Episode]:
    return [one for one in episodes if one.outcome is not Outcome.ABORTED]


def _share(episodes: Sequence[Episode]) -> float:
    return sum(one.success for one in episodes) / len(episodes)


def _corrections(episodes: Sequence[Episode]) -> float:
    return sum(one.corrections for one in episodes) / len(episodes)
