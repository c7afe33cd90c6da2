"""The parts of one running correction API, as the routes see them; made in `build.py`."""

from collections import OrderedDict
from dataclasses import dataclass, field

from services.correction_api.accept import Desk
from services.correction_api.archive import Archive
from services.correction_api.bell import Bell
from services.correction_api.calls import Calls
from services.correction_api.config import ApiSettings
from services.correction_api.lexicon import Lexicon
from services.correction_api.live import Live
from services.correction_api.metrics import Metrics
from services.correction_api.reports import Reports
from services.correction_api.speech.ear import Ear
from services.correction_api.store.episodes import Episodes
from services.correction_api.store.lessons import Lessons
from services.correction_api.store.log import Log
from services.correction_api.store.parcels import Parcels
from services.correction_api.store.rulings import Rulings
from services.correction_api.watch import Watch
from shared.wire.bus import Bus

REMEMBERED_AUTHORS = 1024


class Authors:
    """Who said the last corrections, by their ids. Event loop's thread only."""

    def __init__(self) -> None:
        self._names: OrderedDict[str, str] = OrderedDict()

    def add(self, correction: str, author: str) -> None:
        """Remember who said a correction."""
        self._names[correction] = author
        while len(self._names) > REMEMBERED_AUTHORS:
            self._names.popitem(last=False)

    def get(self, correction: str) -> str | None:
        """Who said it, if it is one of the last."""
        return self._names.get(correction)


@dataclass(frozen=True)
class Parts:
    """bell: rings at each new decision. The rest: see the class of each."""

    settings: ApiSettings
    bus: Bus
    metrics: Metrics
    watch: Watch
    calls: Calls
    log: Log
    parcels: Parcels
    episodes: Episodes
    lessons: Lessons
    rulings: Rulings
    archive: Archive
    reports: Reports
    desk: Desk
    lexicon: Lexicon
    live: Live
    bell: Bell
    ear: Ear
    authors: Authors = field(default_factory=Authors)
