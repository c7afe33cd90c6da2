"""Observe: tell the fleet what a robot does, and show pictures while somebody watches."""

import contextlib
import queue
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import simplejpeg
import structlog

from services.actor.config import FrameSettings
from services.actor.throttle import Throttle
from shared.clock import Clock
from shared.errors import NoAnswerError
from shared.messages.frame import Channel, Frame, Rate
from shared.messages.heartbeat import RobotHeartbeat
from shared.messages.observation import CAMERAS
from shared.rollout.robot import Photographer, Robot
from shared.rollout.rollout import Rollout
from shared.wire.bus import Bus, Urgency
from shared.wire.codec import encode
from shared.wire.keys import robot_key

HEARTBEAT_NS = 500_000_000
CLOSE_WITHIN_S = 2.0
log = structlog.get_logger()


class _Moment(NamedTuple):
    """What a picture is made from."""

    robot: Robot
    snapshot: Any
    channels: dict[Channel, int]  # to the sequence number of the picture
    episode: str
    step: int
    time_ns: int


class Observer:
    """What one robot tells of itself, at most as often as is useful.

    What is watched at both rates is drawn once, and what nobody watches not at all.

    Pictures are asked for in a thread of its own: a control step takes 20 ms, a picture may take
    as long. While one is being drawn the newest moment waits, and the one before is skipped;
    `sequence` counts it all the same, so that whoever watches sees the gap.
    """

    def __init__(
        self,
        bus: Bus,
        fleet: str,
        robot: str,
        clock: Clock,
        frames: FrameSettings,
        throttle: Throttle,
        drawn: Callable[[], Photographer] | None = None,
    ) -> None:
        """throttle: how much of their rate pictures get.

        drawn: makes who draws elsewhere, where snapshots are numbers; else it is done here."""
        self._bus, self._clock, self._frames, self._throttle = bus, clock, frames, throttle
        channels = (Channel(camera, rate) for rate in Rate for camera in CAMERAS)
        self._keys = {channel: robot_key(fleet, robot, channel.message) for channel in channels}
        self._slow_every = max(1, round(frames.rate_hz / frames.slow_hz))
        self._heartbeat_key = robot_key(fleet, robot, "heartbeat")
        self._name, self._drawn = robot, drawn
        self._heartbeat_due = self._frame_due = self._turns = 0
        self._sequence = dict.fromkeys(self._keys, 0)
        self._waiting: queue.Queue[_Moment | None] = queue.Queue(1)
        self._thread = threading.Thread(target=self._draw, name=f"pictures-{robot}", daemon=True)
        self._thread.start()

    @property
    def share(self) -> float:
        """How much of their rate pictures get."""
        return self._throttle.share

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
        self._frame_due = now + int(1e9 / (self._frames.rate_hz * self.share))
        watched = [channel for channel in self._due() if self._bus.watched(self._keys[channel])]
        for channel in watched:
            self._sequence[channel] += 1
        if watched:
            channels = {channel: self._sequence[channel] for channel in watched}
            snapshot, time_ns = robot.snapshot(), self._clock.now_ns()
            self._offer(_Moment(robot, snapshot, channels, rollout.episode, rollout.step, time_ns))

    def _due(self) -> list[Channel]:
        """Every so many turns the slow ones, too, so that one picture does for both."""
        slow = self._turns % self._slow_every == 0
        self._turns += 1
        return [channel for channel in self._keys if slow or channel.rate is Rate.FULL]

    def close(self) -> None:
        """Draw no more; a picture that takes its time is not waited for."""
        self._offer(None)
        self._thread.join(CLOSE_WITHIN_S)

    def _offer(self, moment: _Moment | None) -> None:
        while True:
            try:
                return self._waiting.put_nowait(moment)
            except queue.Full:
                with contextlib.suppress(queue.Empty):  # Else it was taken just now.
                    self._waiting.get_nowait()

    def _draw(self) -> None:
        photographer: Photographer | None = None
        while (moment := self._waiting.get()) is not None:
            try:
                photographer = photographer or self._hire(moment)
                for camera in dict.fromkeys(channel.camera for channel in moment.channels):
                    jpeg = self._picture(moment, camera, photographer)
                    self._publish(moment, camera, jpeg)
            except NoAnswerError as error:
                log.info("no picture", robot=self._name, reason=str(error))
            except Exception:  # It must not end the pictures, let alone the robot.
                log.exception("no picture", robot=self._name)
        if photographer:
            photographer.close()

    def _hire(self, moment: _Moment) -> Photographer:
        if self._drawn and isinstance(moment.snapshot, np.ndarray):
            return self._drawn()
        return moment.robot.photographer()

    def _picture(self, moment: _Moment, camera: str, photographer: Photographer) -> bytes:
        frames = self._frames
        picture = photographer.picture(moment.snapshot, camera, frames.width, frames.height)
        jpeg: bytes = simplejpeg.encode_jpeg(
            np.ascontiguousarray(picture), quality=frames.quality, colorspace="RGB"
        )
        return jpeg

    def _publish(self, moment: _Moment, camera: str, jpeg: bytes) -> None:
        for channel, sequence in moment.channels.items():
            if channel.camera != camera:
                continue
            frame = Frame(
                robot=self._name,
                episode=moment.episode,
                step=moment.step,
                camera=camera,
                sequence=sequence,
                time_ns=moment.time_ns,
                arrays={"jpeg": np.frombuffer(jpeg, np.uint8)},
            )
            key = self._keys[channel]
            self._bus.put(key, encode(frame), Urgency.BACKGROUND, droppable=True)
