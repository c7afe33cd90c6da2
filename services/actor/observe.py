"""Observe: tell the fleet what a robot does, and show pictures while somebody watches."""

import numpy as np
import simplejpeg

from services.actor.config import FrameSettings
from shared.clock import Clock
from shared.messages.frame import Frame
from shared.messages.heartbeat import RobotHeartbeat
from shared.messages.observation import CAMERAS
from shared.rollout.robot import Robot
from shared.rollout.rollout import Rollout
from shared.wire.bus import Bus, Urgency
from shared.wire.codec import encode
from shared.wire.keys import robot_key

HEARTBEAT_NS = 500_000_000


class Observer:
    """What one robot tells of itself, at most as often as is useful."""

    def __init__(self, bus: Bus, fleet: str, robot: str, clock: Clock, frames: FrameSettings):
        self._bus, self._clock, self._frames = bus, clock, frames
        self._fleet, self._robot = fleet, robot
        self._heartbeat_due = self._frame_due = 0
        self._sequence = 0

    def heartbeat_due(self) -> bool:
        """It is time for a sign of life."""
        return self._clock.monotonic_ns() >= self._heartbeat_due

    def beat(self, heartbeat: RobotHeartbeat) -> None:
        """Publish a sign of life; the next one is due in half a second."""
        self._heartbeat_due = self._clock.monotonic_ns() + HEARTBEAT_NS
        self._bus.put(robot_key(self._fleet, self._robot, "heartbeat"), encode(heartbeat))

    def show(self, robot: Robot, rollout: Rollout) -> None:
        """Publish pictures of the cameras that somebody watches, when a frame is due."""
        now = self._clock.monotonic_ns()
        if now < self._frame_due:
            return
        self._frame_due = now + int(1e9 / self._frames.rate_hz)
        for camera in CAMERAS:
            key = robot_key(self._fleet, self._robot, f"frame-{camera}")
            if self._bus.watched(key):
                self._publish(key, camera, robot, rollout)

    def _publish(self, key: str, camera: str, robot: Robot, rollout: Rollout) -> None:
        picture = robot.picture(camera, self._frames.width, self._frames.height)
        jpeg = simplejpeg.encode_jpeg(
            np.ascontiguousarray(picture), quality=self._frames.quality, colorspace="RGB"
        )
        self._sequence += 1
        frame = Frame(
            robot=self._robot,
            episode=rollout.episode,
            step=rollout.step,
            camera=camera,
            sequence=self._sequence,
            time_ns=self._clock.now_ns(),
            arrays={"jpeg": np.frombuffer(jpeg, np.uint8)},
        )
        self._bus.put(key, encode(frame), Urgency.BACKGROUND, droppable=True)
