"""Is the thing on the left taken, and not the one on the right? Both sides in the same forms."""

from typing import Any, NamedTuple

from services.learner.experiments.bench import Bench
from shared.evaluation.phrase import Said, Trial
from shared.evaluation.scene import Setting, prepare
from shared.intervals import rate
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import KINDS, OBJECTS, index
from shared.workcell.skills import pick
from shared.workcell.state import CellState

FORMS = (
    "take the {name} on the {side}",
    "the {side} {name}",
    "the {name} that is not on the {other}",
    "not the {other} {name}, the {side} one",
)
BEFORE = ("", "no, ")
SIDES = ("left", "right")
MOST_SCENES = 6
"""Of 16 phrases each."""
APART_M = 0.05
TASKS = ("bus", "sandwich")
_RED, _WHITE, _BLUE = (
    tuple(item.name for item in OBJECTS if item.colour == colour and item.kind != "food")
    for colour in ("red", "white", "blue")
)
_NAMES = {
    "dish": KINDS["dish"],
    "piece of rubbish": KINDS["rubbish"],
    "red one": _RED,
    "white one": _WHITE,
    "blue one": _BLUE,
    "vegetable": ("lettuce", "tomato", "onion"),
}
"""Names of several things: kinds and colours."""


class Pair(NamedTuple):
    """Two things of a scene that a name fits. things: their names, the left one first."""

    setting: Setting
    name: str
    things: tuple[str, str]

    def trials(self) -> dict[Trial, "Told"]:
        """What is said of them, in each form for each side, with and without "no"."""
        trials = {}
        for form in (before + form for form in FORMS for before in BEFORE):
            for side, other, thing in zip(SIDES, SIDES[::-1], self.things, strict=True):
                phrase = form.format(name=self.name, side=side, other=other)
                trial = Trial(setting=self.setting, phrase=phrase, expected=_take(thing))
                opposite = self.things[self.things[0] == thing]
                trials[trial] = Told(form, side, _take(opposite))
        return trials


class Told(NamedTuple):
    """How a thing was told by its side. opposite: the command to take the other one."""

    form: str
    side: str
    opposite: str


def pairs(bench: Bench) -> list[Pair]:
    """One pair a scene, of the bench's first scenes that have one."""
    env = WorkcellEnv(bench.site)
    found: list[Pair] = []
    try:
        for number in range(bench.n):
            setting = Setting(seed=bench.seed(number), task=TASKS[number % len(TASKS)])
            prepare(env, setting)
            names = list(_NAMES)[number % len(_NAMES) :] + list(_NAMES)[: number % len(_NAMES)]
            things = ((name, two_of(env.state, _NAMES[name])) for name in names)
            told = next(((name, two) for name, two in things if two), None)
            if told and len(found) < MOST_SCENES:
                found.append(Pair(setting, *told))
    finally:
        env.close()
    return found


def two_of(state: CellState, names: tuple[str, ...]) -> tuple[str, str] | None:
    """Of these things the left and the right one, if there are two, clearly apart."""
    there = [name for name in names if state.present[index(name)]]
    there.sort(key=lambda name: state.points[index(name)][0])
    if len(there) != len(SIDES):
        return None
    left, right = (state.points[index(name)][0] for name in there)
    return (there[0], there[1]) if right - left > APART_M else None


def figures(bench: Bench) -> dict[str, Any]:
    """How often what was meant was taken: all, by side, by form; and how often its opposite."""
    told = {trial: one for pair in pairs(bench) for trial, one in pair.trials().items()}
    said = bench.phrases("sides", list(told))
    by = {
        part: {
            name: _rates([one for one in said if getattr(told[one.trial], part) == name])
            for name in dict.fromkeys(getattr(one, part) for one in told.values())
        }
        for part in ("side", "form")
    }
    return {
        **_rates(said),
        "sides": by["side"],
        "forms": by["form"],
        "opposite": rate([told[one.trial].opposite in one.done for one in said]),
    }


def _rates(said: list[Said]) -> dict[str, Any]:
    return {
        **rate([one.success for one in said]),
        "refused": rate([bool(one.refused) for one in said]),
    }


def _take(name: str) -> str:
    return pick(index(name))
