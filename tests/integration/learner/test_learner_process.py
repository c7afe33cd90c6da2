"""A learner process over the real bus: it turns rounds, and no crash makes it lose or double."""

import shutil
import threading
from collections import Counter
from contextlib import closing
from functools import partial
from pathlib import Path

from sqlalchemy import text

from services.learner.gather import observation_of
from services.learner.store.sql import open_engine, sqlite_url
from services.learner.store.store import RoundState
from services.learner.store.tensors import unpack
from shared.messages.heartbeat import LearnerState
from shared.policies import examples
from shared.policies.checkpoint import load_card
from shared.policies.high_level import HighLevel
from shared.wire.keys import service_key
from shared.wire.tensors import TensorFetcher
from tests.integration.learner.lab import Lab
from tests.integration.learner.process import lives, until
from tests.integration.learner.world import Sent, happenings
from tests.unit.learner.checkpoints import BANK, Checkpoints
from tests.unit.learner.records import HAM


def test_corrections_become_a_version_that_robots_can_take_up(lab: Lab) -> None:
    learner = lab.start(round__corrections=3, train__steps=25, gate__held_out_share=0)
    base = lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    made = lab.wait_for("1.1")
    assert made.bank == BANK
    prefix = service_key("lab", "learner", "learner", "tensor")
    with TensorFetcher(lab.bus, prefix, {}) as fetcher:
        fetched = fetcher.fetch(made.tensors, 20)
    tensors = {ref.name: unpack(ref, fetched[ref.sha256]) for ref in made.tensors}
    policy = HighLevel.build(made, tensors)
    with closing(lab.store()) as store:
        (seen,) = store.decisions(["e-1-0"])
    best = policy.propose(observation_of(seen))[0].goal.text
    assert best == HAM
    assert {ref.sha256 for ref in made.tensors} != {ref.sha256 for ref in base.tensors}
    again = HighLevel.load(lab.folder / "run" / "versions" / "1.1")
    assert again.propose(observation_of(seen)) == policy.propose(observation_of(seen))
    assert learner.end() == 0


def test_what_was_acknowledged_outlives_kills_in_the_middle_of_ingestion(lab: Lab) -> None:
    messages = [
        sent for number in range(40) for sent in happenings(f"e-{number}", lab.low_level_sha256)
    ]
    acknowledged: list[Sent] = []

    def send_all() -> None:
        for sent in messages:
            lab.deliver(sent)
            acknowledged.append(sent)

    lab.start(round__corrections=0, round__after_s=0)
    sender = threading.Thread(target=send_all)
    sender.start()
    for share in (0.2, 0.5, 0.8):
        reached = int(share * len(messages))
        until(partial(_reaches, acknowledged, reached), f"{reached} are sent")
        assert lab.learner is not None
        lab.learner.kill()
        held = _ids(lab)
        assert {sent.id for sent in acknowledged} <= held.keys()
        lab.start(round__corrections=0, round__after_s=0)
    sender.join()
    assert _ids(lab) == Counter(sent.id for sent in messages)


def test_a_round_cut_off_in_training_is_done_once_by_the_next_learner(lab: Lab) -> None:
    rounds = {"round__corrections": 3, "train__steps": 40}
    learner = lab.start(**rounds)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    until(lambda: lab.beats[-1].progress > 0.05, "training is under way")
    assert lab.beats[-1].state is LearnerState.TRAINING
    trainers = learner.children()
    assert trainers
    learner.kill()
    until(lambda: not any(map(lives, trainers)), "the training ended with its learner")
    late = happenings("e-2", lab.low_level_sha256, overrides=1)
    learner = lab.start(**rounds)
    lab.wait_for("2.0")
    for sent in late:  # Taken in while the old round trains again; no part of it.
        lab.deliver(sent)
    lab.wait_for("2.1")
    assert learner.end() == 0
    with closing(lab.store()) as store:
        (round_,) = store.rounds()
        assert (round_.state, round_.epoch, round_.made) == (RoundState.PASSED, 1, 1)
        assert len(store.history(round_.manifest).corrections) == 3


def test_a_round_that_was_cut_off_is_not_made_from_other_demonstrations(
    lab: Lab, checkpoints: Checkpoints, tmp_path: Path
) -> None:
    folder = tmp_path / "demonstrations"
    shutil.copytree(checkpoints.demonstrations, folder)
    rounds = {"round__corrections": 3, "train__steps": 100_000, "demonstrations": folder}
    learner = lab.start(**rounds)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    until(lambda: lab.beats[-1].progress > 0, "training is under way")
    learner.kill()
    other = examples.load(folder)
    shown = other.take(range(len(other) - 1))
    examples.save(folder, shown, load_card(folder))
    lab.start(**rounds)
    lab.wait_for("2.0")
    with closing(lab.store()) as store:
        until(lambda: store.rounds()[0].state is RoundState.FAILED, "the round is given up")
        (round_,) = store.rounds()
        before = load_card(checkpoints.demonstrations).tensors_sha256
        assert round_.manifest.demonstrations == before
        assert round_.reason.startswith("the demonstrations changed since the round began")
        assert load_card(folder).tensors_sha256[:16] in round_.reason


def test_what_arrives_while_a_round_trains_is_kept_and_the_end_need_not_wait(lab: Lab) -> None:
    learner = lab.start(round__corrections=3, train__steps=100_000)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    until(lambda: lab.beats[-1].progress > 0, "training is under way")
    for sent in happenings("e-2", lab.low_level_sha256):
        lab.deliver(sent)
    count = len(lab.beats)
    until(lambda: len(lab.beats) >= count + 4, "it goes on telling")
    assert lab.beats[-1].state is LearnerState.TRAINING
    trainers = learner.children()
    assert learner.end() == 0
    until(lambda: not any(map(lives, trainers)), "the training ended with its learner")
    with closing(lab.store()) as store:
        assert [round_.state for round_ in store.rounds()] == [RoundState.RUNNING]


def _ids(lab: Lab) -> Counter[str]:
    """How often the store holds what was sent."""
    engine = open_engine(sqlite_url(lab.folder / "run" / "learner.db"))
    with engine.begin() as connection:
        found = Counter(
            f"{table.removesuffix('s')} {id_}"
            for table in ("decisions", "corrections", "receipts", "episodes")
            for id_ in connection.scalars(text(f"SELECT id FROM {table}"))
        )
    engine.dispose()
    return found


def _reaches(sent: list[Sent], count: int) -> bool:
    return len(sent) >= count
