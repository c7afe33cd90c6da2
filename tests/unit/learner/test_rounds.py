"""When a round begins, and what it is made from."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.learner.rounds import (
    RoundSettings,
    Stock,
    check_sources,
    due,
    last_manifest,
    next_manifest,
    take_stock,
)
from services.learner.store.store import Arrival, Manifest, Marks, Round
from shared.errors import PolicyError

SECOND = 1_000_000_000


def arrival(name: str = "e", missing: int = 0, overrides: int = 0, at: int = 0) -> Arrival:
    return Arrival(name, False, at, missing, 0, overrides)


def stock(episodes: int, corrections: int) -> Stock:
    ready = [arrival(f"e-{number}") for number in range(episodes)]
    ready[0] = ready[0]._replace(overrides=corrections)
    return Stock(tuple(ready), (), ())


def test_an_episode_counts_when_all_is_here_that_it_speaks_of() -> None:
    arrivals = [arrival("a"), arrival("b", missing=1), Arrival("c", False, 0, 0, 1, 3)]
    sorted_out = take_stock(arrivals, 29 * SECOND, 30)
    assert [one.episode for one in sorted_out.ready] == ["a"]
    assert [one.episode for one in sorted_out.waiting] == ["b", "c"]
    assert (sorted_out.episodes, sorted_out.corrections) == (1, 0)


def test_an_episode_is_not_waited_for_for_ever() -> None:
    sorted_out = take_stock([Arrival("c", False, 0, 2, 1, 3)], 30 * SECOND, 30)
    assert [one.episode for one in sorted_out.short] == ["c"]
    assert (sorted_out.episodes, sorted_out.corrections) == (1, 3)


def test_a_broken_off_episode_is_learned_from_but_not_counted() -> None:
    sorted_out = take_stock([Arrival("a", True, 0, 0, 0, 2), arrival("b", overrides=1)], 0, 30)
    assert len(sorted_out.ready) == 2
    assert (sorted_out.episodes, sorted_out.corrections) == (1, 3)


@given(st.lists(st.builds(Arrival, st.text("ab"), st.booleans(), *[st.integers(0, 60)] * 4)))
def test_every_episode_is_ready_or_short_or_waited_for(arrivals: list[Arrival]) -> None:
    sorted_out = take_stock(arrivals, 45, 20e-9)
    assert sorted([*sorted_out.ready, *sorted_out.short, *sorted_out.waiting]) == sorted(arrivals)


@pytest.mark.parametrize(
    ("settings", "episodes", "corrections", "waited_s", "begins"),
    [
        ({"corrections": 25}, 3, 24, 0, False),
        ({"corrections": 25}, 3, 25, 0, True),
        ({"corrections": 0, "after_s": 0}, 3, 999, 999, False),
        ({"after_s": 300}, 1, 1, 299, False),
        ({"after_s": 300}, 1, 1, 300, True),
        ({"after_s": 300}, 1, 0, 999, False),
        ({"episodes": 40, "corrections": 0, "after_s": 0}, 39, 99, 999, False),
        ({"episodes": 40, "corrections": 0, "after_s": 0}, 40, 0, 0, True),
    ],
)
def test_a_round_begins_by_whichever_trigger_comes_first(
    settings: dict[str, Any], episodes: int, corrections: int, waited_s: float, begins: bool
) -> None:
    found = due(stock(episodes, corrections), waited_s, 0, RoundSettings(**settings))
    assert found is begins


def test_no_round_begins_beyond_the_last_one_asked_for() -> None:
    settings = RoundSettings(corrections=1, max_rounds=2)
    assert due(stock(1, 5), 0, 1, settings)
    assert not due(stock(1, 5), 0, 2, settings)


def test_a_manifest_leaves_out_only_the_episodes_that_are_waited_for() -> None:
    sorted_out = take_stock([arrival("a", overrides=2), arrival("b", missing=1)], 0, 30)
    made = next_manifest(Marks(episodes=2), sorted_out, {"x": 1})
    assert made.model_copy(update={"code": ""}) == Manifest(
        marks=Marks(episodes=2), excluded=("b",), settings={"x": 1}, episodes=1, corrections=2
    )


def test_a_manifest_tells_what_its_round_starts_from_and_refuses_anything_else() -> None:
    then = {"demonstrations": "a" * 64, "base": "b" * 64, "parent": "c" * 64}
    manifest = next_manifest(Marks(), take_stock((), 0, 0), {}, **then)
    check_sources(manifest, **then)
    check_sources(Manifest(), **then)  # From before this was kept.
    for name, what in (
        ("demonstrations", "the demonstrations changed"),
        ("base", "the first version of the store changed"),
        ("parent", "the version that it starts from changed"),
    ):
        with pytest.raises(PolicyError, match=f"{what}.*{'e' * 16} now.*put back what was there"):
            check_sources(manifest, **then | {name: "e" * 64})


def test_the_first_round_looks_at_everything() -> None:
    assert last_manifest([]) == Manifest()
    used = Manifest(marks=Marks(episodes=4))
    rounds = [
        Round(number=number, epoch=1, parent=0, seed=1, manifest=manifest, begun_ns=1)
        for number, manifest in enumerate([Manifest(), used], start=1)
    ]
    assert last_manifest(rounds) == used
