"""Episodes that a scripted person watches and corrects, in lockstep and without a bus.

What comes out are the messages that a robot and the correction API would have sent: an experiment
keeps them in a learner's store and learns from them as a learner does.

Source: Kelly et al. 2019 (HG-DAgger, arXiv 1810.02890) for who decides when to interfere.
"""

from collections import Counter
from collections.abc import Iterator
from itertools import groupby
from typing import Annotated, NamedTuple

import torch
from pydantic import Field

from shared.clock import ManualClock
from shared.config import Settings
from shared.evaluation.attempts import Row
from shared.evaluation.episode import Levels, levels_of
from shared.evaluation.plan import Case, Plan
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode, Outcome
from shared.messages.goal import Goal
from shared.messages.receipt import Receipt
from shared.rollout.rollout import Rollout
from shared.rollout.thinking import Lockstep
from shared.workcell import person
from shared.workcell.person import Habits
from shared.workcell.station import Station

Said = Decision | Correction | Receipt | Episode


class Person(Habits):
    """Who watches.

    delay_steps: control steps from a decision to the effect of what is said about it.
    hold_steps: how long an override holds; None: until it is released.
    approve: say so where a command is right, at each decision; else nothing is said there.
    endorse: say once, after an episode that succeeded, that the rest was right.
    review_every: after the first round, every so many episodes are left to the robot and gone
        through afterwards: each wrong stretch is relabelled, the rest endorsed; 0: none. Whoever
        always interferes never shows what to do after a mistake.
    """

    delay_steps: Annotated[int, Field(ge=0, le=10_000)] = 0
    hold_steps: Annotated[int, Field(ge=1, le=100_000)] | None = None
    approve: bool = False
    endorse: bool = False
    review_every: Annotated[int, Field(ge=0, le=1000)] = 0

    def reviews(self, round_: int, number: int) -> bool:
        """Whether they leave an episode alone and go through it afterwards.

        round_, number: as they are counted, from 1 and from 0.
        """
        every = self.review_every
        return round_ > 1 and every > 0 and number % every == every - 1


class Shift(Settings):
    """Who watches whom. plan: of the robot, as of an evaluation; its seeds are of no account.

    robot: its id in the messages.
    """

    plan: Plan
    person: Person = Person()
    robot: str = "robot-1"


class Turn(NamedTuple):
    """One episode: its seed, its task, and its id in the messages.

    reviewed: nobody interferes; the person goes through it afterwards.
    """

    seed: int
    task: str
    episode: str
    reviewed: bool = False


class Watched(NamedTuple):
    """What came of one. messages: in the order in which they would be sent.

    said: how often the person said what; "refused": the robot said no.
    """

    turn: Turn
    prompt: str
    success: bool
    progress: float
    steps: int
    decisions: int
    said: dict[str, int]
    messages: tuple[Said, ...]


class Watcher:
    """One process's robot and the person beside it."""

    def __init__(self, shift: Shift) -> None:
        torch.set_num_threads(1)  # The processes share the cores.
        self._shift = shift
        self._settings = shift.plan.rollout.model_copy(update={"supervised": True})
        self._station = Station(shift.plan.site, shift.plan.skills)
        self._levels: Levels = levels_of(shift.plan, self._station)

    def __call__(self, turn: Turn) -> Watched:
        """Roll out one episode, corrected at each decision that deserves it, then or afterwards."""
        scene = self._station.reset(turn.seed, turn.task, None)
        clock, messages, said = ManualClock(), list[Said](), Counter[str]()
        rollout = Rollout(
            self._station,
            self._levels.high,
            self._levels.low,
            Lockstep(self._settings.latency_steps),
            clock,
            self._settings.model_copy(update={"supervised": not turn.reviewed}),
            name=self._shift.robot,
            episode=turn.episode,
            scene=scene,
            decided=messages.append,
        )
        while not rollout.over:
            if rollout.awaited:
                for message in self._judge(rollout, rollout.awaited, said):
                    messages.append(message)
            if rollout.advance():
                clock.advance(int(1e9 / self._settings.control_hz))
        messages.append(
            Episode(
                id=turn.episode,
                robot=self._shift.robot,
                number=0,
                task=scene.task,
                prompt=scene.prompt,
                site=scene.site,
                seed=turn.seed,
                version=rollout.version,
                low_level_sha256=self._levels.low.sha256,
                outcome=Outcome.SUCCESS if rollout.done else Outcome.TIMEOUT,
                steps=rollout.step,
                decisions=rollout.decisions,
                corrections=rollout.corrections,
                asked=dict(rollout.asked),
                started_ns=0,
                ended_ns=clock.now_ns(),
            )
        )
        if turn.reviewed:
            decisions = [one for one in messages if isinstance(one, Decision)]
            for decision, end, text in self._wrong(decisions, rollout.step, said):
                messages.append(self._relabel(decision, end, text, clock.now_ns()))
                said[str(Kind.RELABEL)] += 1
        if turn.reviewed or (rollout.done and self._shift.person.endorse):
            messages.append(self._endorse(turn.episode, rollout.step, clock.now_ns()))
            said[str(Kind.ENDORSE)] += 1
        return Watched(
            turn,
            scene.prompt,
            rollout.done,
            round(self._station.progress, 4),
            rollout.step,
            rollout.decisions,
            dict(said),
            tuple(messages),
        )

    def live(self, case: Case) -> Row:
        """The same as an evaluation keeps it."""
        watched = self(Turn(case.seed, case.task, f"live-{case.seed}"))
        return Row(
            seed=case.seed,
            task=case.task,
            prompt=watched.prompt,
            success=watched.success,
            progress=watched.progress,
            steps=watched.steps,
            decisions=watched.decisions,
            asked=watched.said,
            low_level_sha256=self._levels.low.sha256,
        )

    def _judge(
        self, rollout: Rollout, decision: Decision, said: Counter[str]
    ) -> Iterator[Correction | Receipt]:
        """Say what there is to say of a decision, and let the robot go on."""
        verdict = person.judge(decision, self._shift.person)
        kind = Kind(str(verdict.kind))
        if kind is Kind.APPROVE and not self._shift.person.approve:
            kind = Kind.PASS
        correction = self._formulate(decision, kind, verdict.text)
        receipt = rollout.correct(correction)
        if not receipt.accepted:
            said["refused"] += 1
            rollout.correct(self._formulate(decision, Kind.PASS, None))
        else:
            said[str(kind)] += 1
            said["wrong"] += verdict.wrong
            said["missed"] += verdict.missed
        if kind is not Kind.PASS:
            yield correction
            yield receipt

    def _formulate(self, decision: Decision, kind: Kind, text: str | None) -> Correction:
        person_, override = self._shift.person, kind is Kind.OVERRIDE
        return Correction(
            id=f"{kind}-{decision.id}"[:64],
            robot=decision.robot,
            episode=decision.episode,
            kind=kind,
            author="oracle",
            goal=Goal(text=text) if override and text else None,
            decision=decision.id,
            seen_step=decision.step,
            hold_steps=person_.hold_steps if override else None,
            delay_steps=person_.delay_steps,
            begun_ns=decision.time_ns,
            created_ns=decision.time_ns,
        )

    def _wrong(
        self, decisions: list[Decision], steps: int, said: Counter[str]
    ) -> Iterator[tuple[Decision, int, str]]:
        """The stretches that the person calls wrong: the first decision, the step after the last,
        and what they say would have been right."""
        verdicts = [person.judge(decision, self._shift.person) for decision in decisions]
        said["missed"] += sum(verdict.missed for verdict in verdicts)
        texts = [
            verdict.text if verdict.kind == person.Kind.OVERRIDE else None for verdict in verdicts
        ]
        ends = [*(decision.step for decision in decisions[1:]), steps]
        for text, stretch in groupby(zip(texts, decisions, ends, strict=True), lambda one: one[0]):
            _, first, last = zip(*stretch, strict=True)
            if text is not None:
                yield first[0], last[-1], text

    def _relabel(self, decision: Decision, end: int, text: str, now_ns: int) -> Correction:
        return Correction(
            id=f"{Kind.RELABEL}-{decision.id}"[:64],
            robot=decision.robot,
            episode=decision.episode,
            kind=Kind.RELABEL,
            author="oracle",
            goal=Goal(text=text),
            first_step=decision.step,
            end_step=end,
            begun_ns=now_ns,
            created_ns=now_ns,
        )

    def _endorse(self, episode: str, steps: int, now_ns: int) -> Correction:
        """That all the rest of an episode was right; no robot has to hear it."""
        return Correction(
            id=f"{Kind.ENDORSE}-{episode}"[:64],
            robot=self._shift.robot,
            episode=episode,
            kind=Kind.ENDORSE,
            author="oracle",
            first_step=0,
            end_step=max(1, steps),
            begun_ns=now_ns,
            created_ns=now_ns,
        )

    def close(self) -> None:
        """Give the cell back."""
        self._station.close()


class Live:
    """Episodes of an evaluation in which the person corrects all along."""

    def __init__(self, shift: Shift) -> None:
        self._watcher = Watcher(shift)

    def __call__(self, case: Case) -> Row:
        """Roll out one episode; `asked` of its row counts what was said."""
        return self._watcher.live(case)

    def close(self) -> None:
        """Give the cell back."""
        self._watcher.close()
