"""A course of rounds in one run folder: collect, label, train, and the next round with what came
of it; kept in a learner's store, so that what was done is not done again.
"""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from services.learner.build import STORE_FILE, origin
from services.learner.config import Recipe
from services.learner.experiments.dagger.watching import Person, Turn, Watched
from services.learner.gate import Candidate
from services.learner.labels.aggregate import Label, derive
from services.learner.rounds import next_manifest, take_stock
from services.learner.shelf import Shelf
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState
from services.learner.store.tensors import TensorFiles, unpack
from shared.messages.correction import AFTERWARDS, Correction, Kind
from shared.messages.episode import Episode
from shared.messages.policy import TensorRef
from shared.seeds import collection_seed

EPOCH = 1
LATER_NS = 1 << 62
"""No episode is waited for: whoever asks has collected all of it."""


class Effort(NamedTuple):
    """What the people of a round did. overrides, releases: utterances that the robot obeyed.

    endorsements: episodes of which they said afterwards that the rest was right.
    steps: control steps that they looked on. successes: with their help, where they gave it.
    reviewed: episodes in which nobody interfered; alone: successes of these.
    relabels: wrong stretches in them of which they said what would have been right.
    """

    episodes: int
    decisions: int
    overrides: int
    releases: int
    endorsements: int
    steps: int
    successes: int
    reviewed: int = 0
    alone: int = 0
    relabels: int = 0

    @property
    def corrections(self) -> int:
        """What was said, but that somebody let go."""
        return self.overrides + self.relabels + self.endorsements


class Course:
    """What one training seed went through under one person at one site."""

    def __init__(self, folder: Path, low_level_sha256: str, seed: int) -> None:
        """seed: of the training; each has scenes of its own."""
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.seed = folder, seed
        self._low_level_sha256 = low_level_sha256
        self.files = TensorFiles(folder / "tensors")
        self._shelf = Shelf(folder / "versions", self.files)
        self.store = SqlStore(sqlite_url((folder / STORE_FILE).absolute()))
        if self.store.epoch() == 0:
            self.store.take_over("experiment", 0)

    def close(self) -> None:
        """Give the store back."""
        self.store.close()

    def found(self, base: Path | None) -> None:
        """Begin with a checkpoint; None: the bundled one."""
        if self.store.version() is None:
            record = origin(base, self.files, self._low_level_sha256, 0)
            self.store.found(record.model_copy(update={"epoch": EPOCH}))

    def version(self, number: int) -> Path:
        """The checkpoint folder of a version that was made, or of the one to begin with."""
        record = self.store.version(number)
        assert record is not None  # Whoever asks has made it.
        made_by = (one for one in self.store.rounds() if one.made == number)
        return self._shelf.put(record, next(made_by, None))

    def tensor(self, ref: TensorRef) -> NDArray[Any]:
        """A tensor that a training made."""
        return unpack(ref, self.files.get(ref.sha256))

    # -- collecting

    def missing(
        self, round_: int, episodes: range, tasks: tuple[str, ...], person: Person
    ) -> list[Turn]:
        """The episodes of a round that have not been watched yet.

        episodes: their places among those of all rounds. person: who will watch.
        """
        if self._rounds() >= round_:
            return []
        there = {episode.id for episode in self._episodes()}
        turns = [
            Turn(
                collection_seed(self.seed, place),
                tasks[place % len(tasks)],
                f"r{round_}-e{number}",
                person.reviews(round_, number),
            )
            for number, place in enumerate(episodes)
        ]
        return [turn for turn in turns if turn.episode not in there]

    def add(self, watched: Watched) -> None:
        """Keep an episode; its record comes last, so that it is there only as a whole."""
        for message in watched.messages:
            self.store.add(message, 0)

    def _episodes(self) -> tuple[Episode, ...]:
        return self.store.history(self._everything()).episodes

    def _everything(self) -> Manifest:
        return Manifest(marks=self.store.survey(Manifest()).marks)

    def _rounds(self) -> int:
        """How many have begun."""
        return len(self.store.rounds())

    # -- rounds

    def begin(self, number: int, recipe: Recipe) -> Round | None:
        """The round with what was collected; None where it is over."""
        rounds = self.store.rounds()
        if len(rounds) >= number:
            round_ = rounds[number - 1]
            return round_ if round_.state is RoundState.RUNNING else None
        used = rounds[-1].manifest if rounds else Manifest()
        marks, arrivals, _ = self.store.survey(used)
        stock = take_stock(arrivals, LATER_NS, 0)
        round_ = Round(
            number=number,
            epoch=EPOCH,
            parent=number - 1,
            seed=self.seed * 1000 + number,
            manifest=next_manifest(marks, stock, recipe.model_dump(mode="json")),
            begun_ns=0,
        )
        self.store.begin(round_)
        return round_

    def end(self, round_: Round, candidate: Candidate) -> None:
        """Keep what came of a round; an experiment has no gate."""
        made = PolicyRecord(
            number=round_.number,
            epoch=EPOCH,
            tensors=candidate.tensors,
            bank=candidate.bank,
            settings=candidate.settings,
            low_level_sha256=self._low_level_sha256,
            marks=round_.manifest.marks,
            created_ns=0,
        )
        ended = round_.model_copy(
            update={
                "state": RoundState.PASSED,
                "figures": candidate.figures.model_dump(mode="json"),
                "made": made.number,
                "ended_ns": 0,
            }
        )
        self.store.end(ended, made)
        under_way(self.folder, round_.number).unlink(missing_ok=True)

    # -- what it took

    def labels(self, round_: int) -> tuple[Label, ...]:
        """All that a round had to learn from."""
        manifest = self.store.rounds()[round_ - 1].manifest
        recipe = Recipe.model_validate(manifest.settings)
        return derive(self.store.history(manifest), recipe.labels, self._low_level_sha256)

    def effort(self, round_: int, person: Person) -> Effort:
        """What the people of one round did. person: who watched."""
        history = self.store.history(self.store.rounds()[round_ - 1].manifest)
        episodes = {one.id: one for one in history.episodes if one.id.startswith(f"r{round_}-")}
        obeyed = {one.correction for one in history.receipts if one.accepted}
        said = [one for one in history.corrections if one.episode in episodes]
        spoken = [one for one in said if one.id in obeyed or one.kind in AFTERWARDS]
        alone = [one for one in episodes.values() if person.reviews(*place_of(one.id))]
        return Effort(
            episodes=len(episodes),
            decisions=sum(one.decisions for one in episodes.values()),
            overrides=_count(spoken, Kind.OVERRIDE),
            releases=_count(spoken, Kind.RELEASE),
            endorsements=_count(spoken, Kind.ENDORSE),
            steps=sum(one.steps for one in episodes.values()),
            successes=sum(one.success for one in episodes.values()),
            reviewed=len(alone),
            alone=sum(one.success for one in alone),
            relabels=_count(spoken, Kind.RELABEL),
        )

    def staleness(self, round_: int) -> dict[str, int]:
        """Of the episodes that a round learned from: how many by how many versions ago they ran.

        0 is the version that the round began with.
        """
        history = self.store.history(self.store.rounds()[round_ - 1].manifest)
        ages = Counter(round_ - 1 - episode.version.number for episode in history.episodes)
        return {str(age): ages[age] for age in sorted(ages)}

    def corrected_prompts(self, round_: int) -> frozenset[str]:
        """The prompts of episodes in which a mistake was spoken of, up to a round."""
        history = self.store.history(self.store.rounds()[round_ - 1].manifest)
        mistakes = (Kind.OVERRIDE, Kind.RELABEL)
        spoken = {one.episode for one in history.corrections if one.kind in mistakes}
        return frozenset(one.prompt for one in history.episodes if one.id in spoken)


def place_of(episode: str) -> tuple[int, int]:
    """The round and the number of an episode, by its id."""
    round_, _, number = episode.removeprefix("r").partition("-e")
    return int(round_), int(number)


def _count(corrections: Iterable[Correction], kind: Kind) -> int:
    return sum(one.kind is kind for one in corrections)


def under_way(folder: Path, round_: int) -> Path:
    """File of a round that is being trained."""
    return folder / f"round-{round_}.under-way.safetensors"
