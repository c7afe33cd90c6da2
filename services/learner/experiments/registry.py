"""The experiments by name; a new one is a module beside these and a line here."""

from collections.abc import Callable
from typing import NamedTuple

from services.learner.experiments import (
    baselines,
    dagger,
    horizon,
    language,
    skills,
    transitions,
)
from services.learner.experiments.bench import Bench
from services.learner.experiments.findings import Findings
from shared.errors import ConfigError, nearest


class Experiment(NamedTuple):
    """small, full: scenes for each cell of its tables, at either scale.
    learned: whether it tries a learned high level that is given to it. site: where, unless told.
    """

    run: Callable[[Bench], Findings]
    small: int
    full: int
    learned: bool = False
    site: str = "lab"


EXPERIMENTS = {
    "skills": Experiment(skills.run, small=2, full=100),
    "language": Experiment(language.run, small=2, full=100),
    "horizon": Experiment(horizon.run, small=1, full=60, learned=True),
    "baselines": Experiment(baselines.run, small=6, full=40),
    "dagger": Experiment(dagger.run, small=60, full=200, learned=True, site="far"),
    "transitions": Experiment(transitions.run, small=1, full=120, learned=True),
}


def experiment_named(name: str) -> Experiment:
    """The experiment of this name.

    Raises:
        ConfigError: there is none; the message names those that there are.
    """
    if name not in EXPERIMENTS:
        raise ConfigError(
            f"no experiment {name!r}{nearest(name, EXPERIMENTS)} of {', '.join(EXPERIMENTS)}"
        )
    return EXPERIMENTS[name]
