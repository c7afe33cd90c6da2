"""What a round makes of what people said, in the test's own process."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from services.learner.build import origin
from services.learner.code import code_version
from services.learner.config import Recipe, TrainSettings
from services.learner.frozen import FrozenLowLevel
from services.learner.gate import Candidate
from services.learner.gather import gather, open_version, renew
from services.learner.held_out import keep_aside
from services.learner.labels.aggregate import Ground, Label, LabelSettings, derive
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest, Round, RoundState
from services.learner.store.tensors import TensorFiles, unpack
from services.learner.train import fine_tune, reader
from services.learner.trials import policy_sha256
from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.messages.observation import Observation
from shared.messages.policy import TensorRef
from shared.policies import examples
from shared.policies.checkpoint import bundled
from shared.workcell.skills import COMMANDS
from tests.unit.learner.checkpoints import BANK, Checkpoints, small_checkpoints
from tests.unit.learner.records import HAM, TOAST, correction, decision, episode, receipt


class Workshop:
    """A store with corrected episodes, and all that a round is made with."""

    def __init__(self, folder: Path, checkpoints: Checkpoints) -> None:
        self.files, self.store = TensorFiles(folder / "tensors"), MemoryStore()
        self.demonstrations = examples.load(checkpoints.demonstrations)
        self.low_sha256 = FrozenLowLevel(checkpoints.low_level).sha256
        made = origin(checkpoints.high_level, self.files, self.low_sha256, 1)
        self.base = made.model_copy(update={"epoch": self.store.take_over("learner", 1)})
        self.store.found(self.base)

    def happens(self, name: str, text: str) -> None:
        """An episode in which somebody said `text` at its second decision."""
        self.store.add(decision(name, 0), 1)
        self.store.add(decision(name, 40, previous=("wait",)), 1)
        said = correction(f"{name}-c", text, episode=name, decision=f"{name}-40", hold_steps=5)
        self.store.add(said, 1)
        self.store.add(receipt(said.id, 40, episode=name), 1)
        done = episode(name, decisions=2, corrections=1)
        self.store.add(done.model_copy(update={"low_level_sha256": self.low_sha256}), 1)

    def round(self, seed: int = 1, parent: int = 0, **train: Any) -> Round:
        recipe = Recipe.model_validate({"train": {"steps": 4, "batch": 4, "epochs": 0, **train}})
        manifest = Manifest(
            marks=self.store.survey(Manifest()).marks, settings=recipe.model_dump(mode="json")
        )
        return Round(number=1, epoch=1, parent=parent, seed=seed, manifest=manifest, begun_ns=1)

    def train(self, round_: Round, **how: Any) -> Candidate:
        told: list[float] = []
        made = fine_tune(round_, self.store, self.files, self.demonstrations, told.append, **how)
        assert told == sorted(told)
        assert told[-1] == 1.0
        return made


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Checkpoints:
    torch.set_num_threads(1)  # More of them only wait for one another on a busy machine.
    return small_checkpoints(tmp_path_factory.mktemp("checkpoints"))


@pytest.fixture
def workshop(tmp_path: Path, checkpoints: Checkpoints) -> Workshop:
    return Workshop(tmp_path, checkpoints)


def test_what_was_demonstrated_and_not_replayed_is_asked_before_and_after(
    workshop: Workshop,
) -> None:
    workshop.happens("e-1", HAM)
    figures = workshop.train(workshop.round()).figures
    assert 0 < figures.retained <= len(workshop.demonstrations) // 2
    assert figures.retained_before is not None
    assert figures.retained_after is not None
    assert 0.0 <= figures.retained_after <= 1.0
    policy = open_version(workshop.base, workshop.files)
    aside = workshop.demonstrations.take(
        keep_aside(len(workshop.demonstrations), figures.retained)[1]
    )
    asked = [
        Observation(
            step=0,
            prompt=aside.prompts[row],
            previous=aside.previous[row],
            arrays={
                "images": aside.images[aside.looks[row, -1]],
                "proprioception": aside.senses[row],
                "objects": np.zeros((18, 9), np.float32),
            },
        )
        for row in range(len(aside))
    ]
    right = [
        policy.propose(one)[0].goal.text == label
        for one, label in zip(asked, aside.labels, strict=True)
    ]
    assert figures.retained_before == pytest.approx(sum(right) / len(right))


def test_the_same_manifest_and_seed_make_the_same_candidate_to_the_bit(workshop: Workshop) -> None:
    workshop.happens("e-1", HAM)
    first = workshop.train(workshop.round())
    workshop.happens("e-2", TOAST)  # Beyond the marks of this manifest.
    manifest = workshop.round().manifest
    again = workshop.round().model_copy(
        update={
            "manifest": manifest.model_copy(
                update={"marks": manifest.marks.model_copy(update={"episodes": 1})}
            )
        }
    )
    second = workshop.train(again)
    assert second.tensors == first.tensors
    assert second.figures.labels_sha256 == first.figures.labels_sha256
    assert workshop.train(workshop.round(seed=2)).tensors != first.tensors


@pytest.mark.parametrize("name", ["base", "parent"])
def test_a_round_is_not_made_from_another_version_than_it_began_with(
    workshop: Workshop, name: str
) -> None:
    workshop.happens("e-1", HAM)
    round_ = workshop.round()
    began = {name: policy_sha256(workshop.base.model_copy(update={"bank": ("another",)}))}
    round_ = round_.model_copy(update={"manifest": round_.manifest.model_copy(update=began)})
    with pytest.raises(PolicyError, match="changed since the round began"):
        workshop.train(round_)
    right = {name: policy_sha256(workshop.base)}
    round_ = round_.model_copy(update={"manifest": round_.manifest.model_copy(update=right)})
    assert workshop.train(round_).figures.code == code_version()


def test_a_training_that_was_cut_off_goes_on_and_makes_the_same_candidate(
    workshop: Workshop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shared.policies.fit.KEPT_UPDATES", 3)
    workshop.happens("e-1", HAM)
    round_, kept = workshop.round(steps=8), tmp_path / "under-way.safetensors"
    whole = workshop.train(round_)
    told: list[float] = []

    def cut_off(share: float) -> None:
        told.append(share)
        if share > 0.5:
            raise InterruptedError

    made = (round_, workshop.store, workshop.files, workshop.demonstrations)
    with pytest.raises(InterruptedError):
        fine_tune(*made, cut_off, kept)
    told.clear()
    again = fine_tune(*made, told.append, kept)
    assert told[0] == pytest.approx(4 / 8)  # The first three updates are not made again.
    assert again.tensors == whole.tensors
    assert again.figures.loss == pytest.approx(whole.figures.loss)


def test_every_round_learns_from_the_corrections_of_all_rounds(workshop: Workshop) -> None:
    workshop.happens("e-1", HAM)
    assert workshop.train(workshop.round()).figures.labels == 1
    workshop.happens("e-2", TOAST)
    assert workshop.train(workshop.round()).figures.labels == 2


def test_a_phrase_that_nobody_used_before_joins_the_bank(workshop: Workshop) -> None:
    workshop.happens("e-1", "Grab the ham!")
    made = workshop.train(workshop.round())
    assert made.bank == (*BANK, "grab the ham")
    record = workshop.base.model_copy(
        update={
            "number": 1,
            "bank": made.bank,
            "tensors": made.tensors,
            "settings": made.settings,
        }
    )
    assert open_version(record, workshop.files).bank.phrases == made.bank


def test_a_phrase_that_no_low_level_understands_is_not_learned(workshop: Workshop) -> None:
    workshop.happens("e-1", "Grab the ham!")
    workshop.happens("e-2", "dance around")
    asked = list[str]()

    def meaning(phrase: str) -> str | None:
        asked.append(phrase)
        return None if "dance" in phrase else HAM

    made = workshop.train(workshop.round(), meaning=meaning)
    assert made.bank == (*BANK, "grab the ham")
    assert (made.figures.unread, made.figures.labels) == (("dance around",), 1)
    assert sorted(asked) == ["dance around", "grab the ham"]  # What is known needs no reader.


def test_the_low_level_that_comes_with_the_project_tells_nonsense_from_other_words() -> None:
    meaning = reader(bundled("low_level"))
    assert meaning("dance around") is None
    assert meaning("grab the cheese") == "pick up the cheese"


def test_what_is_told_by_its_scene_is_learned_and_means_nothing_in_any() -> None:
    for phrase in ("take the dish on the left", "the red one"):
        assert reader(bundled("low_level"))(phrase) is None
        assert reader(bundled("low_level"), any_of_several=True)(phrase) in COMMANDS
    assert reader(bundled("low_level"), any_of_several=True)("I don't like ham") is None


def test_a_phrase_that_was_taken_back_or_put_otherwise_leaves_the_bank_in_the_next_round(
    workshop: Workshop,
) -> None:
    for name, text in (
        ("e-1", "grab the ham"),
        ("e-2", "get the toast"),
        ("e-3", "Pick up the ham."),
    ):
        workshop.happens(name, text)
    first = workshop.round()
    made = workshop.train(first)
    assert made.bank == (*BANK, "grab the ham", "get the toast")
    workshop.store.begin(first)
    new = {"number": 1, "bank": made.bank, "tensors": made.tensors, "settings": made.settings}
    record = workshop.base.model_copy(update=new)
    workshop.store.end(first.model_copy(update={"state": RoundState.PASSED, "made": 1}), record)
    about = {"target": "e-1-c", "episode": "e-1"}
    workshop.store.add(correction("r", kind="retract", **about), 1)
    about = {"target": "e-2-c", "episode": "e-2"}
    workshop.store.add(correction("w", "fetch the toast", kind="edit", **about), 1)
    again = workshop.train(workshop.round(parent=1))
    assert again.bank == (*BANK, "fetch the toast")
    assert record.bank == made.bank  # A version keeps what it was made with.


def test_a_label_takes_the_spelling_of_the_bank() -> None:
    bank, spelling = renew(PhraseBank.of(["Wait.", HAM]), ["Wait.", HAM], [])
    assert len(bank) == 2
    assert spelling == {"wait": "Wait.", HAM: HAM}


def test_starting_from_the_base_forgets_what_the_version_in_force_learned(
    workshop: Workshop,
) -> None:
    workshop.happens("e-1", HAM)
    other = workshop.base.model_copy(update={"number": 1, "tensors": louder(workshop)})
    ended = workshop.round().model_copy(update={"state": RoundState.PASSED, "made": 1})
    workshop.store.begin(workshop.round())
    workshop.store.end(ended, other)
    from_base = workshop.train(workshop.round(parent=0))
    assert workshop.train(workshop.round(parent=1, start="base")).tensors == from_base.tensors
    assert workshop.train(workshop.round(parent=1)).tensors != from_base.tensors


def louder(workshop: Workshop) -> tuple[TensorRef, ...]:
    """The base's tensors, a little larger."""
    files = workshop.files
    arrays = {ref.name: unpack(ref, files.get(ref.sha256)) for ref in workshop.base.tensors}
    return tuple(files.add(name, (a * 1.1).astype(a.dtype)) for name, a in arrays.items())


def test_examples_are_exactly_what_the_high_level_saw(workshop: Workshop) -> None:
    workshop.happens("e-1", HAM)
    history = workshop.store.history(workshop.round().manifest)
    labels = derive(history, LabelSettings(), workshop.low_sha256)
    made = gather(labels, {HAM: HAM}, workshop.store)
    seen = decision("e-1", 40, previous=("wait",))
    assert np.array_equal(made.present[0], seen.arrays["images"])
    assert np.array_equal(made.senses[0], seen.arrays["proprioception"])
    assert (made.prompts, made.previous) == ([seen.prompt], [("wait",)])
    assert (made.labels, list(made.weights)) == ([HAM], [1.0])


def test_earlier_looks_come_with_an_example_unless_they_never_arrived(workshop: Workshop) -> None:
    label = Label("e-1-2", "e-1", HAM, 1.0, Ground.OBJECTED, "c")
    for step, shown in ((0, ()), (40, (0, 1))):
        seen = decision("e-1", step, index=step // 20, past=shown)
        workshop.store.add(seen.model_copy(update={"id": f"e-1-{step // 20}"}), 1)
    made = gather([label], {HAM: HAM}, workshop.store)
    assert made.looks.tolist() == [[0, -1, 1]]
    assert made.images[:, 0, 0, 0, 0].tolist() == [0, 40]


def test_held_out_episodes_are_judged_and_not_learned_from(workshop: Workshop) -> None:
    for number in range(40):
        workshop.happens(f"e-{number}", HAM)
    figures = workshop.train(workshop.round()).figures
    assert figures.labels + figures.held_out == 40
    assert figures.held_out > 0
    assert figures.before is not None
    assert figures.after is not None


def test_a_version_in_force_is_not_judged_by_what_it_was_taught(workshop: Workshop) -> None:
    for number in range(10):
        workshop.happens(f"e-{number}", HAM)
    first = workshop.train(workshop.round())
    record = workshop.base.model_copy(update={"number": 1, "tensors": first.tensors})
    told = {"state": RoundState.PASSED, "made": 1, "candidate": first.model_dump(mode="json")}
    workshop.store.begin(workshop.round())
    workshop.store.end(workshop.round().model_copy(update=told), record)
    for number in range(10, 40):
        workshop.happens(f"e-{number}", HAM)
    second = workshop.train(workshop.round(parent=1))
    assert (len(first.learned), len(second.held_out)) == (8, 8)  # A fifth of the episodes.
    assert set(second.held_out).isdisjoint(first.learned)


@pytest.mark.parametrize(
    ("labels", "updates"),
    [(0, 200), (1280, 200), (1281, 201), (6400, 1000), (10**6, 4000)],
)
def test_more_labels_take_more_updates_so_that_each_is_learned_from_as_often(
    labels: int, updates: int
) -> None:
    settings = TrainSettings(steps=200, epochs=5.0, max_steps=4000, batch=64, correction_share=0.5)
    assert settings.updates(labels) == updates


def test_a_round_makes_the_updates_that_its_labels_take(workshop: Workshop) -> None:
    workshop.happens("one", HAM)
    round_ = workshop.round(epochs=20.0)
    shares: list[float] = []
    fine_tune(round_, workshop.store, workshop.files, workshop.demonstrations, shares.append)
    labels = len(
        derive(workshop.store.history(round_.manifest), LabelSettings(), workshop.low_sha256)
    )
    assert labels > 0
    assert len(shares) == 10 * labels
