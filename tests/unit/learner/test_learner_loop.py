"""A learner turns rounds: when one begins, what goes out, and what a restart goes on with."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from services.learner.config import LearnerSettings, Recipe
from services.learner.loop import ATTEMPTS
from services.learner.store.memory import MemoryStore
from services.learner.store.store import PolicyRecord, RoundState
from services.learner.trials import policy_sha256
from shared.errors import PolicyError, RefusedError
from shared.messages.heartbeat import LearnerState
from shared.policies.checkpoint import load_card
from shared.wire.keys import service_key
from tests.unit.learner.bench import Bench
from tests.unit.learner.checkpoints import tamper
from tests.unit.learner.records import HAM, correction


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.learner.close()


def test_a_fresh_store_announces_the_base_as_1_0(bench: Bench) -> None:
    assert str(bench.announced().version) == "1.0"
    assert bench.announced().bank == ("wait",)


def test_corrections_become_a_round_and_the_round_a_version(bench: Bench) -> None:
    bench.beat()
    assert bench.trainer.begun == []
    bench.happens("e-1")
    bench.beat()
    (round_,) = bench.trainer.begun
    assert (round_.number, round_.parent, round_.manifest.corrections) == (1, 0, 2)
    assert Recipe.model_validate(round_.manifest.settings) == LearnerSettings().recipe()
    base = policy_sha256(bench.origin())
    assert (round_.manifest.base, round_.manifest.parent) == (base, base)
    assert round_.manifest.demonstrations == bench.trainer.demonstrations()
    assert bench.state() is LearnerState.TRAINING
    assert bench.learner.heartbeat().progress == 0.5
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    assert str(bench.announced().version) == "1.1"
    assert bench.announced().bank == ("wait", HAM)
    card = load_card(bench.folder / "versions" / "1.1")
    assert (card.version, card.settings["bank"]) == ("1.1", f"wait\n{HAM}")
    assert bench.store.rounds()[0].state is RoundState.PASSED
    assert bench.state() is LearnerState.COLLECTING


def test_a_command_said_of_an_episode_that_was_learned_from_begins_a_round(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    for number in range(2):
        bench.store.add(
            correction(f"w-{number}", HAM, kind="relabel", first_step=0, end_step=40), 1
        )
    bench.beat()
    assert [round_.number for round_ in bench.trainer.begun] == [1, 2]
    assert bench.trainer.begun[1].manifest.corrections == 2


def test_what_was_learned_and_is_taken_back_begins_a_round_by_itself(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate(learned=("e-1-0", "e-1-1"))
    bench.beat()
    bench.store.add(correction("r-0", kind="retract", target="e-1-0"), 1)
    bench.beat()
    assert len(bench.trainer.begun) == 1
    bench.store.add(correction("r-1", kind="retract", target="e-1-1"), 1)
    bench.beat()
    assert [round_.number for round_ in bench.trainer.begun] == [1, 2]
    assert bench.trainer.begun[1].manifest.corrections == 2
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    bench.beat(9)
    assert len(bench.trainer.begun) == 2  # It counts once.


def test_robots_can_fetch_what_was_announced(bench: Bench) -> None:
    ref = bench.announced().tensors[0]
    key = service_key("lab", "learner", "learner", "tensor")
    assert bench.robots.ask(f"{key}/{ref.sha256}/0") == np.zeros(4, np.float32).tobytes()


def test_what_arrives_during_a_round_is_for_the_next_one(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.happens("e-2", overrides=3)
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    bench.beat()
    first, second = bench.trainer.begun
    assert (first.manifest.corrections, second.manifest.corrections) == (2, 3)
    assert len(bench.store.history(first.manifest).corrections) == 2
    assert len(bench.store.history(second.manifest).corrections) == 5
    assert (second.number, second.parent, second.seed) == (2, 1, first.seed + 1)


def test_a_round_waits_for_an_episodes_corrections_but_not_for_ever(bench: Bench) -> None:
    bench.restart(corrections=0, after_s=0, episodes=1)
    bench.happens("e-1", overrides=3, missing=1)
    bench.beat(29)
    assert bench.trainer.begun == []
    bench.beat(2)
    assert len(bench.trainer.begun) == 1


def test_a_refused_candidate_goes_nowhere_and_its_reason_is_kept(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate(finite=False)
    bench.beat()
    assert str(bench.announced().version) == "1.0"
    (round_,) = bench.store.rounds()
    assert round_.state is RoundState.REFUSED
    assert "not a number" in round_.reason
    bench.beat(9)
    assert len(bench.trainer.begun) == 1  # Nothing new was said since.


def test_a_failed_training_is_noted_and_the_next_round_uses_its_data_again(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = PolicyError("out of memory")
    bench.beat()
    assert bench.store.rounds()[0].reason == "out of memory"
    bench.happens("e-2")
    bench.beat()
    assert len(bench.store.history(bench.trainer.begun[1].manifest).corrections) == 4


def test_no_more_rounds_than_asked_for(bench: Bench) -> None:
    bench.restart(max_rounds=1)
    for name in ("e-1", "e-2"):
        bench.happens(name)
        bench.beat()
        bench.trainer.outcome = bench.candidate()
        bench.beat()
    assert len(bench.trainer.begun) == 1
    assert bench.state() is LearnerState.COLLECTING


@pytest.mark.parametrize("when", ["before", "during"])
def test_a_changed_low_level_stops_the_learner_but_not_its_collecting(
    bench: Bench, when: str
) -> None:
    bench.happens("e-1")
    if when == "before":
        tamper(bench.low_level)
    bench.beat()
    if when == "during":
        tamper(bench.low_level)
        bench.trainer.outcome = bench.candidate()
        bench.beat()
    assert str(bench.announced().version) == "1.0"
    beat = bench.learner.heartbeat()
    assert beat.state is LearnerState.STOPPED
    assert "exit" in beat.reason
    (round_,) = bench.store.rounds()
    assert (round_.state, round_.reason) == (RoundState.FAILED, beat.reason)
    bench.happens("e-2")
    bench.beat(999)
    assert len(bench.store.rounds()) == 1
    assert bench.learner.heartbeat().corrections == 4


def test_a_store_of_another_low_level_stops_the_learner(bench: Bench) -> None:
    other = PolicyRecord.model_validate(
        {**json.loads(bench.origin().model_dump_json()), "low_level_sha256": "b" * 64, "epoch": 1}
    )
    bench.store = MemoryStore()
    bench.store.take_over("somebody", 1)
    bench.store.found(other)
    bench.restart()
    assert bench.state() is LearnerState.STOPPED


def test_a_restarted_learner_announces_the_same_weights_in_a_new_epoch(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    before = bench.announced()
    bench.learner.close()
    bench.restart()
    after = bench.announced()
    assert sorted(path.name for path in (bench.folder / "versions").iterdir()) == ["1.0", "1.1"]
    assert (str(before.version), str(after.version)) == ("1.1", "2.1")
    assert after.tensors == before.tensors
    bench.happens("e-2")
    bench.beat()
    bench.trainer.outcome = bench.candidate(2.0)
    bench.beat()
    assert str(bench.announced().version) == "2.2"


def test_a_round_that_was_cut_off_is_begun_again_as_it_was(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    cut_off = bench.trainer.begun[0]
    bench.learner.close()
    assert bench.trainer.stopped
    bench.happens("e-2", overrides=1)
    bench.restart()
    assert bench.trainer.begun == [cut_off]
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    assert str(bench.announced().version) == "2.1"
    assert [round_.state for round_ in bench.store.rounds()] == [RoundState.PASSED]


def test_a_round_that_learners_die_of_is_given_up(bench: Bench) -> None:
    bench.happens("e-1")
    bench.beat()
    for _ in range(ATTEMPTS + 1):
        bench.restart()
    assert bench.trainer.begun == []
    assert bench.store.rounds()[0].state is RoundState.FAILED
    assert bench.state() is LearnerState.COLLECTING


def test_a_learner_whose_store_was_taken_over_ends(bench: Bench) -> None:
    bench.store.take_over("newcomer", 1)
    with pytest.raises(RefusedError, match="in epoch 2"):
        bench.beat()


def test_the_heartbeat_counts_since_the_version_in_force(bench: Bench) -> None:
    bench.happens("e-1")
    assert bench.learner.heartbeat().corrections == 2
    bench.beat()
    bench.trainer.outcome = bench.candidate()
    bench.beat()
    bench.happens("e-2", overrides=1)
    beat = bench.learner.heartbeat()
    assert (beat.episodes, beat.successes, beat.corrections, beat.decisions) == (1, 1, 1, 1)
    assert (beat.round, str(beat.version)) == (1, "1.1")
