"""No evaluation ever sees a scene that somebody corrected."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shared.errors import ConfigError
from shared.seeds import collection_seed, purpose


@given(st.integers(0, 999), st.integers(0, 10**7), st.integers(0, 10_000))
def test_a_robots_seeds_are_for_collection_only(robot, episode, base):
    assert purpose(collection_seed(robot, episode, base)) == "collection"


def test_robots_do_not_share_scenes():
    seeds = {collection_seed(robot, episode) for robot in range(20) for episode in range(500)}
    assert len(seeds) == 20 * 500


def test_a_seed_out_of_every_range_is_an_error():
    with pytest.raises(ConfigError, match="out of range"):
        purpose(-1)
