"""What is to be evaluated: which policies, which tasks, which scenes; checked before it begins."""

import json
from pathlib import Path
from typing import Annotated, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from shared.config import Settings
from shared.errors import ConfigError, PolicyError
from shared.messages.policy import Version
from shared.policies.checkpoint import CARD_FILE, bundled, load_card
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout.settings import RolloutSettings
from shared.seeds import EVALUATION
from shared.workcell.site import load_site
from shared.workcell.tasks import TASKS, Draw, task_named

ORACLE, BASE = "oracle", "base"


class Case(NamedTuple):
    """One episode that is to be rolled out."""

    seed: int
    task: str


class Plan(Settings):
    """Episodes of a hierarchy without corrections.

    high_level: "base", "oracle" or a checkpoint folder; see `find_high_level`.
    tasks: taken in turn, one episode a seed.
    seeds: from A up to B, counted from the first evaluation seed, on which nobody ever trained.
    low_level: checkpoint folder; "": the one that comes with the project.
    skills: how many an episode's prompt takes; None: as many as its task likes.
    """

    high_level: str = BASE
    tasks: Annotated[tuple[str, ...], Field(min_length=1)] = tuple(TASKS)
    site: str = "far"
    seeds: tuple[int, int] = (0, 60)
    rollout: RolloutSettings = RolloutSettings()
    low_level: str = ""
    skills: int | None = None

    @model_validator(mode="after")
    def _in_range(self) -> Self:
        first, end = self.seeds
        if not 0 <= first < end <= len(EVALUATION):
            raise ValueError(f"seeds are A:B with 0 <= A < B <= {len(EVALUATION)}")
        return self

    def cases(self) -> list[Case]:
        """The same ones for every high level, so that high levels are compared in pairs."""
        return [
            Case(EVALUATION.start + offset, self.tasks[place % len(self.tasks)])
            for place, offset in enumerate(range(*self.seeds))
        ]

    def low_level_folder(self) -> Path:
        """Where the low level lies."""
        return Path(self.low_level) if self.low_level else bundled("low_level")

    def high_level_folder(self) -> Path:
        """Where the high level lies, unless it is the oracle."""
        return bundled("high_level") if self.high_level == BASE else Path(self.high_level)

    def note(self) -> str:
        """What its rows hang on, and with which other plans they can therefore be shared: all but
        how many seeds there are; policies and site by what they are, not by name or place."""
        told = self.model_dump(mode="json", exclude={"seeds", "high_level", "low_level"})
        told["site"] = load_site(self.site).model_dump(mode="json")
        told["low_level"] = load_card(self.low_level_folder()).tensors_sha256
        told["high_level"] = (
            ORACLE
            if self.high_level == ORACLE
            else load_card(self.high_level_folder()).tensors_sha256
        )
        return json.dumps(told, sort_keys=True)

    def check(self) -> None:
        """Find what can't work before any process is started.

        Raises:
            HldError: an unknown site or task, a checkpoint that can't be used; says what is known.
        """
        load_site(self.site)
        for task in self.tasks:
            task_named(task).sample(np.random.default_rng(0), Draw(skills=self.skills))
        self.check_policies()

    def check_policies(self) -> None:
        """The part of `check` that asks whether the checkpoints hold what is needed."""
        LowLevel.load(self.low_level_folder())
        if self.high_level != ORACLE:
            high_level = HighLevel.load(self.high_level_folder())
            high_level.check_memory(self.rollout.looks, self.rollout.history)


def parse_seeds(text: str) -> tuple[int, int]:
    """Read "A:B", the seeds from A up to B; "B" is short for "0:B".

    Raises:
        ConfigError: it is none, or there are no such seeds.
    """
    first, colon, end = text.partition(":")
    if not colon:
        first, end = "0", text
    if first.isdecimal() and end.isdecimal() and int(first) < int(end) <= len(EVALUATION):
        return int(first), int(end)
    raise ConfigError(
        f"--seeds takes A:B, such as 0:60 for the first 60 evaluation seeds, not {text!r}"
    )


def evaluation_seed(number: int) -> int:
    """The seed of an evaluation scene, counted from the first one as in `parse_seeds`.

    Raises:
        ConfigError: there is no such seed.
    """
    if 0 <= number < len(EVALUATION):
        return EVALUATION[number]
    raise ConfigError(
        f"--seed takes one of the evaluation seeds, 0 to {len(EVALUATION) - 1}, such as 3 for the "
        f"fourth scene of hld evaluate, not {number}"
    )


def find_high_level(name: str, data: Path) -> str:
    """What `Plan.high_level` takes, for a name as people say it.

    name: base, oracle, a version such as 1.2 that a learner keeps in `data`, or a folder.
    data: the folder of a run, of `hld up` or of a learner. A learner that took over announced the
    same weights anew as 2.2: the number tells them, whichever epoch they are asked for by.

    Raises:
        PolicyError: there is none; the message names those that there are.
    """
    if name in (BASE, ORACLE) or Path(name, CARD_FILE).is_file():
        return name
    kept = {
        Version.parse(card.parent.name): card.parent
        for shelf in (data / "learner" / "versions", data / "versions")
        for card in sorted(shelf.glob(f"*.*/{CARD_FILE}"))
    }
    try:
        wanted = Version.parse(name)
    except ValueError:
        wanted = None
    for version, folder in kept.items():
        if wanted and version.number == wanted.number and version.epoch <= wanted.epoch:
            return str(folder)
    there = ", ".join(str(version) for version in sorted(kept)) or "none"
    raise PolicyError(
        f"no high level {name!r}: say base, oracle, a checkpoint folder, or a version that is "
        f"kept in {data} ({there})"
    )
