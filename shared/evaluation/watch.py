"""Watches an episode: each attempt at a skill, each decision, and what went wrong first."""

from collections.abc import Callable, Set

from shared.evaluation.attempts import Attempt, skill_name, skill_of
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import OBJECT_NAMES
from shared.workcell.skills import ATTEMPT_STEPS, Skill, achieved, parse
from shared.workcell.state import CellState, held_object

OUT_OF_TIME = "out of time"
CHANGED_ITS_MIND = "changed its mind"


class Watch:
    """The eyes of one episode; told of decisions as they are taken and of every control step.

    wrong: decisions that put in force, or kept there, what was not right.
    failure, failed_step: what went wrong first; "" and -1 when nothing did.
    """

    def __init__(self, env: WorkcellEnv, meant: Callable[[str], Skill | None] = skill_of) -> None:
        """meant: the skill that a command stands for, in whatever words."""
        self._env, self._meant = env, meant
        self._now = self._before = env.state
        self._command: str | None = None
        self._skill: Skill | None = None
        self._begin = 0
        self._achieved_after = 0  # Steps; 0: not yet.
        self._wrong = self._wrong_now = 0  # Decisions: of this attempt, and just now.
        self._attempts: list[Attempt] = []
        self.wrong, self.failure, self.failed_step = 0, "", -1

    def decided(self, command: str) -> None:
        """A decision puts a command in force: hold it against what is right at this moment."""
        state, said = self._env.state, self._meant(command)
        previous = self._command
        fine = self._env.task.acceptable_commands(state, self._env.brief, previous)
        if said is None or said.text not in fine:
            self.wrong += 1
            self._wrong_now = 1
            self._blame(mistake(said, fine, state), self._env.elapsed_steps)
        elif previous in fine and previous != command and not self._achieved_after:
            self._blame(CHANGED_ITS_MIND, self._env.elapsed_steps)

    def stepped(self, command: str, step: int) -> None:
        """A control step was made under `command`; `step` of them in all."""
        if command != self._command:
            self._close(step - 1)
            self._command, self._skill = command, self._meant(command)
            self._begin, self._before = step - 1, self._now
            self._achieved_after = self._wrong = 0
        self._wrong, self._wrong_now = self._wrong + self._wrong_now, 0
        self._now = self._env.state
        open_ = self._skill if not self._achieved_after else None
        if open_ and achieved(open_, self._before, self._now):
            self._achieved_after = step - self._begin

    def finish(self, step: int, success: bool) -> tuple[Attempt, ...]:
        """The episode is over; all attempts in it."""
        # An attempt that the end cuts off sooner counts only if it was achieved.
        if self._achieved_after or step - self._begin >= ATTEMPT_STEPS:
            self._close(step)
        if success:
            self.failure, self.failed_step = "", -1
        else:
            self._blame(OUT_OF_TIME, step)
        return tuple(self._attempts)

    def _close(self, step: int) -> None:
        if self._command is None:
            return
        name, done = skill_name(self._skill), bool(self._achieved_after)
        steps = self._achieved_after or step - self._begin
        self._attempts.append(
            Attempt(
                command=self._command,
                skill=name,
                success=done,
                begin=self._begin,
                steps=steps,
                wrong=self._wrong,
            )
        )
        if name and not done:
            self._blame(f"{name} failed", step)

    def _blame(self, failure: str, step: int) -> None:
        if not self.failure:
            self.failure, self.failed_step = failure, step


def mistake(said: Skill | None, fine: Set[str], state: CellState) -> str:
    """What is wrong about saying this where `fine` is what would be right."""
    right = {parse(text).verb for text in fine}
    if said is None:
        return "unknown command"
    if right == {"wait"}:
        return "went on when done"
    if said.verb == "wait":
        return "waited"
    if said.verb == "pick":
        lifted = said.object in _held_names(state)
        return "put too late" if lifted and "pick" not in right else "wrong object"
    return "put too soon" if right == {"pick"} else "wrong place"


def _held_names(state: CellState) -> tuple[str, ...]:
    held = held_object(state)
    return () if held is None else (OBJECT_NAMES[held],)
