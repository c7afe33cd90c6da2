"""The logbook of a robot: what its actor must not forget when it dies."""

import json
import os
from pathlib import Path

from shared.messages.episode import Episode


class Logbook:
    """What a robot must remember over a restart: which episode is next, its share, and the draft
    of the episode at work, so that it is told as broken off when its actor died in it.

    number: episodes begun so far. finished: episodes finished under `version`.
    draft: the episode at work as it would be told if it ended now; None between two.
    called_ns: when it called for help, as far as its budget needs it, so that a crash refills none.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        stored = json.loads(file.read_text()) if file.exists() else {}
        self.number: int = stored.get("number", 0)
        self.version: str = stored.get("version", "")
        self.finished: int = stored.get("finished", 0)
        self.called_ns: tuple[int, ...] = tuple(stored.get("called_ns", ()))
        draft = stored.get("draft")
        self.draft = Episode.model_validate(draft) if draft else None

    def begin(self, version: str) -> None:
        """An episode begins under `version`."""
        if version != self.version:
            self.version, self.finished = version, 0
        self.number += 1
        self._write()

    def renew(self) -> None:
        """Another share under the same version."""
        self.finished = 0
        self._write()

    def note(self, draft: Episode) -> None:
        """The episode at work has come so far."""
        self.draft = draft
        self._write()

    def called(self, times_ns: tuple[int, ...]) -> None:
        """It called for help; these are the times that its budget must know."""
        self.called_ns = times_ns
        self._write()

    def close(self, finished: bool) -> None:
        """The episode at work was told; `finished`: it counts."""
        self.draft = None
        self.finished += finished
        self._write()

    def _write(self) -> None:
        content = {
            "number": self.number,
            "version": self.version,
            "finished": self.finished,
            "called_ns": self.called_ns,
            "draft": self.draft.without_arrays() if self.draft else None,
        }
        fresh = self._file.with_suffix(".new")
        fresh.write_text(json.dumps(content))
        os.replace(fresh, self._file)
