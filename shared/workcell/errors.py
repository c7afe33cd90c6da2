"""What can go wrong in the workcell, each error naming the valid alternatives.

WorkcellError (shared.errors)
├── UnknownCommand      the words are no command of this cell
├── UnknownPrompt       the words ask for no task of this cell
├── UnknownTask         no task has this name
├── InvalidLength       a task can't take so many skills
├── InvalidSite         a site file is missing, or says something a site cannot say
├── InvalidAction       an action has the wrong shape, or is not finite
└── InvalidState        arrays that are no state of this cell
"""

from collections.abc import Iterable

from shared.errors import WorkcellError, nearest


class UnknownCommand(WorkcellError):
    """The words are no command of this cell."""

    def __init__(self, text: str, commands: Iterable[str]) -> None:
        super().__init__(f"unknown command {text!r}{nearest(text, commands)}")


class UnknownPrompt(WorkcellError):
    """The words ask for no task of this cell."""


class UnknownTask(WorkcellError):
    """No task has this name."""

    def __init__(self, name: str, tasks: Iterable[str]) -> None:
        super().__init__(f"unknown task {name!r}; the tasks are {', '.join(tasks)}")


class InvalidLength(WorkcellError):
    """A task can't take so many skills."""


class InvalidSite(WorkcellError):
    """A site file is missing, or says something a site cannot say."""


class InvalidAction(WorkcellError):
    """An action has the wrong shape, or is not finite."""


class InvalidState(WorkcellError):
    """Arrays that are no state of this cell."""
