"""What a policy sees at one step. Shapes: see the legend in the README."""

from shared.messages.message import ArraySpec, Message, Step, Text

IMAGE_PX = 64
CAMERAS = ("top", "angle")

OBSERVATION_ARRAYS = {
    "images": ArraySpec("uint8", (None, IMAGE_PX, IMAGE_PX, 3), limit=8),
    "proprioception": ArraySpec("float32", (None,), limit=256),
    "objects": ArraySpec("float32", (None, 9), limit=256),
}


class Observation(Message):
    """What both levels see at one control step.

    step: control steps since the episode began.
    prompt: the sentence that asks for the task.
    previous: commands that were in force before, oldest first, as the high level is shown them.
    arrays: images [V, 64, 64, 3] uint8, one per camera of `CAMERAS`; proprioception [P] float32,
        14 joint positions in rad (grippers in m) and the tool pose of each arm as x, y, z in m
        and yaw in rad; objects [N, 9] float32, the position in m and the first two columns of
        the rotation matrix of each object of the cell, world frame.
    """

    ARRAYS = OBSERVATION_ARRAYS

    step: Step
    prompt: Text
    previous: tuple[Text, ...] = ()
