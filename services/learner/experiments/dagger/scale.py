"""How many episodes, rounds and training seeds; and the arms that are trained besides."""

from collections.abc import Callable
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from services.learner.config import Recipe, TrainSettings
from services.learner.experiments.bench import Scale
from services.learner.experiments.dagger.watching import Person
from services.learner.gate import GateSettings
from services.learner.labels.aggregate import LabelSettings
from services.learner.labels.balance import BalanceSettings
from shared.config import Settings

Count = Annotated[int, Field(ge=1)]
LAB = "lab"
MAIN = "corrected"
"""The person of the main course: speaks where something is wrong, at once, and says once, after an
episode that succeeded, that the rest was right. From the second round on every other episode is
left alone and gone through afterwards."""

PEOPLE: dict[str, Person] = {
    MAIN: Person(endorse=True, review_every=2),
    "not reviewing": Person(endorse=True),
    "not endorsing": Person(),
    "approving": Person(approve=True),
    "late 0.5 s": Person(endorse=True, review_every=2, delay_steps=25),
    "late 1.5 s": Person(endorse=True, review_every=2, delay_steps=75),
    "misses 20 %": Person(endorse=True, review_every=2, miss_rate=0.2),
    "wrong 10 %": Person(endorse=True, review_every=2, wrong_phrase_rate=0.1),
}
LATE = "late 1.5 s"


class Arm(NamedTuple):
    """A version that is trained from the base on what a course collected, or on something else.

    title: in reports. person: whose course. recipe: what is changed in it.
    data: corrections; shuffled: the same with their words exchanged among them; last: of the last
        round alone; overrides: without what an endorsement calls right; endorsements: that alone;
        lab, site: as many demonstrated decisions by the expert's hand instead.
    episodes: share of each round's episodes, the first ones.
    replayed: decisions demonstrated in the lab, replayed besides those that come with the project.
    """

    title: str
    person: str = MAIN
    recipe: Callable[[Recipe], Recipe] = lambda recipe: recipe
    data: Literal["corrections", "shuffled", "last", "overrides", "endorsements", "lab", "site"] = (
        "corrections"
    )
    episodes: float = 1.0
    replayed: int = 0

    def told(self, recipe: Recipe) -> dict[str, object]:
        """What it is trained by and on, as JSON values. recipe: of the rounds."""
        told = {**self._asdict(), "recipe": trained_by(self.recipe(recipe))}
        return {name: value for name, value in told.items() if name != "title"}


KEPT_ASIDE = {"held_out_share", "at_least", "retained"}


def trained_by(recipe: Recipe) -> dict[str, object]:
    """What weights hang on, as JSON values: what a gate would say of them is no part of it."""
    told = recipe.model_dump(mode="json", exclude={"gate"})
    return {**told, "gate": recipe.gate.model_dump(include=KEPT_ASIDE)}


def _share(share: float) -> Callable[[Recipe], Recipe]:
    """Another share by as many updates, so that the share alone is compared."""

    def changed(recipe: Recipe) -> Recipe:
        train = recipe.train
        epochs = train.epochs * share / train.correction_share
        update = {"correction_share": share, "epochs": epochs}
        return recipe.model_copy(update={"train": train.model_copy(update=update)})

    return changed


def _trained(**changes: object) -> Callable[[Recipe], Recipe]:
    return lambda recipe: recipe.model_copy(
        update={"train": recipe.train.model_copy(update=changes)}
    )


def _labels(**changes: object) -> Callable[[Recipe], Recipe]:
    return lambda recipe: recipe.model_copy(
        update={"labels": recipe.labels.model_copy(update=changes)}
    )


ARMS: dict[str, Arm] = {
    "together": Arm("all corrections at once, share .5"),
    "shuffled": Arm("shuffled corrections", data="shuffled"),
    "lab": Arm("as many demonstrations in the lab", data="lab"),
    "site": Arm("as many demonstrations here", data="site"),
    "last": Arm("last round only", data="last"),
    "overrides": Arm("what was said of mistakes alone", data="overrides"),
    "endorsements": Arm("endorsements alone", data="endorsements"),
    "share-0.1": Arm("share .1", recipe=_share(0.1)),
    "share-0.3": Arm("share .3", recipe=_share(0.3)),
    "share-0.8": Arm("share .8", recipe=_share(0.8)),
    "unanchored": Arm("weights not averaged with the base's", recipe=_trained(own_weights=1.0)),
    "as-fast": Arm("what is behind the eyes learns as fast", recipe=_trained(mind_rate=1.0)),
    "untoned": Arm("demonstrations replayed as they are", recipe=_trained(retoned=0.0)),
    "rehearsed": Arm("5,000 more demonstrations replayed", replayed=5000),
    "episodes-0.1": Arm("the first .1 of the episodes", episodes=0.1),
    "episodes-0.25": Arm("the first .25 of the episodes", episodes=0.25),
    "episodes-0.5": Arm("the first .5 of the episodes", episodes=0.5),
    "late-masked": Arm("late, window before masked", LATE),
    "late-relabelled": Arm("late, window before relabelled", LATE, _labels(before="relabel")),
    "late-untreated": Arm("late, window before kept", LATE, _labels(before="keep")),
}


class DaggerSettings(Settings):
    """episodes: of each round. seeds: of training.

    people, arms: by their names above. recipe: of every round.
    """

    episodes: Annotated[tuple[Count, ...], Field(min_length=1)]
    seeds: Count
    people: tuple[str, ...]
    arms: tuple[str, ...]
    recipe: Recipe = Recipe(
        labels=LabelSettings(),
        balance=BalanceSettings(),
        # Each of the pool's processes has a core.
        train=TrainSettings(threads=1),
        gate=GateSettings(held_out_share=0.0),
    )

    @property
    def rounds(self) -> int:
        """Of each course."""
        return len(self.episodes)

    @property
    def arms_of_people(self) -> list[str]:
        """The arms whose person is here."""
        return [name for name in self.arms if ARMS[name].person in self.people]

    def places(self, number: int) -> range:
        """Of the episodes of a round, counted from 1, among all of a course."""
        first = sum(self.episodes[: number - 1])
        return range(first, first + self.episodes[number - 1])

    def tried(self, person: str) -> range:
        """Rounds after which a version is tried: each of the main person's, the last of others'."""
        return range(1 if person == MAIN else self.rounds, self.rounds + 1)


SMALL = DaggerSettings(
    episodes=(20, 20, 20), seeds=1, people=(MAIN,), arms=("together", "shuffled", "lab", "site")
)
CORE = DaggerSettings(
    episodes=(40, 80, 80),
    seeds=3,
    people=(MAIN,),
    arms=("together", "shuffled", "last", "overrides", "endorsements", "lab", "site"),
)
FULL = DaggerSettings(
    episodes=(40, 80, 80),
    seeds=3,
    people=(
        MAIN,
        "not reviewing",
        "not endorsing",
        "late 0.5 s",
        LATE,
        "misses 20 %",
        "wrong 10 %",
    ),
    arms=tuple(ARMS),
)
SCALES = {Scale.SMALL: SMALL, Scale.CORE: CORE, Scale.FULL: FULL}
