"""A camera picture for people; published only while somebody watches."""

from shared.messages.message import ArraySpec, Id, Message, Step, TimeNs


class Frame(Message):
    """One camera picture of one robot.

    sequence: counts every frame that the actor published, so that a gap is a counted loss.
    arrays: jpeg [L] uint8, the file's bytes.
    """

    ARRAYS = {"jpeg": ArraySpec("uint8", (None,), limit=1 << 20)}

    robot: Id
    episode: Id
    step: Step
    camera: Id
    sequence: Step
    time_ns: TimeNs
