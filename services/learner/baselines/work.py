"""The work in pieces that processes share: parts of the demonstrations, slices of the fits.

What is done lies in the run's folder, under names that hang on the settings, and isn't done again.
"""

import hashlib
import time
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import torch
from pydantic import BaseModel, ConfigDict

from services.learner.baselines import data
from services.learner.baselines.data import Teaching
from services.learner.baselines.fit import ArmFit, Fitted
from services.learner.baselines.net import Pair
from services.learner.baselines.scale import ARMS, TITLES, Arm, BaselineSettings
from services.learner.pretrain.cards import today
from services.learner.pretrain.low_fit import measures
from services.learner.pretrain.meanings import Prompts
from shared.config import Settings
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.checkpoint import Card
from shared.policies.geometry import Geometry
from shared.policies.low_level import as_tensors
from shared.seeds import DEMONSTRATION
from shared.workcell.skills import COMMANDS

FIRST_SEED = DEMONSTRATION.stop - 300_000_000
"""Scenes of the demonstrations; apart from those of the recipe of the checkpoints."""


class Plan(Settings):
    """Where what is made lies, and how it is made."""

    out: Path
    settings: BaselineSettings

    def part(self, number: int) -> Path:
        """Folder of a part of the demonstrations."""
        return self.out / f"demonstrations-{_short(self.settings.data)}" / f"part-{number:02d}"

    def parts(self) -> list[Path]:
        """All of them."""
        return [self.part(number) for number in range(self.settings.data.parts)]

    def arm(self, arm: Arm, seed: int) -> Path:
        """Folder of the checkpoint of an arm that was trained with a seed."""
        return self.out / f"fits-{self.note()}" / f"{arm}-{seed}"

    def kept(self, arm: Arm, seed: int) -> Path:
        """File of a fit under way."""
        return self.arm(arm, seed).with_suffix(".under-way.safetensors")

    def note(self) -> str:
        """What a fit hangs on, in short."""
        told = self.settings.model_copy(update={"lengths": (), "seeds": 1, "max_steps": None})
        return _short(told)

    def slices(self) -> Iterator[list["Slice"]]:
        """Slices of all fits, one round after another; those of a round wait for no other.

        One training seed is done before the next one begins, so that there is something to look at.
        """
        steps, each = self.settings.fit.steps, self.settings.slice
        for seed in range(self.settings.seeds):
            for until in (*range(each, steps, each), steps):
                yield [Slice(arm, seed, until) for arm in ARMS]


def _short(settings: Settings) -> str:
    return hashlib.sha256(settings.model_dump_json().encode()).hexdigest()[:8]


class Part(BaseModel):
    """A part of the demonstrations that is there. cpu_s: what it took, 0 if it had been made."""

    number: int
    cpu_s: float


class Shower:
    """Makes parts of the demonstrations."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def __call__(self, number: int) -> Part:
        folder, settings = self._plan.part(number), self._plan.settings.data
        began = time.process_time()
        if not folder.exists():
            first = FIRST_SEED + settings.seed * 1_000_000
            seeds = range(first, first + settings.episodes)[number :: settings.parts]
            data.teach(seeds, settings.mistakes, settings.slips).save(folder)
        return Part(number=number, cpu_s=time.process_time() - began)

    def close(self) -> None:
        """Nothing is held."""


class Slice(NamedTuple):
    """Updates of a fit, from where it is up to `until`."""

    arm: Arm
    seed: int
    until: int


class Trained(BaseModel):
    """What a slice came to. moved, goal, agreement: see `Fitted`. parameters: that learn."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    arm: Arm
    seed: int
    until: int
    updates: int
    parameters: int
    cpu_s: float
    moved: float
    goal: float
    agreement: float
    data_sha256: str

    @property
    def slice(self) -> Slice:
        return Slice(self.arm, self.seed, self.until)


class Trainer:
    """Trains slices, on the demonstrations that are there."""

    def __init__(self, plan: Plan) -> None:
        torch.set_num_threads(1)  # The processes share the cores.
        self._plan, self._settings = plan, plan.settings
        self._bank = PhraseBank.of(COMMANDS)

    @cached_property
    def _teaching(self) -> Teaching:
        return data.join([Teaching.load(folder) for folder in self._plan.parts()])

    @cached_property
    def _sha256(self) -> str:
        return self._teaching.sha256()

    @cached_property
    def _prompts(self) -> Prompts:
        settings = self._settings.data
        return Prompts(settings.prompts, settings.seed, shared_encoder())

    def __call__(self, job: Slice) -> Trained:
        folder = self._plan.arm(job.arm, job.seed)
        folder.parent.mkdir(parents=True, exist_ok=True)
        fit = self._begun(job)
        began, before = time.process_time(), fit.done
        said = fit.run(job.until)
        took = time.process_time() - began
        if job.until == self._settings.fit.steps:
            fit.finish()
            checkpoint.save(folder, as_tensors(fit.pair), self._card(job))
        return self._row(job, fit.done - before, fit.pair.learned(), took, said)

    def _begun(self, job: Slice) -> ArmFit:
        kept = self._plan.kept(job.arm, job.seed)
        settings = self._settings.fit.model_copy(update={"seed": job.seed})
        pair = fresh(job.arm, job.seed, self._teaching)
        rows = self._settings.rows
        return ArmFit(pair, self._bank, self._teaching, settings, rows, self._prompts, kept)

    def _row(
        self, job: Slice, updates: int, parameters: int, cpu_s: float, said: Fitted
    ) -> Trained:
        return Trained(
            **job._asdict(),
            updates=updates,
            parameters=parameters,
            cpu_s=cpu_s,
            **said._asdict(),
            data_sha256=self._sha256,
        )

    def _card(self, job: Slice) -> Card:
        settings = self._settings
        return Card(
            name=f"baseline-{job.arm}",
            title=f"Baseline: {TITLES[job.arm]}",
            version="1",
            date=today(),
            recipe=(
                f"{settings.data.episodes} episodes of the scripted expert in the lab, the same "
                "ones for every arm.",
                f"{settings.fit.steps:,} updates of {settings.fit.batch} looks and {settings.rows} "
                "rows of the low level's for each.",
            ),
            command="hld experiment baselines --out DIR",
            seed=job.seed,
            data_sha256=self._sha256,
            tensors_sha256="",
            settings={"arm": job.arm},
        )

    def close(self) -> None:
        """Nothing is held but memory."""


def fresh(arm: Arm, seed: int, teaching: Teaching) -> Pair:
    """An arm before its first update; of one seed all arms have the same trunk and mover."""
    torch.manual_seed(seed)
    pair = Pair(arm, Geometry(measures()))
    pair.trunk.learn_senses(torch.from_numpy(teaching.decisions.seen.examples.senses))
    return pair
