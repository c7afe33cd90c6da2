"""The experiments by name; a new one is a module beside these and a line here."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from services.learner.experiments import (
    baselines,
    dagger,
    horizon,
    language,
    replanning,
    skills,
    transitions,
)
from services.learner.experiments.bench import Bench, Scale
from services.learner.experiments.dagger.run import flat_arms
from services.learner.experiments.findings import Findings
from shared.errors import ConfigError, nearest


class Experiment(NamedTuple):
    """small, full: scenes for each cell of its tables, at either scale.
    learned: whether it tries a learned high level that is given to it. low_level: whether it tries
    a low level that is; else it trains its own. baselines: whether it tries an arm of a run of the
    baselines. core: whether it tells apart what matters most. site: where, unless told.
    """

    run: Callable[[Bench], Findings]
    small: int
    full: int
    learned: bool = False
    low_level: bool = True
    baselines: bool = False
    core: bool = False
    site: str = "lab"

    def scenes(self, scale: str) -> int:
        """How many there are for each cell.

        Raises:
            ConfigError: there is no such scale here; the message says which there are.
        """
        scales = [str(one) for one in Scale if one is not Scale.CORE or self.core]
        if scale not in scales:
            raise ConfigError(f"no scale {scale!r} here{nearest(scale, scales)}")
        return self.small if scale == Scale.SMALL else self.full

    def accept(self, high_level: str, low_level: str, baselines: Path | None = None) -> None:
        """Refuse a policy that would not be tried; "": none was named.

        baselines: folder of a run of the baselines, if one was named.
        Raises:
            ConfigError: one was named; the message says which experiments try one. Or no run of
                the baselines with a flat arm lies in the folder.
        """
        if high_level and not self.learned:
            raise ConfigError(f"--high-level has no effect here, only for {_names('learned')}")
        if low_level and not self.low_level:
            raise ConfigError(f"--low-level has no effect here, only for {_names('low_level')}")
        if baselines and not self.baselines:
            raise ConfigError(f"--baselines has no effect here, only for {_names('baselines')}")
        if baselines and not flat_arms(baselines):
            raise ConfigError(
                f"no flat arm in --baselines {baselines}: it takes the --out of "
                "`hld experiment baselines`, where fits-*/flat-* lie once they are trained"
            )


EXPERIMENTS = {
    "skills": Experiment(skills.run, small=2, full=100),
    "language": Experiment(language.run, small=2, full=100),
    "horizon": Experiment(horizon.run, small=1, full=60, learned=True),
    "baselines": Experiment(baselines.run, small=6, full=40, low_level=False, core=True),
    "dagger": Experiment(
        dagger.run, small=60, full=200, learned=True, baselines=True, core=True, site="far"
    ),
    "replanning": Experiment(replanning.run, small=1, full=60, learned=True),
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


def _names(trait: str) -> str:
    return ", ".join(name for name, one in EXPERIMENTS.items() if getattr(one, trait))
