"""Tasks that sort things into bin and tub: the named or fitting ones go in, all others stay out."""

from shared.workcell import skills
from shared.workcell.objects import BIN, TUB, index
from shared.workcell.state import CellState, held_object, inside
from shared.workcell.tasks.task import Brief, put_commands, uncovered

_PUTS = {BIN: skills.PUT_IN_BIN, TUB: skills.PUT_IN_TUB}


class Sorting:
    """Judges states and knows the next command; a task says which thing goes where."""

    def home(self, item: int) -> int:
        """The row of the container that an object goes to if it is wished."""
        raise NotImplementedError

    def success(self, state: CellState, brief: Brief) -> bool:
        """Each wished thing lies in its container, and nothing else lies in one."""
        return bool(brief.target) and not self._wrong(state, brief) and not self._open(state, brief)

    def progress(self, state: CellState, brief: Brief) -> float:
        """Share of the wished things in place, less the wrong ones."""
        if not brief.target:
            return 0.0
        done = len(brief.target) - len(self._open(state, brief))
        return max(0.0, (done - len(self._wrong(state, brief))) / len(brief.target))

    def next_command(self, state: CellState, brief: Brief, previous: str | None) -> str:
        """The right command now: the one in force if it is right, else the wish's order."""
        return self._commands(state, brief, previous)[0]

    def acceptable_commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> frozenset[str]:
        """All commands that are right now."""
        return self._commands(state, brief, previous)[1]

    def _commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> tuple[str, frozenset[str]]:
        wish, held = _rows(brief), held_object(state)
        if held is not None:
            put = _PUTS[self.home(held)] if held in wish else skills.PUT_DOWN
            return put_commands(state, held, put, previous)
        todo = [*self._wrong(state, brief), *self._open(state, brief)]
        picks = [skills.pick(uncovered(state, item)) for item in todo] or [skills.WAIT]
        chosen = previous if previous in picks else picks[0]
        return chosen, frozenset(picks)

    def _wrong(self, state: CellState, brief: Brief) -> list[int]:
        """What lies in a container and doesn't belong there."""
        wish = frozenset(_rows(brief))
        return sorted(
            item
            for row in (BIN, TUB)
            for item in inside(state, row)
            if item not in wish or self.home(item) != row
        )

    def _open(self, state: CellState, brief: Brief) -> list[int]:
        """Wished things that lie in no container, in the wish's order; a wrong one counts once."""
        packed = inside(state, BIN) | inside(state, TUB)
        right = {item for item in packed if item in inside(state, self.home(item))}
        wrong = set(self._wrong(state, brief))
        return [item for item in _rows(brief) if item not in right and item not in wrong]


def _rows(brief: Brief) -> tuple[int, ...]:
    return tuple(index(name) for name in brief.target)
