"""The recipe as stages, each kept in the output folder: what is there already is not done again.

practice-N → low-N for each round, then demonstrations, then high-N, which drive in between.
The seeds of a stage depend on the stage alone, so that a resumed run gives the same data as one
that never stopped.
"""

import hashlib
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

import torch

from services.learner.pretrain import cards, demonstrate, practice
from services.learner.pretrain.demonstrate import Demonstrations, Lesson
from services.learner.pretrain.high_fit import fit_high
from services.learner.pretrain.lexicon import exam
from services.learner.pretrain.low_fit import LowFitSettings, fit_low, measures
from services.learner.pretrain.practice import Steps, practise
from services.learner.pretrain.reader_fit import ReaderFitSettings, fit_reader
from services.learner.pretrain.replay import choose
from services.learner.pretrain.scale import LowRound, Scale
from shared.goals.language.bank import PhraseBank
from shared.policies import checkpoint, examples
from shared.policies.fitter import FitSettings
from shared.policies.geometry import Geometry
from shared.policies.high_level import BASE_VERSION, HighLevel
from shared.policies.high_net import HighLevelNet
from shared.policies.low_level import LowLevel, build
from shared.policies.low_net import LowNet
from shared.policies.reader.reader import Reader
from shared.seeds import DEMONSTRATION
from shared.workcell.skills import COMMANDS

PARTS = 16
"""Pieces of a stage that processes share; their number decides the seeds, so it is fixed."""
VALIDATION_SEED = DEMONSTRATION.stop - 100_000_000
DRIVEN_SEED = DEMONSTRATION.stop - 200_000_000
EXAM_SEED = DEMONSTRATION.stop - 50_000_000


class Reporter(Protocol):
    """Where the progress of a stage is told."""

    def stage(self, name: str, total: int) -> Callable[[int], None]:
        """Begin a stage; the answer is to be told how much of `total` is done."""
        ...


R = TypeVar("R")


@dataclass(frozen=True)
class Pretraining:
    """One run of the recipe. out: where its stages are kept."""

    out: Path
    scale: Scale
    seed: int
    pool: Executor
    reporter: Reporter

    def low_level(self) -> Path:
        """Practice and fit, round after round; the last round's folder."""
        parts: list[Steps] = []
        folder: Path | None = None
        for number, round_ in enumerate(self.scale.low):
            parts.append(self._practice(number, round_, folder))
            folder = self._fit_low(number, parts, folder)
        assert folder is not None  # A scale has at least one round.
        return folder

    def _practice(self, number: int, round_: LowRound, folder: Path | None) -> Steps:
        file = self.out / f"practice-{number}.safetensors"
        if not file.exists():
            seeds = [self.seed * 1_000_000 + number * 1_000 + part for part in range(PARTS)]
            steps = round_.practice // PARTS
            jobs = [(seed, steps, folder, round_.filling) for seed in seeds]
            done = self.share(f"practice {number}", practise, jobs)
            _write(file, practice.join(done).save)
        return Steps.load(file)

    def _fit_low(self, number: int, parts: Sequence[Steps], before: Path | None) -> Path:
        folder = self.out / f"low-{number}"
        if not (folder / checkpoint.CARD_FILE).exists():
            round_ = self.scale.low[number]
            settings = LowFitSettings(steps=round_.updates, lr=round_.lr, seed=self.seed)
            tell = self.reporter.stage(f"low level {number}", round_.updates)
            net = build(checkpoint.load(before)[0]) if before else self._fresh_low()
            net = fit_low(net, practice.join(parts), settings, _told(tell))
            low_level = LowLevel(net, self._reader(before))
            tell(round_.updates)
            data = (self.out / f"practice-{row}.safetensors" for row in range(number + 1))
            card = cards.low_level(self.scale, self.seed, _sha256(data))
            _write(folder, lambda path: checkpoint.save(path, low_level.tensors(), card))
        return folder

    def _reader(self, before: Path | None) -> Reader:
        """Practice teaches a reader nothing: that of the round before is the one."""
        if before:
            return LowLevel.load(before).reader
        settings = ReaderFitSettings(phrases=self.scale.phrases, seed=self.seed)
        return fit_reader(exam()[0], settings)

    def _fresh_low(self) -> LowNet:
        torch.manual_seed(self.seed)
        return LowNet(Geometry(measures()))

    def demonstrations(self, low_level: Path) -> Demonstrations:
        """Episodes by the expert's hand, then by the low level's."""
        first, learned = self.seed * 1_000_000, self.scale.expert_episodes
        parts = [
            self._demonstrate("expert", first, self.scale.expert_episodes, None),
            self._demonstrate("learned", first + learned, self.scale.learned_episodes, low_level),
        ]
        return demonstrate.join(parts)

    def validation(self, low_level: Path) -> Demonstrations:
        """Episodes that nothing is trained on."""
        episodes = self.scale.validation_episodes
        return self._demonstrate("validation", VALIDATION_SEED, episodes, low_level)

    def _demonstrate(
        self, name: str, first: int, count: int, hand: Path | None, driver: Path | None = None
    ) -> Demonstrations:
        file = self.out / f"demonstrations-{name}.safetensors"
        if not file.exists():
            seeds = range(first, first + count)
            pieces = [tuple(seeds[part::PARTS]) for part in range(min(PARTS, count))]
            scale = self.scale
            mistakes = scale.learned_mistakes if hand else scale.expert_mistakes
            jobs = [(Lesson(piece, hand, mistakes, driver),) for piece in pieces]
            done = self.share(f"demonstrations {name}", demonstrate.demonstrate, jobs)
            _write(file, demonstrate.join(done).save)
        return Demonstrations.load(file)

    def high_level(self, lessons: Demonstrations, low_level: Path) -> Path:
        """The base of the high level: fit, let it drive, fit again; the last round's folder."""
        parts, folder = [lessons], None
        for number, round_ in enumerate(self.scale.high):
            if round_.driven and folder:
                first = DRIVEN_SEED + self.seed * 1_000_000 + number * 10_000
                name = f"driven-{number}"
                parts.append(self._demonstrate(name, first, round_.driven, low_level, folder))
            folder = self._fit_high(number, parts, folder)
        assert folder is not None  # A scale has at least one round.
        return folder

    def _fit_high(self, number: int, parts: list[Demonstrations], before: Path | None) -> Path:
        folder = self.out / f"high-{number}"
        if not (folder / checkpoint.CARD_FILE).exists():
            lessons = parts[0] if len(parts) == 1 else demonstrate.join(parts)
            scale, round_ = self.scale, self.scale.high[number]
            settings = FitSettings(
                steps=round_.updates, batch=scale.high_batch, lr=round_.lr, seed=self.seed
            )
            tell = self.reporter.stage(f"high level {number}", settings.steps)
            bank = PhraseBank.of(COMMANDS)
            net = HighLevel.load(before).net if before else self._fresh_high(lessons)
            kept = self.out / f"high-{number}-under-way.safetensors"
            fit_high(net, bank, lessons, settings, _told(tell), scale.prompts, kept)
            tell(settings.steps)
            policy = HighLevel(net, bank, BASE_VERSION)
            card = cards.high_level(scale, self.seed, self.data_sha256(), policy)
            _write(folder, lambda path: checkpoint.save(path, policy.tensors(), card))
            kept.unlink(missing_ok=True)
        return folder

    def _fresh_high(self, lessons: Demonstrations) -> HighLevelNet:
        torch.manual_seed(self.seed)
        net = HighLevelNet()
        net.learn_senses(torch.from_numpy(lessons.examples.senses))
        return net

    def replay(self, lessons: Demonstrations) -> Path:
        """The demonstrations that the learner's rounds are mixed with."""
        folder = self.out / "demonstrations"
        if not (folder / checkpoint.CARD_FILE).exists():
            kept = lessons.examples.take(choose(lessons, self.scale.replay, self.seed))
            card = cards.demonstrations(self.scale, self.seed, self.data_sha256())
            _write(folder, lambda path: examples.save(path, kept, card))
        return folder

    def data_sha256(self) -> str:
        """Hash over the demonstrations' files."""
        names = [
            "expert",
            "learned",
            *(f"driven-{number}" for number in range(len(self.scale.high))),
        ]
        files = (self.out / f"demonstrations-{name}.safetensors" for name in names)
        return _sha256(file for file in files if file.exists())

    def share(
        self, name: str, work: Callable[..., R], jobs: Sequence[tuple[object, ...]]
    ) -> list[R]:
        """Let the pool do the jobs; results in the order of the jobs."""
        tell = self.reporter.stage(name, len(jobs))
        futures = [self.pool.submit(work, *job) for job in jobs]
        for count, _ in enumerate(as_completed(futures), 1):
            tell(count)
        return [future.result() for future in futures]


def _told(tell: Callable[[int], None]) -> Callable[[int, int, float], bool]:
    def progress(step: int, steps: int, loss: float) -> bool:
        del steps, loss  # Unused: the reporter knows the one, and nobody asks for the other.
        tell(step)
        return True

    return progress


def _write(target: Path, write: Callable[[Path], None]) -> None:
    """Write beside the target and move it there whole, so that no stage is ever half there."""
    beside = target.with_name(f"unfinished-{target.name}")
    if beside.is_dir():
        shutil.rmtree(beside)
    write(beside)
    beside.rename(target)


def _sha256(files: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        with file.open("rb") as stream:
            for block in _blocks(stream.read):
                digest.update(block)
    return digest.hexdigest()


def _blocks(read: Callable[[int], bytes]) -> Iterator[bytes]:
    while block := read(1 << 22):
        yield block
