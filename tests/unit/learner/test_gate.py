"""What keeps a candidate from the robots."""

from typing import Any, cast

import pytest

from services.learner.config import LearnerSettings
from services.learner.gate import Candidate, Figures, Gate, GateSettings, LabelGate, Verdict
from services.learner.held_out import fall_by_chance, keep_aside, split
from services.learner.labels.aggregate import Ground, Label
from services.learner.trials import TrialSettings
from shared.config import load
from shared.errors import ConfigError
from tests.unit.learner.test_learner_store import REF


def candidate(
    before: float | None = 0.5,
    after: float | None = 0.5,
    held_out: int = 40,
    finite: bool = True,
    retained: float | None = None,
    p: float | None = None,
) -> Candidate:
    figures = Figures(
        labels=90,
        labels_sha256="0" * 64,
        held_out=held_out,
        before=before,
        after=after,
        p=p,
        loss=1.0,
        finite=finite,
        seconds=1.0,
        retained=200,
        retained_before=0.9,
        retained_after=retained,
    )
    return Candidate(tensors=(REF,), bank=("wait",), settings={}, figures=figures)


GATE = LabelGate(GateSettings(at_least=20, max_fall=0.05, max_forgotten=0.05))


@pytest.mark.parametrize(
    ("made", "passed"),
    [
        (candidate(), True),
        (candidate(after=0.451), True),
        (candidate(after=0.449), False),
        (candidate(after=0.1, held_out=20), False),
        (candidate(held_out=19), False),
        (candidate(before=None, after=None, held_out=0), False),
        (candidate(after=0.9, finite=False), False),
        (candidate(after=0.9, retained=0.86), True),
        (candidate(after=0.9, retained=0.84), False),
    ],
)
def test_a_candidate_passes_unless_it_broke_or_agrees_less(made: Candidate, passed: bool) -> None:
    verdict = GATE.judge(made)
    assert verdict.passed is passed
    assert bool(verdict.reason) is not passed


@pytest.mark.parametrize(
    ("before", "after", "p", "passed"),
    [
        (0.31, 0.38, 0.69, False),
        (0.33, 0.74, 0.0001, True),
        (0.33, 0.31, 0.01, False),
        (0.5, 0.5, 1.0, True),
        (0.2, 0.3, None, True),  # Trained before this was told.
    ],
)
def test_who_follows_one_that_is_wrong_about_most_has_to_be_better_by_more_than_chance(
    before: float, after: float, p: float | None, passed: bool
) -> None:
    made = candidate(before, after, p=p)
    verdict = GATE.judge(made)
    assert verdict.passed is passed
    assert passed or "by more than chance" in verdict.reason
    assert LabelGate(GateSettings(chance=1.0)).judge(made).passed
    later = LabelGate(GateSettings(trials=TrialSettings(episodes=8))).judge(made)
    assert later.passed  # So far,
    assert bool(later.pending) is not passed


class Tried:
    """Trials that are over at once. outcomes: of the candidate, of the version in force."""

    def __init__(self, mine: int, its: int) -> None:
        self._outcomes = tuple([number < won for number in range(20)] for won in (mine, its))

    def begin(self, *policies: object) -> None:
        del policies

    def stop(self) -> None:
        pass

    def outcomes(self) -> tuple[list[bool], ...]:
        return self._outcomes


def after_trials(made: Candidate, mine: int, its: int) -> Verdict:
    settings = GateSettings(trials=TrialSettings(episodes=20))
    gate = Gate(settings, cast("Any", Tried(mine, its)))
    policy = cast("Any", None)  # Nobody looks at it.
    verdict = gate.begin(made, policy, policy) or gate.poll()
    assert verdict is not None
    return verdict


@pytest.mark.parametrize(
    ("p", "mine", "its", "passed"),
    [
        (0.77, 0, 0, False),
        (0.77, 4, 4, False),
        (0.77, 5, 4, False),
        (0.77, 8, 4, True),
        (0.01, 0, 0, True),
    ],
)
def test_what_learned_nothing_that_labels_show_has_to_show_it_in_trials(
    p: float, mine: int, its: int, passed: bool
) -> None:
    verdict = after_trials(candidate(0.31, 0.38, p=p), mine, its)
    assert verdict.passed is passed
    told = f"of 20 scenes it succeeds in {mine}, the version in force in {its}"
    assert (told in verdict.reason) is not passed


@pytest.mark.parametrize(("mine", "passed"), [(0, False), (1, True)])
def test_trials_judge_what_too_few_labels_do_not_unless_they_show_nothing(
    mine: int, passed: bool
) -> None:
    verdict = after_trials(candidate(held_out=3), mine, mine)
    assert (verdict.passed, verdict.unjudged) == (passed, "held out 3 labels, needs 20: not judged")


def test_a_refusal_tells_both_figures() -> None:
    assert "0.100 of 40" in GATE.judge(candidate(after=0.1)).reason
    assert "0.300 of 200 demonstrated" in GATE.judge(candidate(retained=0.3)).reason


def test_what_could_not_be_judged_says_so_and_stays_here_unless_somebody_lets_it_out() -> None:
    few = candidate(after=0.1, held_out=19)
    verdict = GATE.judge(few)
    assert verdict.unjudged == "held out 19 labels, needs 20: not judged"
    assert verdict.reason.startswith(verdict.unjudged)
    assert "gate.unjudged=let-out" in verdict.reason
    trials = TrialSettings(episodes=4)
    for settings, pending in (
        (GateSettings(unjudged="let-out"), ""),
        (GateSettings(unjudged="let-out", trials=trials), ""),
        (GateSettings(trials=trials), verdict.reason),
    ):
        let_on = LabelGate(settings).judge(few)
        assert let_on == (True, "", {}, verdict.unjudged, pending)
        forgetful = LabelGate(settings).judge(candidate(held_out=19, retained=0.1))
        assert not forgetful.passed
    assert GATE.judge(candidate()).unjudged == ""


def test_to_hold_out_nothing_is_refused_where_nothing_else_judges() -> None:
    none = "gate.held_out_share=0"
    with pytest.raises(ConfigError, match=r"gate\.unjudged=let-out"):
        load(LearnerSettings, "learner", sets=[none], environment={})
    for more in ("gate.unjudged=let-out", "gate.trials.episodes=4"):
        assert load(LearnerSettings, "learner", sets=[none, more], environment={})


def test_what_is_kept_aside_is_never_replayed_and_always_the_same() -> None:
    replayed, aside = keep_aside(1000, 200)
    assert (len(replayed), len(aside)) == (800, 200)
    assert not set(replayed) & set(aside)
    assert set(aside) == set(keep_aside(1000, 200)[1])
    assert list(map(len, keep_aside(9, 200))) == [5, 4]
    assert list(map(len, keep_aside(9, 0))) == [9, 0]


def labels(episodes: int) -> list[Label]:
    return [
        Label(f"e-{e}-{step}", f"e-{e}", "wait", 1.0, Ground.HELD, "c")
        for e in range(episodes)
        for step in range(3)
    ]


def test_held_out_labels_are_whole_episodes_and_stay_the_same_ones() -> None:
    few_kept, few_out = split(labels(100), 0.2)
    many_kept, many_out = split(labels(200), 0.2)
    assert {label.episode for label in few_kept}.isdisjoint(label.episode for label in few_out)
    assert 30 <= len(few_out) <= 90
    assert set(few_out) <= set(many_out)
    assert set(few_kept) <= set(many_kept)


def test_a_share_of_nothing_holds_nothing_out() -> None:
    assert split(labels(10), 0.0) == (labels(10), [])
    assert split(labels(10), 0.0, at_least=20) == (labels(10), [])


def test_a_small_round_holds_out_enough_to_be_judged_by_but_a_fifth_of_its_episodes_at_most() -> (
    None
):
    _, chance = split(labels(60), 1e-9)
    kept, out = split(labels(60), 1e-9, at_least=20)
    assert (chance, len(out), len(kept)) == ([], 21, 159)
    assert {label.episode for label in kept}.isdisjoint(label.episode for label in out)
    assert len(split(labels(20), 1e-9, at_least=20)[1]) == 3 * 4


@pytest.mark.parametrize(("few", "held_out"), [(1, 0), (2, 0), (3, 1), (4, 1), (9, 1), (10, 2)])
def test_a_first_round_of_few_episodes_holds_one_out(few: int, held_out: int) -> None:
    _, out = split(labels(few), 1e-9, at_least=20)
    assert len({label.episode for label in out}) == held_out


@pytest.mark.parametrize(("p_fall", "passed"), [(None, False), (0.2, False), (0.21, True)])
def test_a_fall_that_chance_explains_by_episode_is_borne(
    p_fall: float | None, passed: bool
) -> None:
    figures = candidate(before=0.93, after=0.87).figures.model_copy(update={"p_fall": p_fall})
    verdict = GATE.judge(candidate().model_copy(update={"figures": figures}))
    assert verdict.passed is passed
    assert ("gate.fall_chance=0.2" in verdict.reason) is (p_fall == 0.2)


def test_no_chance_excuses_a_great_fall() -> None:
    figures = candidate(before=0.9, after=0.7).figures.model_copy(update={"p_fall": 0.4})
    assert not GATE.judge(candidate().model_copy(update={"figures": figures})).passed
    borne = figures.model_copy(update={"after": 0.76})
    assert GATE.judge(candidate().model_copy(update={"figures": borne})).passed


def test_labels_of_one_episode_fall_as_one() -> None:
    three = labels(3)  # Three of each.
    knew, one_worse = [True] * 9, [False] * 3 + [True] * 6
    assert fall_by_chance(three, knew, [False] * 9) == 0.125
    assert fall_by_chance(three, [False] * 9, knew) == 1.0
    # What fewer than three show is no chance to be reckoned, however many stay as they were.
    for fallen in (one_worse, [False] * 6 + [True] * 3, knew):
        assert fall_by_chance(three, knew, fallen) is None
    five, worse = labels(5), [False] * 3 + [True] * 3 + [False, True, True] * 3
    assert fall_by_chance(five, [True] * 3 + [False] * 3 + [True] * 9, worse) == 0.3125


def test_of_a_small_round_what_the_version_in_force_never_learned_is_held_out_first() -> None:
    _, before = split(labels(10), 1e-9, at_least=6)
    taught = {f"e-{number}" for number in range(10)} - {label.episode for label in before}
    kept, out = split(labels(20), 1e-9, at_least=12, learned=taught)
    assert len({label.episode for label in out}) == 4
    assert {label.episode for label in out}.isdisjoint(taught)
    assert {label.episode for label in kept} >= taught
    _, all_taught = split(labels(10), 1e-9, at_least=6, learned={f"e-{n}" for n in range(10)})
    assert all_taught == before
