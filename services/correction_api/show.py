"""Show: what is known, put as people and programs read it."""

import json
from collections.abc import Callable
from typing import Any

from pydantic import BaseModel

from services.correction_api.calls import Call
from services.correction_api.parts import Parts
from services.correction_api.phrases import look_up
from services.correction_api.store.log import Entry
from services.correction_api.views import (
    CorrectionView,
    CourseView,
    DecisionBrief,
    HelpQueue,
    HelpView,
    LearnerView,
    PeopleView,
    PersonView,
    PolicyView,
    Presence,
    RobotView,
)
from services.correction_api.watch import Force, Sight
from shared.messages.decision import Decision
from shared.messages.goal import LanguageGoal
from shared.messages.policy import is_version

SHOWN = {
    *("robot", "actor", "state", "task", "prompt", "site", "number", "step"),
    *("version", "supervised", "real_time", "pending", "pictures"),
}

PROPOSED = 3  # of a robot that asks for help


def show_robot(parts: Parts, name: str) -> RobotView:
    """One robot now.

    Raises:
        KeyError: no robot has this name.
    """
    sight = parts.watch.look(name)
    presence, age_s = parts.watch.presence(sight.heard_ns)
    force = sight.force if sight.episode else None
    return RobotView(
        **sight.heartbeat.model_dump(include=SHOWN),
        episode=sight.episode,
        presence=presence,
        age_s=round(age_s, 2),
        command=LanguageGoal(text=force.text) if force else None,
        by=_chooser(force) if force else None,
        chosen_by=force.chosen_by if force else None,
        author=parts.authors.get(force.chosen_by) if force else None,
        course=_course(sight),
        decision=_brief(sight),
    )


def show_help(parts: Parts) -> HelpQueue:
    """Who asks for help, but for those that have fallen silent."""
    views = [view for call in parts.calls.queue() if (view := _call(parts, call))]
    return HelpQueue(asking=views, suppressed=parts.calls.suppressed())


def show_decision(decision: Decision) -> dict[str, Any]:
    """A decision for the page: all but what only a scripted person may know."""
    return decision.model_dump(mode="json", exclude={"truth"})


def show_correction(parts: Parts, entry: Entry) -> CorrectionView:
    """A correction, with what the newest policy knows of its command."""
    goal = entry.correction.goal
    phrase = look_up(goal.text, known_phrases(parts, entry.correction.robot)) if goal else None
    return CorrectionView.of(entry, phrase)


def show_people(parts: Parts) -> PeopleView:
    """Who is here."""
    here = sorted(parts.live.people().items())
    return PeopleView(here=[PersonView(name=name, robots=sorted(said)) for name, said in here])


def show_learner(parts: Parts) -> LearnerView:
    """The learner now."""
    heartbeat, presence, age_s = parts.watch.learner_now()
    policy = parts.watch.announcement
    return LearnerView(
        **(heartbeat.model_dump() if heartbeat else {}),
        presence=presence,
        outbox=len(parts.parcels),
        age_s=round(age_s, 2) if heartbeat else None,
        policy=PolicyView.model_validate(policy, from_attributes=True) if policy else None,
    )


def known_phrases(parts: Parts, robot: str) -> tuple[str, ...]:
    """The commands of the low level; until a robot told them, those that the newest policy may
    choose, or else those that the robot's policy considered."""
    if commands := parts.lexicon.commands():
        return commands
    if policy := parts.watch.announcement:
        return policy.bank
    try:
        decision = parts.watch.look(robot).decision
    except KeyError:  # A robot of the history, not heard of since this service started.
        return ()
    return tuple(proposal.goal.text for proposal in decision.proposed) if decision else ()


def event(kind: str, content: Callable[[], BaseModel | dict[str, Any]]) -> Callable[[], str]:
    """A message for open pages, built when it is sent: {"type": kind, kind: content}."""

    def render() -> str:
        shown = content()
        model = (
            shown.model_dump(mode="json", exclude_none=kind == "learner")
            if isinstance(shown, BaseModel)
            else shown
        )
        return json.dumps({"type": kind, kind: model})

    return render


def _call(parts: Parts, call: Call) -> HelpView | None:
    try:
        sight = parts.watch.look(call.robot)
    except KeyError:  # Its first heartbeat is on the way.
        return None
    newest, silent = sight.decision, parts.watch.presence(sight.heard_ns)[0] is Presence.OFFLINE
    if silent or newest is None or newest.episode != sight.episode:
        return None
    return HelpView(
        robot=call.robot,
        episode=newest.episode,
        decision=call.help.decision,
        step=call.help.step,
        since_ns=call.help.time_ns,
        reason=call.help.reason,
        doubt=round(call.help.doubt, 3),
        waits_s=round(call.help.waits_s, 1),
        prompt=newest.prompt,
        command=LanguageGoal(text=sight.force.text) if sight.force else newest.executed,
        proposed=newest.proposed[:PROPOSED],
    )


def _course(sight: Sight) -> tuple[CourseView, ...]:
    return tuple(
        CourseView(step=force.step, text=force.text, by=_chooser(force))
        for force in sight.course
        if force.episode == sight.episode
    )


def _chooser(force: Force) -> str:
    return "policy" if is_version(force.chosen_by) else "person"


def _brief(sight: Sight) -> DecisionBrief | None:
    decision = sight.decision
    if decision is None or decision.episode != sight.episode:
        return None
    return DecisionBrief(
        id=decision.id,
        index=decision.index,
        step=decision.step,
        proposed=decision.proposed,
        awaits_verdict=decision.awaits_verdict,
    )
