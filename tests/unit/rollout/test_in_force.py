"""What was in force follows from decisions, corrections and receipts, whatever is said."""

from hypothesis import given, settings
from hypothesis import strategies as st

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from tests.unit.rollout.fakes import CountingRobot, rollout_of, said

words = st.tuples(
    st.integers(0, 60),
    st.sampled_from([Kind.OVERRIDE, Kind.RELEASE, Kind.APPROVE, Kind.RETRACT, Kind.EDIT]),
    st.sampled_from(["up", "down", "sideways"]),
    st.one_of(st.none(), st.integers(1, 30)),
    st.integers(0, 7),
)


@settings(max_examples=60, deadline=None)
@given(st.lists(words, max_size=8))
def test_the_command_in_force_follows_from_decisions_corrections_and_receipts(spoken):
    """Nothing but what travels is needed to know what was in force at each step."""
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of("left", robot=robot, decisions=decisions, decision_steps=10)
    told = []
    for at, kind, text, hold, about in sorted(spoken, key=lambda word: word[0]):
        while rollout.step < at:
            rollout.advance()
        correction = said(
            kind,
            text if kind in (Kind.OVERRIDE, Kind.EDIT) else None,
            hold_steps=hold if kind is Kind.OVERRIDE else None,
            target=named(told, about) if kind in (Kind.RETRACT, Kind.EDIT) else None,
        )
        told.append((correction, rollout.correct(correction)))
    while rollout.step < 80:
        rollout.advance()
    for step, action in enumerate(robot.actions):
        assert int(action[0]) == len(in_force(step, told) or "left")


def named(told, about):
    """The id of something that was said before, if anything was."""
    return told[about % len(told)][0].id if told else "co-gone"


def in_force(step, told):
    """The override that holds at `step`, from corrections and receipts alone."""
    wordings, holder, end = {}, None, None
    for correction, receipt in told:
        if not receipt.accepted or receipt.step > step:
            continue
        if end is not None and receipt.step >= end:
            wordings, holder, end = {}, None, None
        if correction.kind is Kind.OVERRIDE:
            wordings, holder = {correction.id: correction.goal.text}, correction.id
            end = receipt.step + correction.hold_steps if correction.hold_steps else None
        elif correction.kind is Kind.EDIT and correction.target == holder:
            wordings[correction.id] = correction.goal.text
        elif correction.kind is Kind.RELEASE or (
            correction.kind is Kind.RETRACT and correction.target == holder
        ):
            wordings, holder, end = {}, None, None
        elif correction.kind is Kind.RETRACT:
            wordings.pop(correction.target, None)
    over = not wordings or (end is not None and step >= end)
    return None if over else list(wordings.values())[-1]
