"""The whole experiment, as small as can be; and what is made of its rows."""

import json

import pytest

from services.learner.baselines.policy import ArmPlan, evaluator
from services.learner.baselines.scale import ARMS, TITLES, BaselineSettings, DataSettings
from services.learner.baselines.work import Plan, Trained
from services.learner.experiments import baselines, compared, report
from shared.errors import HldError, PolicyError
from shared.policies.fitter import FitSettings
from tests.unit.evaluation.rows import row
from tests.unit.experiments.bench import here

TINY = BaselineSettings(
    data=DataSettings(episodes=2, parts=2, prompts=4),
    fit=FitSettings(steps=3, batch=8),
    slice=3,
    seeds=1,
    lengths=(4,),
    max_steps=30,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A bench, its plan, and what was found."""
    folder = tmp_path_factory.mktemp("baselines")
    bench, plan = here(folder), Plan(out=folder, settings=TINY)
    return bench, plan, baselines.compare(bench, plan)


def test_a_tiny_run_reports_every_arm(made, tmp_path):
    _, _, found = made
    about = {
        "command": "x",
        "date": "2026-11-26",
        "site": "lab",
        "low_level_sha256": "f" * 64,
        "high_level_sha256": None,
    }
    report.write(tmp_path, found, about)
    told = json.loads((tmp_path / "report.json").read_text())["figures"]
    assert set(told["lengths"]["4"]) == set(TITLES)
    assert all(arm["n"] == 1 and arm["steps"] == 30 for arm in told["lengths"]["4"].values())
    assert set(told["training"]) == set(ARMS)
    assert {arm["updates"] for arm in told["training"].values()} == {3}
    assert (tmp_path / "baselines.svg").exists()
    page = (tmp_path / "report.md").read_text()
    assert all(title in page for title in TITLES.values())
    assert "One training seed" in page
    assert "Never succeeded at this scale: hierarchy" in page


def test_fits_are_cut_into_slices_that_end_with_the_last_update(tmp_path):
    settings = TINY.model_copy(update={"slice": 2, "seeds": 2})
    rounds = list(Plan(out=tmp_path, settings=settings).slices())
    assert [{job.until for job in jobs} for jobs in rounds] == [{2}, {3}] * 2
    assert [{job.seed for job in jobs} for jobs in rounds] == [{0}, {0}, {1}, {1}]
    assert all([job.arm for job in jobs] == list(ARMS) for jobs in rounds)


def test_what_is_there_is_not_done_again(made):
    bench, plan, found = made
    before = bench.pool.jobs
    again = baselines.compare(bench, plan)
    assert again == found
    assert bench.pool.jobs == before + TINY.data.parts  # Each only looks whether it is there.


def test_only_arms_with_words_are_judged_by_them(made):
    bench, plan, _ = made
    for arm in ARMS:
        folder = str(plan.arm(arm, 0))
        kept = bench.episodes(
            f"{arm}-0-4-{plan.note()}",
            ArmPlan(
                site=bench.site, seeds=bench.seeds, tasks=tuple(bench.tasks(4)), skills=4,
                high_level=folder, low_level=folder,
                rollout={"max_steps": 30, "decision_steps": 5 if arm == "flat" else 20},
            ),
            evaluator,
        )  # fmt: skip
        assert kept[0].decisions == (6 if arm == "flat" else 2)
        if arm in ("latent", "flat", "guided"):
            assert (kept[0].wrong, kept[0].attempts, kept[0].failure) == (0, (), "out of time")


def test_a_plan_without_a_baseline_is_refused(tmp_path):
    with pytest.raises(PolicyError):
        ArmPlan(high_level=str(tmp_path), low_level=str(tmp_path)).check()


def test_differences_are_paired_over_training_seeds_and_scenes():
    def rows(won):
        return [[row(seed, won(seed)) for seed in range(20)] for _ in range(3)]

    by_arm = {arm: rows(lambda _: False) for arm in TITLES}
    by_arm["hierarchy"] = rows(lambda seed: seed >= 5)
    by_arm["chain"] = rows(lambda seed: seed >= 5)
    found = compared.findings(TINY, [trained("a")], {4: by_arm}, "lab").figures
    assert found["hierarchy_less"]["flat"]["all"]["difference"] == 0.75
    assert found["hierarchy_less"]["flat"]["all"]["n"] == 60
    assert found["hierarchy_less"]["flat"]["4"]["interval"][0] > 0.4
    assert found["hierarchy_less"]["flat"]["4"]["p"] == [0.0001] * 3
    assert found["hierarchy_less"]["chain"]["all"]["p"] == [1.0] * 3


def test_what_a_better_head_would_bring_has_an_interval():
    def rows(won):
        return [[row(seed, won(seed)) for seed in range(20)] for _ in range(3)]

    by_arm = {arm: rows(lambda _: False) for arm in TITLES}
    by_arm["hierarchy"] = rows(lambda seed: seed >= 10)
    by_arm["oracle"] = rows(lambda seed: seed >= 2)
    found = compared.findings(TINY, [trained("a")], {4: by_arm}, "lab")
    less = found.figures["hierarchy_less"]["oracle"]["all"]
    assert less["difference"] == -0.4
    assert -0.7 < less["interval"][0] < -0.4 < less["interval"][1] < -0.1
    assert "hierarchy, oracle above" in {cells[0] for cells in found.tables[1].rows}


def test_a_p_is_of_one_training_seed_and_the_largest_is_shown():
    def rows(least):
        return [[row(seed, seed >= some) for seed in range(20)] for some in least]

    by_arm = {arm: rows((20, 20, 20)) for arm in TITLES}
    by_arm["hierarchy"] = rows((12, 16, 18))  # 8, 4 and 2 scenes won.
    found = compared.findings(TINY, [trained("a")], {4: by_arm}, "lab")
    assert found.figures["hierarchy_less"]["flat"]["4"]["p"] == [0.0078, 0.125, 0.5]
    cells = found.tables[1].rows[0]
    assert cells[2].endswith("p = 0.500")
    assert any("of one training seed" in note for note in found.notes)


def test_arms_of_different_demonstrations_are_not_compared():
    with pytest.raises(HldError, match="different demonstrations"):
        compared.findings(TINY, [trained("a"), trained("b")], {}, "lab")


def trained(data_sha256):
    return Trained(
        arm="flat", seed=0, until=3, updates=3, parameters=9, cpu_s=1.0, moved=1.0, goal=0.0,
        agreement=0.0, data_sha256=data_sha256,
    )  # fmt: skip
