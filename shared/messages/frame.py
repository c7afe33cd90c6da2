"""A camera picture for people; published only while somebody watches."""

from enum import StrEnum
from typing import NamedTuple

from shared.messages.message import ArraySpec, Id, Message, Step, TimeNs

PREFIX, SLOW = "frame-", "-slow"


class Rate(StrEnum):
    """How often somebody wants a picture: as often as the robot makes them, or now and then.

    Each has a key of its own, so that the bus itself tells an actor what is watched how.
    """

    FULL = "full"
    SLOW = "slow"


class Channel(NamedTuple):
    """One camera at one rate."""

    camera: str
    rate: Rate = Rate.FULL

    @property
    def message(self) -> str:
        """The last part of its key."""
        return f"{PREFIX}{self.camera}{SLOW if self.rate is Rate.SLOW else ''}"

    @classmethod
    def parse(cls, message: str) -> "Channel":
        """The channel that the last part of a key names."""
        name = message.removeprefix(PREFIX)
        camera = name.removesuffix(SLOW)
        return cls(camera, Rate.SLOW if camera != name else Rate.FULL)


class Frame(Message):
    """One camera picture of one robot.

    sequence: counts every frame of this camera that was due at this rate, so that a gap is a
        counted loss.
    arrays: jpeg [L] uint8, the file's bytes.
    """

    ARRAYS = {"jpeg": ArraySpec("uint8", (None,), limit=1 << 20)}

    robot: Id
    episode: Id
    step: Step
    camera: Id
    sequence: Step
    time_ns: TimeNs
