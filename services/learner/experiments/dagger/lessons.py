"""What the pool trains: rounds of courses, and arms beside them; one after another, each once."""

import time
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict

from services.learner.anchor import anchor
from services.learner.experiments.dagger.course import Course, place_of, under_way
from services.learner.experiments.dagger.scale import ARMS, Arm, DaggerSettings
from services.learner.gate import Candidate
from services.learner.gather import open_version
from services.learner.labels.aggregate import Ground, Label
from services.learner.pretrain import demonstrate
from services.learner.pretrain.cards import today
from services.learner.store.store import Round
from services.learner.train import fine_tune, fit_settings
from shared.config import Settings
from shared.errors import PolicyError
from shared.policies import checkpoint, examples
from shared.policies.checkpoint import Card, bundled
from shared.policies.examples import Examples, join
from shared.policies.fit import fit
from shared.policies.high_level import HighLevel
from shared.seeds import DEMONSTRATION
from shared.workcell.env import WorkcellEnv
from shared.workcell.site import Site, load_site

FIRST_SEED = DEMONSTRATION.stop - 200_000_000
"""Scenes of the demonstrations; apart from those of the recipe and of the baselines."""
MOST_EPISODES = 1000


class Teaching(Settings):
    """out: folder of the courses. low_level_sha256: of the one that all run."""

    out: Path
    settings: DaggerSettings
    low_level_sha256: str
    site: str

    def folder(self, person: str, seed: int) -> Path:
        """Where the course of a person and a training seed is kept."""
        return self.out / f"{slug(person)}-{seed}"

    def course(self, person: str, seed: int) -> Course:
        """That course."""
        return Course(self.folder(person, seed), self.low_level_sha256, seed)

    def arm(self, name: str, seed: int) -> Path:
        """Folder of the checkpoint of an arm."""
        return self.out / "arms" / f"{name}-{seed}"


class Lesson(NamedTuple):
    """What is to be trained: a round of a person's course, or (round 0) an arm."""

    person: str
    seed: int
    round: int
    arm: str = ""


class Taught(BaseModel):
    """What came of it. labels: decisions that were learned from, besides demonstrations.

    corrections: how many said so; 0 for demonstrations.
    steps: control steps that somebody drove by hand for it; 0 for corrections.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    lesson: Lesson
    candidate: Candidate | None = None
    labels: int
    corrections: int = 0
    steps: int = 0
    cpu_s: float


class Teacher:
    """One process's demonstrations, ready for one lesson after another."""

    def __init__(self, teaching: Teaching) -> None:
        torch.set_num_threads(1)  # The processes share the cores.
        self._teaching = teaching

    @cached_property
    def _demonstrations(self) -> Examples:
        return examples.load(bundled("demonstrations"))

    def __call__(self, lesson: Lesson) -> Taught:
        """Train one."""
        began = time.process_time()
        course = self._teaching.course(lesson.person, lesson.seed)
        try:
            taught = self._arm(course, lesson) if lesson.arm else self._round(course, lesson)
        finally:
            course.close()
        return taught.model_copy(update={"cpu_s": round(time.process_time() - began, 1)})

    def _round(self, course: Course, lesson: Lesson) -> Taught:
        round_ = course.store.rounds()[lesson.round - 1]
        kept = under_way(course.folder, lesson.round)
        candidate = fine_tune(
            round_, course.store, course.files, self._demonstrations, _untold, kept
        )
        return Taught(lesson=lesson, candidate=candidate, labels=candidate.figures.labels, cpu_s=0)

    def _arm(self, course: Course, lesson: Lesson) -> Taught:
        arm, settings = ARMS[lesson.arm], self._teaching.settings
        recipe = arm.recipe(settings.recipe)
        last = course.store.rounds()[settings.rounds - 1]
        seed = lesson.seed * 1000 + 500
        round_ = last.model_copy(
            update={
                "parent": 0,
                "seed": seed,
                "manifest": last.manifest.model_copy(
                    update={"settings": recipe.model_dump(mode="json")}
                ),
            }
        )
        if arm.data in ("lab", "site"):
            return self._demonstrated(course, lesson, round_)
        chosen, replay = Treatment(arm, settings, lesson.seed), self._demonstrations
        if arm.replayed:
            more, _ = demonstrated(Site(name="lab"), arm.replayed, lesson.seed)
            replay = join([replay, more])
        candidate = fine_tune(round_, course.store, course.files, replay, _untold, treat=chosen)
        tensors = {ref.name: course.tensor(ref) for ref in candidate.tensors}
        settings_of = {**candidate.settings, "bank": "\n".join(candidate.bank)}
        self._save(lesson, tensors, settings_of)
        labels, learned = candidate.figures.labels, len(candidate.learned)
        return Taught(lesson=lesson, labels=labels, corrections=learned, cpu_s=0)

    def _demonstrated(self, course: Course, lesson: Lesson, round_: Round) -> Taught:
        """As many decisions as were corrected, shown by the expert's hand, in their place."""
        count = len(course.labels(self._teaching.settings.rounds))
        lab = ARMS[lesson.arm].data == "lab"
        site = Site(name="lab") if lab else load_site(self._teaching.site)
        shown, steps = demonstrated(site, count, lesson.seed)
        record = course.store.version(0)
        assert record is not None  # Every course begins with it.
        policy = open_version(record, course.files)
        train = self._teaching.settings.recipe.train
        fit(
            policy.net,
            policy.bank,
            self._demonstrations,
            shown,
            fit_settings(train, round_.seed, len(shown)),
        )
        anchor(policy.net, open_version(record, course.files).net, train.own_weights)
        policy = HighLevel(policy.net, policy.bank, policy.version)
        self._save(
            lesson, policy.tensors(), {**policy.settings(), "bank": "\n".join(policy.bank.phrases)}
        )
        return Taught(lesson=lesson, labels=len(shown), steps=steps, cpu_s=0)

    def _save(
        self, lesson: Lesson, tensors: checkpoint.Tensors, settings: dict[str, checkpoint.Setting]
    ) -> None:
        card = Card(
            name="high_level",
            title=f"Arm of an experiment: {ARMS[lesson.arm].title}",
            version="0.1",
            date=today(),
            recipe=(f"Training seed {lesson.seed}, from the base.",),
            command="hld experiment dagger",
            seed=lesson.seed,
            data_sha256="",
            tensors_sha256="",
            settings=settings,
        )
        checkpoint.save(self._teaching.arm(lesson.arm, lesson.seed), tensors, card)

    def close(self) -> None:
        """Nothing is held but memory."""


def demonstrated(site: Site, count: int, seed: int) -> tuple[Examples, int]:
    """So many decisions by the expert's hand at a site, and the control steps that it drove."""
    env = WorkcellEnv(site)
    record, steps = demonstrate.Record(), 0
    first = FIRST_SEED + seed * MOST_EPISODES
    lesson = demonstrate.Lesson(seeds=(), mistakes=0.0)
    for number in range(first, first + MOST_EPISODES):
        demonstrate.episode(env, number, lesson, record, drawn=site.name == "lab")
        steps += env.elapsed_steps
        if len(record.labels) >= count:
            break
    else:
        raise PolicyError(f"{MOST_EPISODES} episodes have less than {count} decisions")
    env.close()
    return record.done().examples.take(np.arange(count)), steps


class Treatment:
    """What an arm does to the labels that it learns from."""

    def __init__(self, arm: Arm, settings: DaggerSettings, seed: int) -> None:
        self._arm, self._settings, self._seed = arm, settings, seed

    def __call__(self, labels: Sequence[Label]) -> list[Label]:
        kept = [label for label in labels if self._wanted(label.episode) and self._heard(label)]
        if self._arm.data != "shuffled":
            return kept
        order = np.random.default_rng([self._seed, 1]).permutation(len(kept))
        texts = [kept[row].text for row in order]
        return [label._replace(text=text) for label, text in zip(kept, texts, strict=True)]

    def _heard(self, label: Label) -> bool:
        """Whether an arm learns from what was said so."""
        endorsed = label.ground is Ground.ENDORSED
        return {"overrides": not endorsed, "endorsements": endorsed}.get(self._arm.data, True)

    def _wanted(self, episode: str) -> bool:
        round_, number = place_of(episode)
        if self._arm.data == "last" and round_ != self._settings.rounds:
            return False
        return number < self._arm.episodes * self._settings.episodes[round_ - 1]


def slug(name: str) -> str:
    """A name as a part of a folder's."""
    return "".join(sign if sign.isalnum() else "-" for sign in name)


def _untold(share: float) -> None:
    del share  # Unused: a lesson is short.
