"""Observe: tell the fleet what a robot does, and show pictures while somebody watches."""

import contextlib
import os
import queue
import sys
import threading
from typing import Any, NamedTuple

import numpy as np
import simplejpeg
import structlog

from services.actor.config import FrameSettings
from shared.clock import Clock
from shared.messages.frame import Frame
from shared.messages.heartbeat import RobotHeartbeat
from shared.messages.observation import CAMERAS
from shared.rollout.robot import Photographer, Robot
from shared.rollout.rollout import Rollout
from shared.wire.bus import Bus, Urgency
from shared.wire.codec import encode
from shared.wire.keys import robot_key

HEARTBEAT_NS = 500_000_000
log = structlog.get_logger()


class _Moment(NamedTuple):
    """What a picture is made from."""

    robot: Robot
    snapshot: Any
    cameras: dict[str, int]  # to the sequence number of the picture
    episode: str
    step: int
    time_ns: int


class Observer:
    """What one robot tells of itself, at most as often as is useful.

    Pictures are drawn in a thread of their own: a control step takes 20 ms, a picture may take
    as long. While one is being drawn the newest moment waits, and the one before is skipped;
    `sequence` counts it all the same, so that whoever watches sees the gap.
    """

    def __init__(
        self, bus: Bus, fleet: str, robot: str, clock: Clock, frames: FrameSettings
    ) -> None:
        self._bus, self._clock, self._frames = bus, clock, frames
        self._keys = {camera: robot_key(fleet, robot, f"frame-{camera}") for camera in CAMERAS}
        self._heartbeat_key = robot_key(fleet, robot, "heartbeat")
        self._name = robot
        self._heartbeat_due = self._frame_due = 0
        self._sequence = dict.fromkeys(CAMERAS, 0)
        self._waiting: queue.Queue[_Moment | None] = queue.Queue(1)
        self._thread = threading.Thread(target=self._draw, name=f"pictures-{robot}", daemon=True)
        self._thread.start()

    def heartbeat_due(self) -> bool:
        """It is time for a sign of life."""
        return self._clock.monotonic_ns() >= self._heartbeat_due

    def beat(self, heartbeat: RobotHeartbeat) -> None:
        """Publish a sign of life; the next one is due in half a second."""
        self._heartbeat_due = self._clock.monotonic_ns() + HEARTBEAT_NS
        self._bus.put(self._heartbeat_key, encode(heartbeat))

    def show(self, robot: Robot, rollout: Rollout) -> None:
        """When a picture is due and somebody watches: hand this moment to who draws."""
        now = self._clock.monotonic_ns()
        if now < self._frame_due:
            return
        self._frame_due = now + int(1e9 / self._frames.rate_hz)
        watched = [camera for camera in CAMERAS if self._bus.watched(self._keys[camera])]
        for camera in watched:
            self._sequence[camera] += 1
        if watched:
            cameras = {camera: self._sequence[camera] for camera in watched}
            snapshot, time_ns = robot.snapshot(), self._clock.now_ns()
            self._offer(_Moment(robot, snapshot, cameras, rollout.episode, rollout.step, time_ns))

    def close(self) -> None:
        """Draw no more."""
        self._offer(None)
        self._thread.join()

    def _offer(self, moment: _Moment | None) -> None:
        while True:
            try:
                return self._waiting.put_nowait(moment)
            except queue.Full:
                with contextlib.suppress(queue.Empty):  # Else it was taken just now.
                    self._waiting.get_nowait()

    def _draw(self) -> None:
        if sys.platform == "linux":  # There a thread has a priority of its own: the robot first.
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 10)
        photographer: Photographer | None = None
        while (moment := self._waiting.get()) is not None:
            try:
                photographer = photographer or moment.robot.photographer()
                for camera in moment.cameras:
                    self._publish(moment, camera, photographer)
            except Exception:  # It must not end the pictures, let alone the robot.
                log.exception("no picture", robot=self._name)
        if photographer:
            photographer.close()

    def _publish(self, moment: _Moment, camera: str, photographer: Photographer) -> None:
        frames = self._frames
        picture = photographer.picture(moment.snapshot, camera, frames.width, frames.height)
        jpeg = simplejpeg.encode_jpeg(
            np.ascontiguousarray(picture), quality=frames.quality, colorspace="RGB"
        )
        frame = Frame(
            robot=self._name,
            episode=moment.episode,
            step=moment.step,
            camera=camera,
            sequence=moment.cameras[camera],
            time_ns=moment.time_ns,
            arrays={"jpeg": np.frombuffer(jpeg, np.uint8)},
        )
        self._bus.put(self._keys[camera], encode(frame), Urgency.BACKGROUND, droppable=True)
