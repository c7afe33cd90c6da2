"""Which version learned a correction: the same after restarts, refusals, rulings and rollbacks."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from shared.messages.learned import LearnedAnswer, LearnedQuestion
from shared.messages.ruling import Verb
from shared.wire.codec import decode, encode
from shared.wire.keys import service_key
from tests.unit.learner.bench import Bench
from tests.unit.learner.records import ruling

KEY = service_key("lab", "learner", "learner", "learned")


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.learner.close()


def learns(bench: Bench, episode: str, *corrections: str, finite: bool = True) -> None:
    """A round that was trained with these; one that isn't finite is refused."""
    bench.happens(episode)
    bench.beat()
    bench.trainer.outcome = bench.candidate(finite=finite, learned=corrections)
    bench.beat()


def learned(bench: Bench, *names: str) -> dict[str, str]:
    question = encode(LearnedQuestion(corrections=names or ("e-1-0", "e-2-0", "e-3-0")))
    answer = decode(LearnedAnswer, bench.robots.ask(KEY, question))
    return {name: str(version) for name, version in answer.learned.items()}


def test_a_correction_is_learned_in_the_first_version_that_was_trained_with_it(
    bench: Bench,
) -> None:
    assert learned(bench) == {}
    learns(bench, "e-1", "e-1-0")
    assert learned(bench) == {"e-1-0": "1.1"}
    learns(bench, "e-2", "e-1-0", "e-2-0")
    assert learned(bench) == {"e-1-0": "1.1", "e-2-0": "1.2"}
    assert learned(bench, "e-2-0") == {"e-2-0": "1.2"}


def test_what_the_gate_held_back_is_not_learned_until_somebody_promotes_it(bench: Bench) -> None:
    learns(bench, "e-1", "e-1-0", finite=False)
    assert learned(bench) == {}
    learns(bench, "e-2", "e-2-0")
    assert learned(bench) == {"e-2-0": "1.1"}


def test_a_restart_and_a_rollback_change_nothing(bench: Bench) -> None:
    learns(bench, "e-1", "e-1-0")
    bench.learner.close()
    bench.restart()
    assert str(bench.announced().version) == "2.1"
    assert learned(bench) == {"e-1-0": "1.1"}
    bench.store.add(ruling(Verb.ROLLBACK, version=0), 1)
    bench.beat()
    assert str(bench.announced().version) == "2.2"
    assert learned(bench) == {"e-1-0": "1.1"}
    learns(bench, "e-2", "e-2-0")
    assert learned(bench) == {"e-1-0": "1.1", "e-2-0": "2.3"}
