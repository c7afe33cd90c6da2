"""The tasks of the cell by name; a new one is a folder beside these and a line here."""

from shared.workcell.errors import UnknownPrompt, UnknownTask
from shared.workcell.tasks.bus.task import Bus
from shared.workcell.tasks.pack.task import Pack
from shared.workcell.tasks.sandwich.task import Sandwich
from shared.workcell.tasks.task import Brief, Draw, Task

__all__ = ["TASKS", "Brief", "Draw", "Task", "task_named", "understand"]

TASKS: dict[str, Task] = {task.name: task for task in (Sandwich(), Pack(), Bus())}


def task_named(name: str) -> Task:
    """The task of this name.

    Raises:
        UnknownTask: there is none; the message names those that there are.
    """
    if name not in TASKS:
        raise UnknownTask(name, TASKS)
    return TASKS[name]


def understand(prompt: str) -> Brief:
    """What a prompt asks for, whichever task it belongs to.

    Raises:
        UnknownPrompt: no task understands it; the message says how prompts read.
    """
    complaints = []
    for task in TASKS.values():
        try:
            return task.understand(prompt)
        except UnknownPrompt as error:
            complaints.append(str(error))
    raise UnknownPrompt("; or ".join(dict.fromkeys(complaints)))
