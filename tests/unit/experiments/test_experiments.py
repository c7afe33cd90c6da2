"""What experiments compute, from episodes that were made up, and the bench with real ones."""

import pytest

from services.learner.experiments import horizon, language, replanning, sides, transitions
from services.learner.experiments.bench import slug
from services.learner.experiments.registry import EXPERIMENTS, experiment_named
from services.learner.experiments.scenes import setting_for
from services.learner.pretrain.everyday import sealed, writings
from services.learner.pretrain.unheard import unheard_refusals
from shared.errors import ConfigError
from shared.policies.checkpoint import CARD_FILE
from shared.rollout.settings import Replan
from shared.workcell.skills import COMMANDS, parse
from tests.unit.evaluation.rows import attempt, row
from tests.unit.experiments.bench import here, scripted


def test_the_fallibility_counts_calls_up_to_the_first_that_failed():
    lost = row(1, False, attempts=(attempt(), attempt(success=False), attempt(success=False)))
    won = row(2, attempts=(attempt(), attempt(), attempt("wait", "")))
    found = horizon.fallibility([lost, won])
    assert (found["value"], found["n"]) == (0.25, 4)


def test_a_wrong_wait_is_a_call_that_failed():
    stuck = row(1, False, attempts=(attempt(), attempt("wait", "", wrong=1)))
    assert horizon.fallibility([stuck])["value"] == 0.5


def test_the_chain_is_one_less_epsilon_to_the_length():
    epsilon = {"value": 0.1, "n": 100, "interval": [0.05, 0.2]}
    chain = horizon.chain(epsilon, 8)
    assert chain["value"] == pytest.approx(0.9**8, abs=1e-4)
    assert chain["interval"] == pytest.approx([0.8**8, 0.95**8], abs=1e-4)


def test_the_horizon_has_every_length_that_a_task_takes_beside_what_its_epsilon_gives(tmp_path):
    def script(plan):
        good = plan.high_level == "oracle"
        return [row(seed, good, attempts=(attempt(success=good),)) for seed in range(4)]

    bench = scripted(tmp_path, script)
    found = horizon.run(bench)
    lengths = found.figures["pack"]["oracle"]["lengths"]
    assert list(lengths) == [length for length in horizon.LENGTHS if "pack" in bench.tasks(length)]
    assert all(point["success"] == point["expected"]["value"] == 1.0 for point in lengths.values())
    assert found.figures["pack"]["base"]["epsilon"]["value"] == 1.0
    assert [panel.title for panel in found.plots[0].panels] == list(found.figures)


def test_transitions_are_compared_on_the_same_scenes_under_both_paces(tmp_path):
    def script(plan):
        good = plan.rollout.replan is not Replan.INTERVAL or not plan.rollout.latency_steps
        return [row(seed, good or seed == 0) for seed in range(12)]

    found = transitions.run(scripted(tmp_path, script)).figures["base"]
    assert found["slow"]["both"]["less_interval"]["difference"] == pytest.approx(11 / 12, abs=1e-3)
    assert found["slow"]["both"]["less_interval"]["p"] < 0.01
    same = found["fast"]["both"]["less_interval"]
    assert (same["difference"], same["p"]) == (0.0, 1.0)
    assert same["interval"][0] < 0 < same["interval"][1]


def test_replanning_is_swept_over_the_intervals_that_leave_time_for_an_answer(tmp_path):
    def script(plan):
        assert plan.rollout.decision_steps >= plan.rollout.latency_steps
        late = plan.rollout.latency_steps + plan.rollout.decision_steps > 100
        return [row(seed, not late) for seed in range(4)]

    found = replanning.run(scripted(tmp_path, script))
    oracle = found.figures["oracle"]
    assert {delay: list(swept) for delay, swept in oracle.items()} == {
        "0": ["10", "20", "50", "100", "150"],
        "20": ["20", "50", "100", "150"],
        "50": ["50", "100", "150"],
    }
    assert oracle["0"]["100"]["success"] == 1.0
    assert oracle["20"]["100"]["success"] == 0.0
    assert [len(panel.curves) for panel in found.plots[0].panels] == [3, 3]


def test_scenes_for_puts_have_something_in_the_hand_and_differ(tmp_path):
    bench = here(tmp_path, (0, 6))
    settings = [setting_for(parse("put it down"), bench, number) for number in range(6)]
    assert all(setting.holding == "anything" for setting in settings)
    assert len({setting.seed for setting in settings}) == 6
    assert {setting_for(parse(COMMANDS[0]), bench, 0).holding} == {""}


def test_language_is_measured_with_real_phrases_and_not_done_twice(tmp_path, monkeypatch):
    some = writings()[2::4]
    monkeypatch.setattr(language, "writings", lambda: some)
    monkeypatch.setattr(sides, "MOST_SCENES", 1)
    bench = here(tmp_path)
    found = language.run(bench)
    jobs = bench.pool.jobs
    everyday = len({phrases[0] for told in some for phrases in told.said.values()})
    impossible = len({told.refused[0] for told in some})
    sided = found.figures["sides"]["n"]
    assert sided % (len(sides.FORMS) * len(sides.BEFORE) * len(sides.SIDES)) == 0
    assert jobs == everyday + impossible + len(COMMANDS) + 1 + len(unheard_refusals()) + sided
    assert found.figures["reworded"]["n"] == len(COMMANDS)
    assert found.figures["everyday"]["n"] == everyday
    assert found.figures["everyday"]["impossible"]["n"] == impossible
    kept = sealed(some)
    said = {phrases[0] for told in some for phrases in told.said.values()}
    assert found.figures["everyday"]["held_out"]["n"] == len(said & kept)
    refused = {told.refused[0] for told in some}
    assert found.figures["everyday"]["impossible_held_out"]["n"] == len(refused & kept)
    assert found.figures["contrary"]["n"] == 1
    assert language.run(bench) == found
    assert bench.pool.jobs == jobs


def test_an_unknown_experiment_is_an_error_that_names_those_that_are_known():
    with pytest.raises(ConfigError, match="horizon"):
        experiment_named("horizons")
    assert {"skills", "language", "horizon", "transitions"} <= set(EXPERIMENTS)


@pytest.mark.parametrize("name", ["skills", "language", "baselines"])
def test_a_high_level_that_would_not_be_tried_is_refused(name):
    with pytest.raises(
        ConfigError, match="--high-level has no effect here, only for horizon, dagger"
    ):
        experiment_named(name).accept("base", "")


def test_a_low_level_is_refused_where_each_arm_trains_its_own():
    with pytest.raises(ConfigError, match="--low-level has no effect here, only for skills, lang"):
        experiment_named("baselines").accept("", "some/folder")
    for experiment in EXPERIMENTS.values():
        experiment.accept("", "")
    experiment_named("horizon").accept("1.2", "some/folder")


def test_a_run_of_the_baselines_is_refused_where_it_does_nothing_and_where_none_lies(tmp_path):
    with pytest.raises(ConfigError, match="--baselines has no effect here, only for dagger"):
        experiment_named("horizon").accept("", "", tmp_path)
    for folder in (tmp_path, tmp_path / "missing"):
        with pytest.raises(ConfigError, match=r"hld experiment baselines.*fits-\*/flat-\*"):
            experiment_named("dagger").accept("", "", folder)
    arm = tmp_path / "fits-1a" / "flat-0"
    arm.mkdir(parents=True)
    (arm / CARD_FILE).touch()
    experiment_named("dagger").accept("", "", tmp_path)


def test_a_checkpoints_folder_makes_a_files_name():
    assert slug("/runs/up/learner/versions/1.2") == "runs-up-learner-versions-1.2"
