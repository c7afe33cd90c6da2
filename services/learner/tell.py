"""Tell people what there was: episodes, pictures, rounds and versions; beside the loop, not in it.

Each question has a thread of its own and the archive its own connections, so that an answer comes
while a round trains, and what arrives doesn't wait for it.
"""

from collections.abc import Mapping
from typing import Any, Literal, cast

import numpy as np
import simplejpeg

from services.learner.publish import LEARNER
from services.learner.store.archive import Archive, Row
from shared.errors import RefusedError
from shared.intervals import wilson
from shared.messages.decision import Decision
from shared.messages.lineage import (
    MAX_TOLD,
    Compared,
    Lineage,
    RoundTold,
    RulingTold,
    Share,
    VersionTold,
)
from shared.messages.observation import CAMERAS
from shared.messages.policy import Version
from shared.messages.recording import (
    MAX_PROPOSED,
    Recorded,
    Recording,
    RecordingQuery,
    Still,
    StillQuery,
)
from shared.messages.ruling import Verb
from shared.wire.bus import Bus, Subscription
from shared.wire.codec import decode, encode
from shared.wire.keys import service_key

QUALITY = 92
_ALIKE = ("id", "index", "step", "time_ns", "asked", "prompt", "executed", "chosen_by", "choice")


class Teller:
    """Answers `recording`, `still` and `lineage` while it is open."""

    def __init__(self, bus: Bus, fleet: str, learner: str, archive: Archive) -> None:
        self._archive = archive
        questions = {"recording": self.recording, "still": self.still, "lineage": self.lineage}
        self._served: list[Subscription] = [
            bus.serve(service_key(fleet, LEARNER, learner, name), answer, capacity=64)
            for name, answer in questions.items()
        ]

    def close(self) -> None:
        """Answer nobody any more."""
        for subscription in self._served:
            subscription.close()

    def recording(self, key: str, payload: bytes) -> bytes:
        """Decisions of an episode without their pictures."""
        del key  # Unused.
        query = decode(RecordingQuery, payload)
        found = self._archive.decided(query.episode, query.first, query.limit + 1)
        told = found[: query.limit]
        recording = Recording(
            episode=query.episode,
            robot=told[0].robot if told else None,
            decisions=tuple(map(record, told)),
            next=query.first + query.limit if len(found) > query.limit else None,
        )
        return encode(recording)

    def still(self, key: str, payload: bytes) -> bytes:
        """What a camera showed at a decision.

        Raises:
            RefusedError: there is no such decision or camera; the message says which there are.
        """
        del key  # Unused.
        query = decode(StillQuery, payload)
        decision = self._archive.decision(query.decision)
        if decision is None:
            raise RefusedError(f"no decision {query.decision} is kept")
        known = CAMERAS[: len(decision.arrays["images"])]
        if query.camera not in known:
            raise RefusedError(f"no camera {query.camera}; there are {', '.join(known)}")
        picture = np.ascontiguousarray(decision.arrays["images"][known.index(query.camera)])
        jpeg = simplejpeg.encode_jpeg(
            picture, quality=QUALITY, colorspace="RGB", colorsubsampling="444"
        )
        arrays = {"jpeg": np.frombuffer(jpeg, np.uint8)}
        return encode(
            Still(decision=decision.id, camera=query.camera, step=decision.step, arrays=arrays)
        )

    def lineage(self, key: str, payload: bytes) -> bytes:
        """Versions, rounds and rulings."""
        del key, payload  # Unused: nothing is to be chosen.
        versions = self._archive.versions(MAX_TOLD)
        rounds = [tell_round(row) for row in self._archive.rounds(MAX_TOLD)]
        rulings = self._archive.rulings(MAX_TOLD)
        made_by = {one.made: one.number for one in rounds if one.made is not None}
        made_by |= {
            one.made: one.ruling.round
            for one in rulings
            if one.made is not None and one.ruling.round is not None
        }
        newest = next((row for row in reversed(versions) if not row["robots"]), None)
        if newest is None:
            raise RefusedError("the store has no version yet")
        told = Lineage(
            version=Version(newest["epoch"], newest["number"]),
            versions=tuple(
                VersionTold(
                    **row | {"ruling": row["ruling"] or None}, round=made_by.get(row["number"])
                )
                for row in versions
            ),
            rounds=tuple(rounds),
            rulings=tuple(
                RulingTold(**answer.model_dump(exclude={"ruling"}), ruling=answer.ruling)
                for answer in rulings
                if answer.ruling.verb in (Verb.PROMOTE, Verb.ROLLBACK)
            ),
        )
        return encode(told)


def record(decision: Decision) -> Recorded:
    """What is told of a decision."""
    return Recorded(
        **{name: getattr(decision, name) for name in _ALIKE},
        proposed=decision.proposed[:MAX_PROPOSED],
        entropy=round(decision.entropy, 4),
        version=decision.version,
        help=decision.help,
    )


def tell_round(row: Row) -> RoundTold:
    """What is told of a round; `row` as `Archive.rounds` has it."""
    figures, manifest = row["figures"] or {}, row["manifest"]
    finite = figures.get("finite") is not False
    held_back = row["state"] in ("refused", "failed")
    trials = figures.get("trials") or {}
    return RoundTold(
        number=row["number"],
        epoch=row["epoch"],
        parent=row["parent"],
        made=row["made"],
        state=cast(Literal["running", "passed", "refused", "failed"], str(row["state"])),
        episodes=manifest.get("episodes", 0),
        corrections=manifest.get("corrections", 0),
        labels=figures.get("labels"),
        held_out=_agreed(figures, "held_out", ""),
        retained=_agreed(figures, "retained", "retained_"),
        unjudged=figures.get("unjudged", ""),
        trials=_tried(trials),
        trials_p=trials.get("p"),
        seconds=figures.get("seconds"),
        promotable=held_back and bool(row["kept"]) and finite,
        reason=row["reason"],
        begun_ns=row["begun_ns"],
        ended_ns=row["ended_ns"],
    )


def _agreed(figures: Mapping[str, Any], count: str, prefix: str) -> Compared | None:
    """Agreement with labels, which are decisions of few episodes: without an interval."""
    before, after = figures.get(f"{prefix}before"), figures.get(f"{prefix}after")
    if before is None or after is None:
        return None
    n = int(figures.get(count, 0))
    return Compared(before=Share(share=before, n=n), after=Share(share=after, n=n))


def _tried(trials: Mapping[str, Any]) -> Compared | None:
    if not {"candidate", "in_force"} <= set(trials):
        return None
    before, after = (_share(trials[name]) for name in ("in_force", "candidate"))
    return Compared(before=before, after=after)


def _share(found: Mapping[str, Any]) -> Share:
    n, share = int(found["n"]), float(found["success"])
    low, high = found.get("interval") or wilson(round(share * n), n)
    return Share(share=share, n=n, low=low, high=high)
