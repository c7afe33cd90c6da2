"""What versions came of: told on their cards and by `hld policy`, whoever put them in force."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from services.learner.canary import CanarySettings
from services.learner.descent import Descent, descents, tell
from services.learner.gate import GateSettings
from services.learner.shelf import ROUND_FILE
from services.learner.store.store import PolicyRecord
from services.learner.versions import detail
from shared.messages.ruling import Ruling, Verb
from shared.policies.checkpoint import load_card
from tests.unit.learner.bench import Bench
from tests.unit.learner.records import ruling

JUNE_5 = 1_780_655_900_000_000_000
BASE = "The checkpoint that the run began with, unchanged."


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.learner.close()


def round_made(bench: Bench, name: str, value: float, held_out: int = 20) -> None:
    """A round and its candidate; few held-out labels keep it here."""
    bench.happens(name)
    bench.beat()
    bench.trainer.outcome = bench.candidate(value, held_out=held_out)
    bench.beat()


def rule(bench: Bench, id_: str, **about: object) -> Ruling:
    fields = {"author": "anna", "reason": "it drops the bread", "created_ns": JUNE_5}
    said = ruling(id_, **{**fields, **about})
    bench.store.add(said, 1)
    bench.beat()
    return said


def recipe(bench: Bench, version: str) -> tuple[str, ...]:
    return load_card(bench.folder / "versions" / version).recipe


def came_of(bench: Bench) -> dict[int, Descent]:
    store = bench.store
    return descents(store.versions(), store.rounds(), store.answers())


def version(bench: Bench, number: int) -> PolicyRecord:
    found = bench.store.version(number)
    assert found is not None
    return found


def test_the_card_of_a_promoted_version_names_its_round_who_promoted_it_and_when(
    bench: Bench,
) -> None:
    round_made(bench, "e-1", 1.0, held_out=3)
    assert recipe(bench, "1.0") == (BASE,)
    said = rule(bench, "rule-1", verb=Verb.PROMOTE, round=1)
    told = recipe(bench, "1.1")
    assert told[0].startswith("Round 1, from the version number 0")
    assert "The gate held it back: held out 3 labels" in told[-2]
    assert told[-1] == "anna put it in force on 2026-06-05: it drops the bread"
    kept = json.loads((bench.folder / "versions" / "1.1" / ROUND_FILE).read_text())
    assert (kept["number"], kept["state"]) == (1, "refused")
    shown = detail(version(bench, 1), came_of(bench)[1])
    assert (shown["round"]["number"], shown["ruling"]["id"]) == (1, said.id)
    assert tuple(shown["came_of"]) == told


def test_the_card_of_a_rollback_names_the_version_whose_weights_it_has_and_their_round(
    bench: Bench,
) -> None:
    round_made(bench, "e-1", 1.0)
    round_made(bench, "e-2", 2.0)
    rule(bench, "rule-1", version=1)
    rule(bench, "rule-2", version=0, reason="")
    rule(bench, "rule-3", version=3)
    first, base, again = (recipe(bench, name) for name in ("1.3", "1.4", "1.5"))
    assert first[0].startswith("Round 1, from")
    assert first[-2:] == (
        "These are the weights of version number 1 again.",
        "anna put it in force on 2026-06-05: it drops the bread",
    )
    assert base == (
        BASE,
        "These are the weights of version number 0 again.",
        "anna put it in force on 2026-06-05.",
    )
    assert again == first  # Version 3 has the weights of 1, and so has what goes back to it.
    assert not (bench.folder / "versions" / "1.3" / ROUND_FILE).exists()  # It's counted once.
    shown = detail(version(bench, 5), came_of(bench)[5])
    assert (shown["again"], shown["round"]["number"]) == (1, 1)
    assert tuple(shown["came_of"]) == again


def test_what_takes_a_version_back_from_some_robots_was_put_in_force_by_the_learner(
    bench: Bench,
) -> None:
    bench.restart(GateSettings(canary=CanarySettings(robots=("robot-1",), within_s=10)))
    round_made(bench, "e-1", 1.0)
    bench.beat(60)
    assert recipe(bench, "2.2") == (
        BASE,
        "These are the weights of version number 0 again.",
        "The learner put it in force, in place of one that some robots ran first.",
    )


def test_a_version_that_a_round_made_is_told_as_before(bench: Bench) -> None:
    round_made(bench, "e-1", 1.0)
    told = tell(came_of(bench)[1])
    assert told[0] == "Round 1, from the version number 0 of the same run."
    assert recipe(bench, "1.1") == told
