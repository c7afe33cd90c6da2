"""Rounds under a scripted person: what is collected, what the arms learn, what is told of it."""

import shutil
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from services.learner.experiments.bench import Bench, Scale
from services.learner.experiments.dagger import compare
from services.learner.experiments.dagger.course import Course, place_of
from services.learner.experiments.dagger.figures import failed_commands, gap_closed, less
from services.learner.experiments.dagger.kept import bare
from services.learner.experiments.dagger.lessons import Treatment
from services.learner.experiments.dagger.scale import ARMS, CORE, FULL, MAIN, SMALL, DaggerSettings
from services.learner.experiments.dagger.targets import targets
from services.learner.experiments.dagger.watching import Person, Shift, Turn, Watcher
from services.learner.experiments.findings import Findings
from services.learner.experiments.report import describe
from services.learner.labels.aggregate import Ground, Label
from shared.errors import HldError
from shared.evaluation.attempts import Attempt, Row
from shared.evaluation.plan import Plan
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.policies.checkpoint import bundled, load_card
from shared.rollout.settings import RolloutSettings
from shared.seeds import COLLECTION
from shared.workcell.person import judge
from tests.unit.experiments.bench import Here, untold

LOW = load_card(bundled("low_level")).tensors_sha256
SHORT = RolloutSettings(max_steps=80)
TURN = Turn(COLLECTION.start + 3, "sandwich", "r1-e0")


def watch(person: Person, turn: Turn = TURN) -> Any:
    with closing(Watcher(Shift(plan=Plan(site="far", rollout=SHORT), person=person))) as watcher:
        return watcher(turn)


def test_a_person_who_speaks_only_against_mistakes_sends_what_a_robot_and_the_api_would() -> None:
    watched = watch(Person())
    decisions = [one for one in watched.messages if isinstance(one, Decision)]
    corrections = [one for one in watched.messages if isinstance(one, Correction)]
    assert [one.index for one in decisions] == list(range(4))
    assert isinstance(watched.messages[-1], Episode)
    assert {one.kind for one in corrections} <= {Kind.OVERRIDE, Kind.RELEASE}
    assert watched.said["override"] == watched.messages[-1].corrections > 0
    assert watch(Person()).messages[-1] == watched.messages[-1]


def test_a_late_person_is_obeyed_later_and_one_who_never_looks_says_nothing() -> None:
    receipts = [one for one in watch(Person(delay_steps=25)).messages if hasattr(one, "accepted")]
    assert receipts[0].step == 25
    assert not watch(Person(miss_rate=1.0)).said.get("override")


def test_who_endorses_an_episode_that_succeeded_labels_all_of_it_by_one_utterance(
    tmp_path: Path,
) -> None:
    shift = Shift(plan=Plan(site="lab", high_level="oracle"), person=Person(endorse=True))
    with closing(Watcher(shift)) as watcher:
        watched = watcher(TURN)
    assert watched.success
    with closing(Course(tmp_path / "course", LOW, 0)) as course:
        course.found(None)
        course.add(watched)
        course.begin(1, SMALL.recipe)
        effort, labels = course.effort(1, Person()), course.labels(1)
    assert (effort.overrides, effort.endorsements, effort.corrections) == (0, 1, 1)
    assert {label.ground for label in labels} == {Ground.ENDORSED}
    assert len(labels) == watched.decisions


def test_after_the_first_round_every_other_episode_is_left_alone_and_gone_through_afterwards(
    tmp_path: Path,
) -> None:
    both = Person(endorse=True, review_every=2)
    with closing(Course(tmp_path / "course", LOW, 0)) as course:
        course.found(None)
        assert not any(t.reviewed for t in course.missing(1, range(6), ("pack",), both))
        turns = course.missing(2, range(6), ("pack",), both)
        assert [turn.reviewed for turn in turns] == [False, True] * 3
        assert not any(t.reviewed for t in course.missing(2, range(6), ("pack",), Person()))
        watched = watch(both, TURN._replace(episode=turns[1].episode, reviewed=True))
        decisions = [one for one in watched.messages if isinstance(one, Decision)]
        said = [one for one in watched.messages if isinstance(one, Correction)]
        assert watched.messages[-1 - len(said)].corrections == 0  # The record: nobody spoke then.
        assert {one.kind for one in said[:-1]} == {Kind.RELABEL}
        assert said[-1].kind is Kind.ENDORSE
        course.add(watched)
        course.begin(1, SMALL.recipe)
        labels = {label.decision: label for label in course.labels(1)}
        assert set(labels) == {one.id for one in decisions}  # Each has its label,
        for one in decisions:  # which is what the truth says of that moment.
            verdict = judge(one, both)
            wrong = verdict.kind == "override"
            assert labels[one.id].text == (verdict.text if wrong else one.executed.text)
            assert labels[one.id].ground is (Ground.RELABELLED if wrong else Ground.ENDORSED)
        assert any(judge(one, both).kind == "override" for one in decisions)
        assert course.corrected_prompts(1) == {watched.prompt}  # Afterwards is spoken of it, too.


def test_who_misses_mistakes_misses_them_afterwards_too() -> None:
    blind = Person(endorse=True, review_every=2, miss_rate=1.0)
    watched = watch(blind, TURN._replace(episode="r2-e1", reviewed=True))
    assert watched.said == {"missed": watched.decisions, "endorse": 1}


def test_a_course_keeps_an_episode_once_and_knows_what_is_missing(tmp_path: Path) -> None:
    with closing(Course(tmp_path / "course", LOW, 0)) as course:
        course.found(None)
        turns = course.missing(1, range(2), ("sandwich", "pack"), Person())
        assert [(turn.task, turn.episode) for turn in turns] == [
            ("sandwich", "r1-e0"),
            ("pack", "r1-e1"),
        ]
        course.add(watch(Person(), turns[0]))
        course.add(watch(Person(), turns[0]))
        assert course.missing(1, range(2), ("sandwich", "pack"), Person()) == turns[1:]
    with closing(Course(tmp_path / "course", LOW, 0)) as course:
        round_ = course.begin(1, SMALL.recipe)
        assert round_ is not None
        assert course.begin(1, SMALL.recipe) == round_
        effort = course.effort(1, Person())
        assert (effort.episodes, effort.decisions) == (1, 4)
        labels = course.labels(1)
        assert {label.ground for label in labels} <= {
            Ground.OBJECTED,
            Ground.HELD,
            Ground.RELEASED,
        }
        assert len(labels) >= effort.overrides > 0
        assert course.staleness(1) == {"0": 1}


def labels() -> list[Label]:
    return [
        Label(f"r{r}-e{e}-0", f"r{r}-e{e}", f"text {r} {e}", 1.0, Ground.HELD, "c")
        for r in (1, 2, 3)
        for e in range(8)
    ]


def test_shuffled_labels_keep_their_words_and_their_weights_but_not_their_places() -> None:
    settings = SMALL.model_copy(update={"episodes": (8, 8, 8)})
    shuffled = Treatment(ARMS["shuffled"], settings, 0)(labels())
    assert sorted(label.text for label in shuffled) == sorted(label.text for label in labels())
    assert [label.decision for label in shuffled] == [label.decision for label in labels()]
    moved = [mine.text != its.text for mine, its in zip(shuffled, labels(), strict=True)]
    assert sum(moved) > 18


def test_an_arm_sees_its_last_round_or_its_first_episodes_alone() -> None:
    settings = SMALL.model_copy(update={"episodes": (8, 8, 8)})
    last = Treatment(ARMS["last"], settings, 0)(labels())
    assert {place_of(label.episode)[0] for label in last} == {3}
    first = Treatment(ARMS["episodes-0.25"], settings, 0)(labels())
    assert {place_of(label.episode) for label in first} == {
        (r, e) for r in (1, 2, 3) for e in (0, 1)
    }


def test_an_arm_learns_from_overrides_or_from_endorsements_alone() -> None:
    said = [
        label._replace(ground=Ground.ENDORSED) if row % 2 else label
        for row, label in enumerate(labels())
    ]
    kept = {name: Treatment(ARMS[name], SMALL, 0)(said) for name in ("overrides", "endorsements")}
    assert kept == {"overrides": said[::2], "endorsements": said[1::2]}


def attempt(command: str, begin: int) -> Attempt:
    return Attempt(command=command, skill="pick up", success=False, begin=begin, steps=10)


def test_of_a_failed_episode_is_kept_what_was_under_way_when_it_went_wrong() -> None:
    won, lost = rows([True, False])
    both = (attempt("pick up the ham", 0), attempt("pick up the bread", 10))
    late = (*both, attempt("pick up the cheese", 20))
    lost = lost.model_copy(update={"attempts": late, "failure": "wrong object", "failed_step": 12})
    kept = bare([won.model_copy(update={"attempts": late}), lost])
    assert [row.attempts for row in kept] == [(), (both[1],)]
    assert failed_commands([kept]) == [
        {"command": "pick up the bread", "failure": "wrong object", "count": 1, "share": 0.5}
    ]


def gap(difference: float, low: float = -0.1, high: float = 0.5) -> dict[str, Any]:
    return {"difference": difference, "interval": [low, high]}


def test_a_target_is_reached_by_its_value_and_a_control_beaten_by_its_interval() -> None:
    figures = {
        "gap_closed": {"value": 0.79, "interval": [0.7, 0.9]},
        "corrections_share": {"value": 12.0, "rounds": [20.0, 8.0, 8.5], "with_releases": 18.0},
        "retention": {"lab": gap(-0.01)},
        "less": {"live": gap(-0.05), "lab": gap(0.3, 0.2, 0.4), "shuffled": gap(0.3, -0.01, 0.6)},
    }
    found = {one.what: one.reached for one in targets(figures, 3, "far")}
    assert found == {
        "gap between base and oracle closed after 3 rounds": False,
        "corrections per 100 decisions, over all rounds": True,
        "the same by round": False,
        "less live-corrected": True,
        "in the lab, less before": True,
        "less extra demonstrations in the lab": True,
        "less shuffled corrections": False,
    }
    assert [one.reached for one in targets(figures, 3, "lab")].count(None) == 1


def rows(wins: list[bool]) -> list[Row]:
    return [
        Row(seed=seed, task="pack", prompt=f"{seed}", success=won, progress=1.0, steps=3,
            decisions=2, low_level_sha256="a")
        for seed, won in enumerate(wins)
    ]  # fmt: skip


def test_the_gap_is_what_lies_between_base_and_oracle() -> None:
    by_arm = {
        "base": [rows([True] * 2 + [False] * 18)],
        "oracle": [rows([True] * 20)],
        f"{MAIN}, round 1": [rows([True] * 11 + [False] * 9), rows([True] * 11 + [False] * 9)],
    }
    found = gap_closed(by_arm, 1)
    assert found["value"] == pytest.approx(0.5)
    low, high = found["interval"]
    assert 0.2 < low < 0.5 < high < 0.8
    assert gap_closed({**by_arm, "oracle": by_arm["base"]}, 1)["value"] is None
    # A gap that chance may have made is none to take a share of.
    near = {**by_arm, "base": [rows([True] * 19 + [False])]}
    assert gap_closed(near, 1) == {"value": None, "interval": None, "rounds": [None]}


@pytest.mark.parametrize(
    ("mine", "its", "fixed", "pairs"),
    [(1, 1, False, 4), (3, 1, True, 12), (3, 1, False, 4), (3, 2, False, 8), (3, 3, False, 12)],
)
def test_arms_are_compared_on_the_training_seeds_that_both_have(
    mine: int, its: int, fixed: bool, pairs: int
) -> None:
    won, lost = rows([True] * 4), rows([False] * 4)
    gap = less([won] * mine, [lost] * its, fixed=fixed)
    assert (gap["n"], gap["difference"]) == (pairs, 1.0)


def test_every_arm_that_the_full_run_names_has_its_person_in_it() -> None:
    assert {ARMS[name].person for name in FULL.arms} <= set(FULL.people)
    for few in (SMALL, CORE):
        assert set(few.arms) <= set(FULL.arms)
        assert {ARMS[name].person for name in few.arms} <= set(few.people) <= set(FULL.people)


def test_all_of_it_in_small_and_again_without_doing_anything_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(ARMS, "rehearsed", ARMS["rehearsed"]._replace(replayed=5))
    train = SMALL.recipe.train.model_copy(update={"steps": 2, "batch": 4, "epochs": 0})
    settings = DaggerSettings(
        episodes=(1, 2),
        seeds=1,
        people=(MAIN,),
        arms=("shuffled", "lab", "rehearsed"),
        recipe=SMALL.recipe.model_copy(update={"train": train}),
    )
    pool = Here()
    bench = Bench(tmp_path, pool, untold, (3, 4), scale=Scale.SMALL, site="far")
    told = compare(bench, settings)
    figures = told.figures
    assert set(figures["arms"]) == {
        "base", "oracle", "live", f"{MAIN}, round 1", f"{MAIN}, round 2",
        "shuffled", "lab", "rehearsed",
    }  # fmt: skip
    assert all(found["n"] == 1 for found in figures["arms"].values())
    assert figures["corrections_share"]["value"] > 0
    first, second = figures["people"][MAIN]
    assert (first["episodes"], first["success_alone"], first["relabels"]) == (1, None, 0)
    assert (second["episodes"], second["success_alone"]) == (2, 0.0)
    assert second["relabels"] > 0 < second["overrides"]
    assert figures["teleoperation"]["lab"]["decisions"] > 0
    assert figures["retention"]["before"]["n"] == 1
    assert set(figures["retention"]["arms"]) == {"rehearsed"}
    assert {target["what"] for target in figures["targets"]} >= {"less shuffled corrections"}
    assert figures["learned_from"]["shuffled"]["corrections"] > 0
    about = {"command": "c", "date": "d", "site": "far", "low_level_sha256": LOW,
             "high_level": None, "high_level_sha256": None}  # fmt: skip
    assert "as many demonstrations in the lab" in describe(told, about, ["dagger.svg"])
    done = pool.jobs
    assert compare(bench, settings).figures == figures
    assert pool.jobs == done
    # What was kept is enough to go on with elsewhere.
    elsewhere = replace(bench, out=tmp_path / "elsewhere")
    shutil.copytree(tmp_path / "outcomes", elsewhere.out / "outcomes")
    assert compare(elsewhere, settings).figures == figures
    assert pool.jobs == done
    # Of several training seeds the first makes a report already.
    kept = elsewhere.out / "outcomes" / "far"
    for name in ("corrected", *settings.arms):
        shutil.copy(kept / f"{name}-0.json.gz", kept / f"{name}-1.json.gz")
    published: list[Findings] = []
    twice = settings.model_copy(update={"seeds": 2})
    whole = compare(replace(elsewhere, publish=published.append), twice).figures
    assert [one.figures for one in published] == [figures]
    assert whole["arms"][f"{MAIN}, round 1"]["n"] == 2
    other = settings.model_copy(update={"episodes": (1, 3)})
    (kept / "lab-0.json.gz").rename(tmp_path / "lab")
    with pytest.raises(HldError, match="move it away, or name another --out"):
        compare(elsewhere, other)
    assert pool.jobs == done  # Before any work, although an arm is missing.
    (tmp_path / "lab").rename(kept / "lab-0.json.gz")
    # An arm that is missing there is made from the same course, gone through once more.
    (kept / "shuffled-0.json.gz").unlink()
    assert compare(elsewhere, settings).figures == figures
    assert pool.jobs > done
    done = pool.jobs
    (kept / "corrected-0.json.gz").write_bytes(b"cut")
    with pytest.raises(HldError, match="holds no outcomes"):
        compare(elsewhere, settings)
    # Another scale goes on with what was trained and tried for this one.
    shutil.rmtree(tmp_path / "outcomes")
    compare(bench, settings.model_copy(update={"arms": ("shuffled", "lab")}))
    assert pool.jobs == done
    # What was collected under other settings isn't gone on with, finished or not.
    shutil.rmtree(tmp_path / "elsewhere" / "outcomes")
    with pytest.raises(HldError, match="corrected-0 comes from other settings"):
        compare(elsewhere, other)
    # Nor with what doesn't say by which it was.
    (elsewhere.out / "courses" / "far" / "corrected-0" / "note.json").unlink()
    with pytest.raises(HldError, match="corrected-0 comes from other settings"):
        compare(elsewhere, settings)


def test_a_share_is_compared_at_as_many_updates() -> None:
    recipes = [ARMS[name].recipe(FULL.recipe) for name in ("share-0.1", "together", "share-0.8")]
    assert [recipe.train.correction_share for recipe in recipes] == [0.1, 0.5, 0.8]
    assert len({recipe.train.updates(6000) for recipe in recipes}) == 1
