"""Tasks that sort things into bin and tub: the named or fitting ones go in, all others stay out."""

from abc import abstractmethod

from shared.workcell import skills
from shared.workcell.objects import BIN, TUB, index
from shared.workcell.state import CellState, held_object, inside
from shared.workcell.tasks.task import Brief, Commanding, put_commands, uncovered

_PUTS = {BIN: skills.PUT_IN_BIN, TUB: skills.PUT_IN_TUB}


class Sorting(Commanding):
    """Judges states and knows the next command; a task says which thing goes where."""

    @abstractmethod
    def home(self, item: int) -> int:
        """The row of the container that an object goes to if it is wished."""

    def success(self, state: CellState, brief: Brief) -> bool:
        """Each wished thing lies in its container, and nothing else lies in one."""
        right, wrong = self._packed(state, brief)
        return bool(brief.target) and not wrong and len(right) == len(brief.target)

    def progress(self, state: CellState, brief: Brief) -> float:
        """Share of the wished things in place, less the wrong ones."""
        right, wrong = self._packed(state, brief)
        return max(0.0, (len(right) - len(wrong)) / len(brief.target)) if brief.target else 0.0

    def _right(self, state: CellState, brief: Brief, previous: str | None) -> list[str]:
        wish, held = _rows(brief), held_object(state)
        if held is not None:
            put = _PUTS[self.home(held)] if held in wish else skills.PUT_DOWN
            return put_commands(state, held, put, previous)
        right, wrong = self._packed(state, brief)
        todo = [*sorted(wrong), *(item for item in wish if item not in right | wrong)]
        return [skills.pick(uncovered(state, item)) for item in todo] or [skills.WAIT]

    def _packed(self, state: CellState, brief: Brief) -> tuple[set[int], set[int]]:
        """What lies in bin or tub: wished things in their own container, and all others."""
        wish, right, wrong = frozenset(_rows(brief)), set[int](), set[int]()
        for row in (BIN, TUB):
            for item in inside(state, row):
                (right if item in wish and self.home(item) == row else wrong).add(item)
        return right, wrong


def _rows(brief: Brief) -> tuple[int, ...]:
    return tuple(index(name) for name in brief.target)
