"""What a person says about a decision: as little as is needed, and now and then something wrong."""

import pytest

from shared.errors import WorkcellError
from shared.workcell.person import Habits, Kind, Verdict, judge
from tests.unit.oracle.scenes import scene, seen

PERFECT = Habits()
BREAD, CHEESE, TOAST = "pick up the bread", "pick up the cheese", "pick up the toast"
PLATE, DOWN = "put it on the plate", "put it down"
HELD = "oracle-0123456789abcdef"


@pytest.mark.parametrize(
    ("state", "executed", "top", "chosen_by", "verdict"),
    [
        (scene(), BREAD, BREAD, "1.0", Verdict(Kind.APPROVE)),
        (scene(), CHEESE, CHEESE, "1.0", Verdict(Kind.OVERRIDE, BREAD)),
        (scene("bread"), TOAST, TOAST, "1.0", Verdict(Kind.OVERRIDE, CHEESE)),
        (scene("bread", hand="cheese"), PLATE, PLATE, "1.0", Verdict(Kind.APPROVE)),
        (scene(hand="toast"), PLATE, PLATE, "1.0", Verdict(Kind.OVERRIDE, DOWN)),
        (scene("ham"), BREAD, BREAD, "1.0", Verdict(Kind.OVERRIDE, "pick up the ham")),
        (scene("bread", "cheese", "toast"), BREAD, BREAD, "1.0", Verdict(Kind.OVERRIDE, "wait")),
        (scene(), BREAD, BREAD, HELD, Verdict(Kind.RELEASE)),
        (scene(), BREAD, CHEESE, HELD, Verdict(Kind.APPROVE)),
        (scene("bread"), BREAD, CHEESE, HELD, Verdict(Kind.RELEASE)),
        (scene("bread"), BREAD, TOAST, HELD, Verdict(Kind.OVERRIDE, CHEESE)),
    ],
)
def test_it_says_no_more_than_is_needed(
    state: object, executed: str, top: str, chosen_by: str, verdict: Verdict
) -> None:
    previous = (executed,)
    told = seen(state, executed, top=top, chosen_by=chosen_by, previous=previous)
    assert judge(told, PERFECT) == verdict


def test_a_missed_decision_is_passed_and_never_approved() -> None:
    blind = Habits(miss_rate=1.0)
    for executed in (BREAD, CHEESE):
        assert judge(seen(scene(), executed), blind) == Verdict(Kind.PASS, missed=True)


def test_a_slip_of_the_tongue_is_never_right_by_chance() -> None:
    clumsy = Habits(wrong_phrase_rate=1.0)
    said = {judge(seen(scene(seed=seed), CHEESE), clumsy) for seed in range(40)}
    assert {(verdict.kind, verdict.wrong) for verdict in said} == {(Kind.OVERRIDE, True)}
    assert BREAD not in {verdict.text for verdict in said}
    assert len(said) > 4


def test_rates_are_met_and_hang_on_the_scene_and_the_seed_alone() -> None:
    settings = Habits(miss_rate=0.3, seed=5)
    scenes = [scene(seed=seed) for seed in range(200)]
    missed = [judge(seen(state, BREAD), settings).missed for state in scenes]
    assert 0.2 < sum(missed) / len(missed) < 0.4
    again = [judge(seen(state, BREAD, name="ep-9-0"), settings).missed for state in scenes]
    assert again == missed
    other = settings.model_copy(update={"seed": 6})
    assert [judge(seen(state, BREAD), other).missed for state in scenes] != missed


def test_a_prompt_that_it_does_not_understand_is_an_error_and_no_verdict() -> None:
    with pytest.raises(WorkcellError):
        judge(seen(scene(), BREAD, prompt="fold the towel"), PERFECT)


def test_what_a_prompt_meant_when_the_episode_began_is_taken_from_the_truth() -> None:
    """Left and right are the start's: things may have been moved since."""
    state, prompt = scene(), "pack only what is on the left into the bin"
    told = seen(state, "pick up the ham", prompt=prompt, task="pack")
    settled = {**told.truth, "brief": {"target": ["ham"], "ordered": False}, "disturbed": 1}
    assert judge(told.model_copy(update={"truth": settled}), PERFECT) == Verdict(Kind.APPROVE)
    settled["brief"] = {"target": ["cheese"], "ordered": False}
    verdict = judge(told.model_copy(update={"truth": settled}), PERFECT)
    assert verdict == Verdict(Kind.OVERRIDE, "pick up the cheese")


def test_a_slip_of_the_tongue_names_only_what_is_there() -> None:
    clumsy = Habits(wrong_phrase_rate=1.0)
    said = {judge(seen(scene(seed=seed), CHEESE), clumsy).text for seed in range(60)}
    assert not any(word in str(text) for text in said for word in ("cup", "can", "napkin", "tub"))
