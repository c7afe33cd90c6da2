"""Kinds of robots: whatever installed packages offer."""

from importlib.metadata import entry_points

from shared.errors import ConfigError, nearest
from shared.rollout.robot import Robot


def make_robot(kind: str, site: str, skills: int | None = None) -> Robot:
    """A robot of the kind that some installed package offers.

    Raises:
        ConfigError: no package offers such a kind; the message names those that are there.
    """
    offered = {entry.name: entry for entry in entry_points(group="hl_dagger.robots")}
    if kind not in offered:
        raise ConfigError(f"no robot of kind {kind!r}{nearest(kind, offered)}")
    made = offered[kind].load()
    robot: Robot = made(site) if skills is None else made(site, skills)
    return robot
