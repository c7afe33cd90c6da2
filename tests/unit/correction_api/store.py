"""Opens a log for a test, and closes it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from services.correction_api.store.store import Store, open_store
from shared.messages.correction import Correction, Kind
from shared.messages.goal import LanguageGoal
from shared.messages.receipt import Receipt


@contextmanager
def opened_store(database: Path) -> Iterator[Store]:
    """The store in `database`, made when there is none."""
    with open_store(database, lambda name: f"hld/v1/lab/correction-api/api/{name}") as store:
        yield store


def correction(name: str, *, robot: str = "robot-1", created_ns: int = 1) -> Correction:
    """Somebody said "wait"."""
    return Correction(
        id=name,
        robot=robot,
        episode=f"{robot}-e1",
        kind=Kind.OVERRIDE,
        author="anna",
        goal=LanguageGoal(text="wait"),
        begun_ns=1,
        created_ns=created_ns,
    )


def receipt(name: str, *, robot: str = "robot-1", reason: str = "") -> Receipt:
    """In force since step 7, or refused because of `reason`."""
    return Receipt(
        correction=name,
        robot=robot,
        episode=f"{robot}-e1",
        accepted=not reason,
        step=None if reason else 7,
        reason=reason,
        time_ns=2,
    )
