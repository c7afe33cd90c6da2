"""Archive: what the learner keeps, asked over the bus: episodes, pictures, rounds and versions.

Called in threads of the routes: a question waits for its answer, and holds up nobody else.
"""

from typing import TypeVar

from services.correction_api.problems import Problem, unavailable
from shared.errors import MessageError, NoAnswerError, RefusedError
from shared.messages.lineage import Lineage
from shared.messages.message import Message
from shared.messages.recording import Recording, RecordingQuery, Still, StillQuery
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import any_service

LEARNER = "learner"

M = TypeVar("M", bound=Message)


class Archive:
    """Asks the learner. Every method may be called from any thread, and raises:

    Problem: 503, no learner answers; 404, it has nothing of that name.
    """

    def __init__(self, bus: Bus, fleet: str, patience_s: float) -> None:
        """patience_s: how long to wait for an answer."""
        self._bus, self._fleet, self._patience_s = bus, fleet, patience_s

    def recording(self, query: RecordingQuery) -> Recording:
        """Decisions of an episode; none where the learner has none of it."""
        return self._ask("recording", encode(query), Recording)

    def still(self, query: StillQuery) -> Still:
        """A picture that the high level saw."""
        return self._ask("still", encode(query), Still)

    def lineage(self) -> Lineage:
        """Versions, rounds and rulings."""
        return self._ask("lineage", b"", Lineage)

    def _ask(self, message: str, payload: bytes, kind: type[M]) -> M:
        key = any_service(self._fleet, LEARNER, message)
        try:
            return decode(kind, self._bus.ask(key, payload, timeout_s=self._patience_s))
        except RefusedError as error:
            raise Problem(404, "not-kept", "The learner has no such thing", str(error)) from None
        except (NoAnswerError, MessageError) as error:
            detail = (
                "no learner answers, and it keeps this; start it (`hld learner`), or try again. "
                f"What was said is kept here for it meanwhile. ({error})"
            )
            raise unavailable("no-learner", "The learner is away", detail, 2) from None
