"""What outcomes hang on: a note beside each, which says whether they still are those of a run."""

import json

from services.learner.experiments.bench import Bench
from services.learner.experiments.dagger.lessons import Teaching
from services.learner.experiments.dagger.scale import (
    ARMS,
    MAIN,
    PEOPLE,
    DaggerSettings,
    trained_by,
)


class Notes:
    """Those of one run at a bench."""

    def __init__(self, bench: Bench, settings: DaggerSettings) -> None:
        self._bench, self._settings = bench, settings

    def untrained(self, **more: object) -> str:
        """Of what nothing was trained for: robots, scenes, and who corrects live."""
        person = PEOPLE[MAIN].model_dump(mode="json", exclude={"review_every"})
        told = {"plan": self._plan(), "seeds": self._bench.seeds, "person": person}
        return _noted({**told, **more})

    def rounds(self, person: str, **more: object) -> str:
        """Of what came of a person's rounds."""
        return self.untrained(**self._gone_through(person), **more)

    def arm(self, name: str) -> str:
        """Of what came of an arm."""
        return self.rounds(ARMS[name].person, arm=ARMS[name].told(self._settings.recipe))

    def arms(self, teaching: Teaching) -> str:
        """Of the arms' training, but not on which of them: another scale goes on with it."""
        told = teaching.model_dump(mode="json", exclude={"settings"})
        recipe = trained_by(self._settings.recipe)
        return _noted({**told, "episodes": self._settings.episodes, "recipe": recipe})

    def course(self, person: str) -> str:
        """Of a person's course itself, which knows nothing of the scenes of evaluations."""
        return _noted({"plan": self._plan(), **self._gone_through(person)})

    def _plan(self) -> object:
        return json.loads(self._bench.plan(high_level=self._bench.high_level).note())

    def _gone_through(self, person: str) -> dict[str, object]:
        recipe = trained_by(self._settings.recipe)
        settings = {"episodes": self._settings.episodes, "recipe": recipe}
        return {"settings": settings, "watched": PEOPLE[person].model_dump(mode="json")}


def _noted(told: dict[str, object]) -> str:
    return json.dumps(told, sort_keys=True)
