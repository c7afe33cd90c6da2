"""Which seeds are for what, so that no evaluation ever sees a scene that somebody corrected.

The ranges don't overlap; `purpose` tells the range that a seed lies in, and the learner refuses
an episode whose seed is none of `COLLECTION`.
"""

from shared.errors import ConfigError

DEMONSTRATION = range(0, 1_000_000_000)
COLLECTION = range(1_000_000_000, 2_000_000_000)
EVALUATION = range(2_000_000_000, 2_140_000_000)
GATE = range(2_140_000_000, 2_147_483_647)
"""Where the learner's gate compares: a version that was chosen on a scene isn't measured on it."""

_RANGES = {
    "demonstration": DEMONSTRATION,
    "collection": COLLECTION,
    "evaluation": EVALUATION,
    "gate": GATE,
}
_ROBOT_BLOCK = 1_000_000


def purpose(seed: int) -> str:
    """The name of the range that `seed` lies in.

    Raises:
        ConfigError: the seed lies in none of them.
    """
    for name, seeds in _RANGES.items():
        if seed in seeds:
            return name
    raise ConfigError(f"seed {seed} is out of range: 0 to {GATE.stop - 1}")


def collection_seed(robot_index: int, episode: int, base: int = 0) -> int:
    """The seed of a robot's `episode`-th episode: robots never share a scene."""
    offset = (base * 97 + robot_index) * _ROBOT_BLOCK + episode
    return COLLECTION.start + offset % len(COLLECTION)
