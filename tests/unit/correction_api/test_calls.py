"""Who asks for help: newest wins, the most urgent first, no more than the fleet's budget."""

import pytest

from services.correction_api.calls import Calls
from services.correction_api.metrics import Metrics
from shared.budget import HOUR_NS
from shared.clock import ManualClock
from shared.messages.correction import Correction, Kind
from shared.messages.help import Help, Reason
from tests.unit.correction_api.store import correction, receipt

S = 1_000_000_000


class Board:
    """Calls with a clock of the test's own, and how often the queue changed."""

    def __init__(self, per_hour: int = 0) -> None:
        self.clock, self.metrics = ManualClock(), Metrics()
        self.calls = Calls(self.clock, per_hour, self.metrics)
        self.changes = 0
        self.calls.on_change(self.note)

    def note(self) -> None:
        self.changes += 1

    def ask(
        self, robot: str, time_ns: int, doubt: float = 0.6, waits_s: float = 0, at: int = 0
    ) -> None:
        """A robot tells of its call number `at`, at a time of its own."""
        call = Help(
            decision=f"{robot}-e1-{at}",
            step=0,
            time_ns=at,
            reason=Reason.ENTROPY,
            doubt=doubt,
            waits_s=waits_s,
        )
        self.calls.tell(robot, call, time_ns)

    def answer(self, time_ns: int, kind: Kind = Kind.APPROVE, reason: str = "") -> None:
        """robot-1 gave a receipt."""
        goal = {"goal": None} if kind is not Kind.OVERRIDE else {}
        said = correction("c-1").model_copy(update={"kind": kind, **goal})
        said = Correction.model_validate(said.model_dump())
        made = receipt("c-1", reason=reason).model_copy(update={"time_ns": time_ns})
        self.calls.answer(said, made)

    @property
    def names(self) -> list[str]:
        return [call.robot for call in self.calls.queue()]

    def count(self, name: str) -> float:
        text = self.metrics.render().decode()
        lines = (line for line in text.splitlines() if line.startswith(f"hldagger_help_{name}"))
        return float(next(lines).rpartition(" ")[2])


def test_who_stands_still_comes_first_then_by_doubt() -> None:
    board = Board()
    for robot, doubt, waits_s in (("a", 0.5, 0), ("b", 0.9, 0), ("c", 0.4, 5), ("d", 0.6, 5)):
        board.ask(robot, 1, doubt, waits_s)
    assert board.names == ["d", "c", "b", "a"]


def test_the_time_that_a_robot_waits_runs_here_between_what_it_tells() -> None:
    board = Board()
    board.ask("robot-1", 1, waits_s=10)
    board.clock.advance(4 * S)
    assert board.calls.queue()[0].help.waits_s == pytest.approx(6)
    board.clock.advance(60 * S)
    assert board.calls.queue()[0].help.waits_s == 0


def test_what_is_older_than_what_is_known_does_not_count() -> None:
    board = Board()
    board.ask("robot-1", 20)
    board.calls.tell("robot-1", None, 10)
    assert board.names == ["robot-1"]
    board.calls.tell("robot-1", None, 30)
    board.ask("robot-1", 20)
    assert board.names == []


def test_a_robot_that_waited_for_nobody_is_counted_and_stays_in_the_queue() -> None:
    board = Board()
    board.ask("robot-1", 1, waits_s=10)
    board.ask("robot-1", 2, waits_s=5)
    board.ask("robot-1", 3)
    board.ask("robot-1", 4)
    assert board.names == ["robot-1"]
    assert (board.count("expired_total"), board.count("answered_total")) == (1, 0)


@pytest.mark.parametrize("kind", [Kind.OVERRIDE, Kind.APPROVE, Kind.RELEASE, Kind.PASS])
def test_any_word_that_took_force_answers(kind: Kind) -> None:
    board = Board()
    board.ask("robot-1", 10, waits_s=5)
    board.answer(20, kind)
    assert board.names == []
    board.calls.tell("robot-1", None, 21)
    assert (board.count("answered_total"), board.count("expired_total")) == (1, 0)


def test_a_heartbeat_that_overtook_the_receipt_takes_nothing_from_who_answered() -> None:
    board = Board()
    board.ask("robot-1", 10)
    board.calls.tell("robot-1", None, 21)
    board.answer(20)
    assert board.count("answered_total") == 1


def test_what_was_taken_back_refused_or_only_paused_is_not_answered() -> None:
    board = Board()
    board.ask("robot-1", 10)
    board.answer(20, reason="no")
    board.answer(20, Kind.PAUSE)
    assert board.names == ["robot-1"]
    board.calls.tell("robot-1", None, 30)
    board.answer(40)
    assert board.count("answered_total") == 0


def test_beyond_the_budget_of_the_fleet_calls_are_counted_and_not_shown() -> None:
    board = Board(per_hour=2)
    for at, robot in enumerate(("a", "b", "c")):
        board.ask(robot, 1, at=at)
        board.ask(robot, 2, at=at)  # The same call again costs nothing.
    assert board.names == ["a", "b"]
    assert board.calls.suppressed() == 1
    assert (board.count("asked_total"), board.count("suppressed_total")) == (3, 1)
    board.clock.advance(HOUR_NS)
    board.ask("c", 3, at=7)
    assert board.names == ["a", "b", "c"]
    assert board.calls.suppressed() == 0


def test_a_call_beyond_the_budget_is_shown_as_soon_as_there_is_room_while_it_still_asks() -> None:
    board = Board(per_hour=1)
    board.ask("a", 1)
    board.ask("b", 1)
    board.ask("c", 1)
    board.calls.tell("c", None, 2)
    board.clock.advance(HOUR_NS)
    for robot in ("c", "b"):
        board.ask(robot, 3)
    assert set(board.names) == {"a", "b"}
    assert board.calls.suppressed() == 0


def test_the_queue_has_changed_only_when_there_is_something_to_see() -> None:
    board = Board()
    board.calls.tell("robot-1", None, 1)
    board.ask("robot-1", 2, waits_s=10)
    board.ask("robot-1", 3, waits_s=9)
    assert board.changes == 1
    board.ask("robot-1", 4, doubt=0.7, waits_s=8)
    board.ask("robot-1", 5, doubt=0.7)
    board.calls.tell("robot-1", None, 6)
    board.calls.tell("robot-1", None, 7)
    assert board.changes == 4
