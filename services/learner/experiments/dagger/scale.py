"""How many episodes, rounds and training seeds; and the arms that are trained besides."""

from collections.abc import Callable
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from services.learner.config import Recipe, TrainSettings
from services.learner.experiments.dagger.watching import Person
from services.learner.gate import GateSettings
from services.learner.labels.aggregate import LabelSettings
from services.learner.labels.balance import BalanceSettings
from shared.config import Settings

Count = Annotated[int, Field(ge=1)]
MAIN = "corrected"
"""The person of the main course: speaks where something is wrong, at once, and nowhere else."""

PEOPLE: dict[str, Person] = {
    MAIN: Person(),
    "approving": Person(approve=True),
    "late 0.5 s": Person(delay_steps=25),
    "late 1.5 s": Person(delay_steps=75),
    "misses 20 %": Person(miss_rate=0.2),
    "wrong 10 %": Person(wrong_phrase_rate=0.1),
}
LATE = "late 1.5 s"


class Arm(NamedTuple):
    """A version that is trained from the base on what a course collected, or on something else.

    title: in reports. person: whose course. recipe: what is changed in it.
    data: corrections; shuffled: the same with their words exchanged among them; last: of the last
        round alone; lab, site: as many demonstrated decisions by the expert's hand instead.
    episodes: share of each round's episodes, the first ones.
    """

    title: str
    person: str = MAIN
    recipe: Callable[[Recipe], Recipe] = lambda recipe: recipe
    data: Literal["corrections", "shuffled", "last", "lab", "site"] = "corrections"
    episodes: float = 1.0


def _share(share: float) -> Callable[[Recipe], Recipe]:
    return lambda recipe: recipe.model_copy(
        update={"train": recipe.train.model_copy(update={"correction_share": share})}
    )


def _labels(**changes: object) -> Callable[[Recipe], Recipe]:
    return lambda recipe: recipe.model_copy(
        update={"labels": recipe.labels.model_copy(update=changes)}
    )


ARMS: dict[str, Arm] = {
    "together": Arm("all corrections at once"),
    "shuffled": Arm("shuffled corrections", data="shuffled"),
    "lab": Arm("as many demonstrations in the lab", data="lab"),
    "site": Arm("as many demonstrations here", data="site"),
    "last": Arm("last round only", data="last"),
    "share-0.1": Arm("share .1", recipe=_share(0.1)),
    "share-0.3": Arm("share .3", recipe=_share(0.3)),
    "share-0.5": Arm("share .5", recipe=_share(0.5)),
    "episodes-0.1": Arm("the first .1 of the episodes", episodes=0.1),
    "episodes-0.25": Arm("the first .25 of the episodes", episodes=0.25),
    "episodes-0.5": Arm("the first .5 of the episodes", episodes=0.5),
    "late-masked": Arm("late, window before masked", LATE),
    "late-relabelled": Arm("late, window before relabelled", LATE, _labels(before="relabel")),
    "late-untreated": Arm("late, window before kept", LATE, _labels(before="keep")),
}


class DaggerSettings(Settings):
    """episodes: of a round. rounds: of each course. seeds: of training.

    people, arms: by their names above. recipe: of every round.
    """

    episodes: Count
    rounds: Count = 3
    seeds: Count
    people: tuple[str, ...]
    arms: tuple[str, ...]
    recipe: Recipe = Recipe(
        labels=LabelSettings(),
        balance=BalanceSettings(),
        train=TrainSettings(),
        gate=GateSettings(held_out_share=0.0),
    )


SMALL = DaggerSettings(
    episodes=20, seeds=1, people=(MAIN,), arms=("together", "shuffled", "lab", "site")
)
FULL = DaggerSettings(episodes=40, seeds=3, people=tuple(PEOPLE), arms=tuple(ARMS))
