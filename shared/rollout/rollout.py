"""One episode of a hierarchy: the high level chooses goals, the low level acts, people correct.

The heart of the loop. `advance` moves the robot by one control step, `correct` takes a person's
word for the next one. Nothing here knows a bus, a simulator or a wall clock; whoever owns the
rollout calls it from one thread, as fast as the machine can (lockstep) or at 50 Hz (real time).

Source: the rollout of Shi et al. 2024 (arXiv 2403.12910), where a correction waits for the end
of the action chunk (up to 2 s); here it cuts the chunk at the next control step.
"""

from collections import Counter, deque
from collections.abc import Callable

import numpy as np

from shared.clock import Clock
from shared.messages.correction import AFTERWARDS, Correction, Kind
from shared.messages.decision import Asked, Choice, Decision
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.messages.receipt import Receipt
from shared.rollout.answering import Moment, answer, objection
from shared.rollout.asking import Asking, Question
from shared.rollout.choosing import Choosing
from shared.rollout.looks import Looks
from shared.rollout.override import Override, Overrides, override_of
from shared.rollout.robot import HighLevel, LowLevel, Robot, Scene
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Proposals, Thinking


class Rollout:
    """One attempt at one task.

    step: the next control step to be executed, which is also how many have been.
    asked: how many decisions there were, by why the high level was asked.
    command: the goal in force; chosen_by: the policy version or the id of a correction.
    awaited: the decision for which the robot stands still: supervised, or since it asks for help.
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
        self._max_steps = settings.max_steps or scene.steps
        self.step, self.decisions, self.corrections = 0, 0, 0
        self.asked: Counter[Asked] = Counter()
        self.command: Goal | None = None
        self.chosen_by = ""
        self.awaited: Decision | None = None
        self.paused = self.done = False
        self._overrides = Overrides()
        self._asking, self._choosing = Asking(settings), Choosing(settings)
        self._looks = Looks(settings.looks, settings.look_every)
        self._question: Question | None = None
        self._since = 0  # The first control step of the command in force.
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
        return self.done or self.step >= self._max_steps

    def advance(self) -> bool:
        """Move by one control step, if nothing keeps the robot; True when it moved."""
        if self.over or self.paused or self.awaited:
            return False
        self._turn_overrides()
        self._check()
        self._think()
        if self.command is None or self.awaited:
            return False
        self.done = self._robot.step(self._next_action())
        self.step += 1
        return True

    # -- the high level, now and then

    def _check(self) -> None:
        """Where a chunk is to be fetched: is the command achieved already?"""
        if self._chunk or self.command is None or not self._asking.checks(self.step):
            return
        completion = self._low_level.completion(*self._robot.sense(), self.command)
        self._asking.judge(completion, self.step)

    def _think(self) -> None:
        if self._question is None and (why := self._asking.due(self.step)):
            past = self._looks.past()
            self._question = Question(self._observe(), tuple(past), why)
            self._asking.put(why, self.step)
            self._thinking.ask(self._high_level, self._question.observation, tuple(past.values()))
        # An episode's clock begins with its first command, so that the first answer is never late.
        grace = 0 if self.command else self._settings.latency_steps
        if self._question and (proposals := self._thinking.answer(self.step + grace)):
            self._decide(self._question, proposals)
            self._question = None

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

    def _decide(self, question: Question, proposals: Proposals) -> None:
        observation = question.observation
        choice = self._choose(question, proposals)
        assert self.command is not None  # Either held or just put in force.
        decision = Decision(
            id=f"{self.episode}-{self.decisions}",
            robot=self.name,
            episode=self.episode,
            index=self.decisions,
            step=observation.step,
            time_ns=self._clock.now_ns(),
            asked=question.why,
            task=self.scene.task,
            prompt=observation.prompt,
            previous=observation.previous,
            past=question.past,
            proposed=proposals[: self._settings.top],
            executed=self.command,
            chosen_by=self.chosen_by,
            choice=choice,
            version=self._high_level.version,
            awaits_verdict=self._settings.supervised,
            truth=self._robot.truth(),
            arrays=observation.arrays,
        )
        self.decisions += 1
        self.asked[question.why] += 1
        self._looks.add(observation.arrays["images"])
        self.awaited = decision if self._settings.supervised else None
        if self._decided:
            self._decided(decision)

    def _choose(self, question: Question, proposals: Proposals) -> Choice:
        """Put in force what follows from the proposals, unless a person's word holds."""
        objects = question.observation.arrays["objects"]
        held = self._overrides.held is not None
        steady = question.why is Asked.INTERVAL and not held and not self._asking.achieved
        choice = self._choosing.choose(
            proposals,
            str(self._high_level.version),
            lambda goal: not self._low_level.can(goal, objects),
            self.step - self._since if steady else None,
        )
        if held:
            return Choice.HELD
        self._give_back()
        return choice

    # -- the low level, every step

    def _next_action(self) -> np.ndarray:
        if not self._chunk:
            assert self.command is not None
            chunk = self._low_level.act(*self._robot.sense(), self.command)
            self._chunk.extend(chunk[: self._settings.execute_steps])
        return np.asarray(self._chunk.popleft(), dtype=np.float64)

    def _enforce(self, goal: Goal, chosen_by: str) -> None:
        if goal != self.command:
            self._chunk.clear()  # A new command never waits for the end of a chunk.
            self._asking.changed(self.step)
            self._since = self.step
        self.command, self.chosen_by = goal, chosen_by

    # -- people

    def correct(self, correction: Correction) -> Receipt:
        """Obey from the next control step on, or refuse and say why."""
        if why := self._objection(correction):
            return self._receipt(correction, None, why=why)
        return self._OBEY[correction.kind](self, correction)

    def _objection(self, correction: Correction) -> str:
        held = self._overrides.held is not None
        moment = Moment(self.episode, self.over, self.decisions, held, self.paused)
        if why := objection(correction, moment):
            return why
        for_now = correction.kind is Kind.OVERRIDE or self._overrides.knows(correction.target)
        if correction.goal is not None and for_now and not self.over:
            return self._low_level.objection(*self._robot.sense(), correction.goal)
        return ""

    def _override(self, correction: Correction) -> Receipt:
        override = override_of(correction, self.step, self.awaited.step if self.awaited else None)
        replaced = self._overrides.held_by
        self._overrides.put(override)
        self._turn_overrides()
        self.corrections += 1
        self._ask_again()
        self._acquit(correction)
        return self._receipt(correction, override.begin, replaced)

    def _release(self, correction: Correction) -> Receipt:
        replaced = self._overrides.release()
        self._give_back()
        self._ask_again()
        self._acquit(correction)
        return self._receipt(correction, self.step, replaced)

    def _approve(self, correction: Correction) -> Receipt:
        self._acquit(correction)
        return self._receipt(correction, self.step)

    def _pause(self, correction: Correction) -> Receipt:
        self.paused = correction.kind is Kind.PAUSE
        return self._receipt(correction, self.step)

    def _retract(self, correction: Correction) -> Receipt:
        replaced = self._overrides.withdraw(correction.target)
        if replaced:
            self._give_back()
            self._ask_again()
        else:
            self._put_otherwise(self._overrides.unsay(correction.target))
        return self._receipt(correction, self.step, replaced)

    def _edit(self, correction: Correction) -> Receipt:
        held = self._overrides.reword(correction)
        self._put_otherwise(held)
        return self._receipt(correction, self.step, held and held.correction)

    def _put_otherwise(self, held: Override | None) -> None:
        if held:
            self._enforce(held.goal, held.correction)
            self._ask_again()

    _OBEY = {
        Kind.OVERRIDE: _override,
        Kind.RELEASE: _release,
        Kind.RETRACT: _retract,
        Kind.EDIT: _edit,
        **dict.fromkeys((Kind.PAUSE, Kind.RESUME), _pause),
        **dict.fromkeys((Kind.APPROVE, Kind.PASS), _approve),
        **dict.fromkeys((Kind.RETIME, Kind.RELABEL, Kind.FAULT, Kind.ENDORSE), _approve),
    }

    def _acquit(self, correction: Correction) -> None:
        # Who takes back or tells of the past has not said what is right at the one that waits.
        verdict = correction.kind not in AFTERWARDS
        if self.awaited and verdict and correction.decision in (None, self.awaited.id):
            self.awaited = None

    def _ask_again(self) -> None:
        """After an interjection the high level looks at once, unless it just did (Hi Robot)."""
        if self.awaited is None:
            self._asking.want(Asked.INTERJECTION)

    def _turn_overrides(self) -> None:
        """Let what has expired go, and what is due begin."""
        if self._overrides.expire(self.step):
            self._give_back()
            self._asking.want(Asked.EXPIRY)
        if begun := self._overrides.begin(self.step):
            self._enforce(begun.goal, begun.correction)

    def _give_back(self) -> None:
        """Nobody's word holds: what the high level would have had in force all along does."""
        if self._choosing.goal:
            self._enforce(self._choosing.goal, self._choosing.chosen_by)

    def _receipt(
        self, correction: Correction, step: int | None, replaced: str | None = None, why: str = ""
    ) -> Receipt:
        now_ns = self._clock.now_ns()
        return answer(correction, self.name, step, now_ns, replaced=replaced, why=why)
