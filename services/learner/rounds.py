"""Decide when a round begins and what it is made from: only what has arrived completely."""

from collections.abc import Iterable
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from services.learner.code import code_version
from services.learner.store.store import Arrival, Manifest, Marks, Round
from shared.config import Settings
from shared.errors import PolicyError

SOURCES = {
    "demonstrations": "the demonstrations",
    "base": "the first version of the store",
    "parent": "the version that it starts from",
}


class RoundSettings(Settings):
    """What sets a round off; whatever comes first does, and 0 switches a trigger off.

    corrections: new overrides in finished episodes, commands newly said of the past, and what a
        round had and was taken back since. episodes: newly finished ones.
    after_s: seconds since the last round, if there is at least one new correction.
    max_rounds: then only collect; 0 goes on for ever.
    patience_s: how long an episode may wait for decisions and corrections that it speaks of.
    """

    corrections: Annotated[int, Field(ge=0)] = 25
    episodes: Annotated[int, Field(ge=0)] = 0
    after_s: Annotated[float, Field(ge=0)] = 300.0
    max_rounds: Annotated[int, Field(ge=0)] = 0
    patience_s: Annotated[float, Field(ge=0)] = 30.0


class Stock(NamedTuple):
    """The episodes that no round has used.

    ready: all is here that they speak of. short: not all of it, and no longer waited for.
    waiting: not all of it yet. hindsight: as in `Survey`.
    """

    ready: tuple[Arrival, ...]
    short: tuple[Arrival, ...]
    waiting: tuple[Arrival, ...]
    hindsight: int = 0

    @property
    def episodes(self) -> int:
        """How many a round would be made from, but for those that were broken off."""
        return sum(not arrival.aborted for arrival in (*self.ready, *self.short))

    @property
    def corrections(self) -> int:
        """The overrides in them, and what was said of the past."""
        return self.hindsight + sum(arrival.overrides for arrival in (*self.ready, *self.short))


def take_stock(
    arrivals: Iterable[Arrival], now_ns: int, patience_s: float, hindsight: int = 0
) -> Stock:
    """Sort episodes by whether a round may use them."""
    ready, short, waiting = [], [], []
    for arrival in arrivals:
        if not (arrival.decisions or arrival.corrections):
            ready.append(arrival)
        elif now_ns - arrival.arrived_ns >= patience_s * 1e9:
            short.append(arrival)
        else:
            waiting.append(arrival)
    return Stock(tuple(ready), tuple(short), tuple(waiting), hindsight)


def due(stock: Stock, waited_s: float, begun: int, settings: RoundSettings) -> bool:
    """Whether a round begins now.

    waited_s: since the last round ended. begun: how many there have been.
    """
    if settings.max_rounds and begun >= settings.max_rounds:
        return False
    return (
        0 < settings.corrections <= stock.corrections
        or 0 < settings.episodes <= stock.episodes
        or (0 < settings.after_s <= waited_s and stock.corrections > 0)
    )


def next_manifest(marks: Marks, stock: Stock, settings: dict[str, Any], **sources: str) -> Manifest:
    """Everything up to `marks`, but for the episodes that are still waited for.

    sources: hashes of demonstrations, base and parent, as in `Manifest`.
    """
    return Manifest(
        marks=marks,
        excluded=tuple(arrival.episode for arrival in stock.waiting),
        settings=settings,
        code=code_version(),
        episodes=stock.episodes,
        corrections=stock.corrections,
        **sources,
    )


def check_sources(manifest: Manifest, **found: str) -> None:
    """Hold what a round is to be made from against what it began with.

    found: as `sources` of `next_manifest`; what a manifest doesn't tell is not looked at.

    Raises:
        PolicyError: it is not the same; nothing that this manifest speaks of could come of it.
    """
    for name, now in found.items():
        then = getattr(manifest, name)
        if then and now != then:
            raise PolicyError(
                f"{SOURCES[name]} changed since the round began (sha256 {then[:16]} then, "
                f"{now[:16]} now): put back what was there, or let a new round begin with this"
            )


def last_manifest(rounds: Iterable[Round]) -> Manifest:
    """What the newest round was made from; an empty one before the first."""
    manifests = [round_.manifest for round_ in rounds]
    return manifests[-1] if manifests else Manifest()
