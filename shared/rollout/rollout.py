"""One episode of a hierarchy: the high level chooses goals, the low level acts, people correct.

The heart of the loop. `advance` moves the robot by one control step, `correct` takes a person's
word for the next one. Nothing here knows a bus, a simulator or a wall clock; whoever owns the
rollout calls it from one thread, as fast as the machine can (lockstep) or at 50 Hz (real time).

Source: the rollout of Shi et al. 2024 (arXiv 2403.12910), where a correction waits for the end
of the action chunk (up to 2 s); here it cuts the chunk at the next control step.
"""

from collections import deque
from collections.abc import Callable

import numpy as np

from shared.clock import Clock
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.messages.receipt import Receipt
from shared.rollout.override import Override
from shared.rollout.robot import HighLevel, LowLevel, Robot, Scene
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Proposals, Thinking


class Rollout:
    """One attempt at one task.

    step: the next control step to be executed, which is also how many have been.
    command: the goal in force; chosen_by: the policy version or the id of a correction.
    awaited: the decision for which the robot stands still, in supervised lockstep.
    paused: it stands still because a person said so.
    done: the task succeeded; over: the episode has ended, by success or by time.
    """

    def __init__(
        self,
        robot: Robot,
        high_level: HighLevel,
        low_level: LowLevel,
        thinking: Thinking,
        clock: Clock,
        settings: RolloutSettings,
        *,
        name: str,
        episode: str,
        scene: Scene,
        decided: Callable[[Decision], None] | None = None,
    ) -> None:
        """decided: told of each decision, in the thread that calls `advance`."""
        self._robot, self._high_level, self._low_level = robot, high_level, low_level
        self._thinking, self._clock, self._settings = thinking, clock, settings
        self._decided = decided
        self.name, self.episode, self.scene = name, episode, scene
        self.step, self.decisions, self.corrections = 0, 0, 0
        self.command: Goal | None = None
        self.chosen_by = ""
        self.awaited: Decision | None = None
        self.paused = self.done = False
        self._held: Override | None = None
        self._coming: list[Override] = []
        self._asked: Observation | None = None
        self._next_query = 0
        self._proposals: Proposals = ()
        self._chunk: deque[np.ndarray] = deque()
        self._history: deque[str] = deque(maxlen=settings.history)

    @property
    def version(self) -> Version:
        """The policy version that is asked at present."""
        return self._high_level.version

    def take_up(self, high_level: HighLevel) -> None:
        """Ask another high level from the next decision on."""
        self._high_level = high_level

    @property
    def over(self) -> bool:
        return self.done or self.step >= self._settings.max_steps

    def advance(self) -> bool:
        """Move by one control step, if nothing keeps the robot; True when it moved."""
        if self.over or self.paused or self.awaited:
            return False
        self._turn_overrides()
        self._think()
        if self.command is None or self.awaited:
            return False
        self.done = self._robot.step(self._next_action())
        self.step += 1
        return True

    # -- the high level, every n steps

    def _think(self) -> None:
        if self._asked is None and self.step >= self._next_query:
            self._asked = self._observe()
            self._next_query = self.step + self._settings.decision_steps
            self._thinking.ask(self._high_level, self._asked)
        # An episode's clock begins with its first command, so that the first answer is never late.
        grace = 0 if self.command else self._settings.latency_steps
        if self._asked is not None and (proposals := self._thinking.answer(self.step + grace)):
            self._decide(self._asked, proposals)
            self._asked = None

    def _observe(self) -> Observation:
        if self.command is not None:
            self._history.append(self.command.text)
        senses = self._robot.sense()
        return Observation(
            step=self.step,
            prompt=self.scene.prompt,
            previous=tuple(self._history),
            arrays={"images": self._robot.look(), **senses._asdict()},
        )

    def _decide(self, observation: Observation, proposals: Proposals) -> None:
        self._proposals = proposals
        if self._held is None:
            self._enforce(proposals[0].goal, str(self._high_level.version))
        assert self.command is not None  # Either held or just put in force.
        decision = Decision(
            id=f"{self.episode}-{self.decisions}",
            robot=self.name,
            episode=self.episode,
            index=self.decisions,
            step=observation.step,
            time_ns=self._clock.now_ns(),
            task=self.scene.task,
            prompt=observation.prompt,
            previous=observation.previous,
            proposed=proposals[: self._settings.top],
            executed=self.command,
            chosen_by=self.chosen_by,
            version=self._high_level.version,
            awaits_verdict=self._settings.supervised,
            truth=self._robot.truth(),
            arrays=observation.arrays,
        )
        self.decisions += 1
        self.awaited = decision if self._settings.supervised else None
        if self._decided:
            self._decided(decision)

    # -- the low level, every step

    def _next_action(self) -> np.ndarray:
        if not self._chunk:
            assert self.command is not None
            senses = self._robot.sense()
            chunk = self._low_level.act(senses.proprioception, senses.objects, self.command)
            self._chunk.extend(chunk[: self._settings.execute_steps])
        return np.asarray(self._chunk.popleft(), dtype=np.float64)

    def _enforce(self, goal: Goal, chosen_by: str) -> None:
        if goal != self.command:
            self._chunk.clear()  # A new command never waits for the end of a chunk.
        self.command, self.chosen_by = goal, chosen_by

    # -- people

    def correct(self, correction: Correction) -> Receipt:
        """Obey from the next control step on, or refuse and say why."""
        reason = self._objection(correction)
        if reason:
            return self._receipt(correction, None, reason=reason)
        return self._OBEY[correction.kind](self, correction)

    def _objection(self, correction: Correction) -> str:
        if correction.episode != self.episode:
            return f"episode {correction.episode} is over; the current one is {self.episode}"
        if self.over:
            return f"episode {self.episode} is over; wait for the next one"
        if correction.decision and not self._took(correction.decision):
            newest = f"the newest is {self.episode}-{self.decisions - 1}" if self.decisions else ""
            return f"no decision {correction.decision} in this episode; {newest or 'none so far'}"
        if correction.kind is Kind.RELEASE and not self._held:
            return "no override holds, so there is nothing to release"
        if correction.kind is Kind.RESUME and not self.paused:
            return "the robot is not paused, so there is nothing to resume"
        return ""

    def _took(self, decision: str) -> bool:
        """Whether a decision of this id was taken in this episode."""
        episode, _, index = decision.rpartition("-")
        return episode == self.episode and index.isdecimal() and int(index) < self.decisions

    def _override(self, correction: Correction) -> Receipt:
        assert correction.goal is not None  # Its model says so.
        begin = self.step
        if correction.delay_steps and self.awaited:
            begin = max(begin, self.awaited.step + correction.delay_steps)
        end = begin + correction.hold_steps if correction.hold_steps else None
        replaced = self._held.correction if self._held else None
        # What was to begin earlier still does, as its receipt says; what was to begin later not.
        self._coming = [override for override in self._coming if override.begin < begin]
        self._coming.append(Override(correction.id, correction.goal, begin, end))
        self._turn_overrides()
        self.corrections += 1
        self._ask_again()
        self._acquit(correction)
        return self._receipt(correction, begin, replaced)

    def _release(self, correction: Correction) -> Receipt:
        replaced = self._held.correction if self._held else None
        self._held = None
        self._give_back()
        self._ask_again()
        self._acquit(correction)
        return self._receipt(correction, self.step, replaced)

    def _approve(self, correction: Correction) -> Receipt:
        self._acquit(correction)
        return self._receipt(correction, self.step)

    def _pause(self, correction: Correction) -> Receipt:
        self.paused = True
        return self._receipt(correction, self.step)

    def _resume(self, correction: Correction) -> Receipt:
        self.paused = False
        return self._receipt(correction, self.step)

    _OBEY = {
        Kind.OVERRIDE: _override,
        Kind.RELEASE: _release,
        Kind.APPROVE: _approve,
        Kind.PASS: _approve,
        Kind.PAUSE: _pause,
        Kind.RESUME: _resume,
    }

    def _acquit(self, correction: Correction) -> None:
        if self.awaited and correction.decision in (None, self.awaited.id):
            self.awaited = None

    def _ask_again(self) -> None:
        """After an interjection the high level looks at once, unless it just did (Hi Robot)."""
        if self.awaited is None:
            self._next_query = self.step

    def _turn_overrides(self) -> None:
        """Let what has expired go, and what is due begin."""
        if self._held and self._held.over(self.step):
            self._held = None
            self._give_back()
            self._next_query = self.step
        while self._coming and self.step >= self._coming[0].begin:
            self._held = self._coming.pop(0)
            self._enforce(self._held.goal, self._held.correction)

    def _give_back(self) -> None:
        """Nobody's word holds any longer: the high level's last proposal does."""
        if self._proposals:
            self._enforce(self._proposals[0].goal, str(self._high_level.version))

    def _receipt(
        self,
        correction: Correction,
        step: int | None,
        replaced: str | None = None,
        reason: str = "",
    ) -> Receipt:
        return Receipt(
            correction=correction.id,
            robot=self.name,
            episode=correction.episode,
            accepted=step is not None,
            step=step,
            replaced=replaced,
            reason=reason,
            time_ns=self._clock.now_ns(),
        )
