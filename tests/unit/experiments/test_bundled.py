"""The checkpoints that come with the project do what their cards say, on scenes of an evaluation.

Small samples: what would be an unlucky draw for policies as they were measured (skills .998, oracle
.98, obedience 1.00) passes; what fell by a tenth fails.
"""

import pytest

from services.learner.experiments import language, skills
from tests.unit.experiments.bench import here

TASKS = ("bus", "pack", "sandwich")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Four attempts at each skill, and four episodes of each task under the oracle, in the lab."""
    return skills.run(here(tmp_path_factory.mktemp("skills"), (0, 4))).figures


def test_every_skill_is_there(done):
    assert len(done["skills"]) == 19
    assert all(found["n"] == 4 for found in done["skills"].values())
    assert [text for text, found in done["skills"].items() if found["success"] < 0.75] == []
    assert sum(found["success"] * 4 for found in done["skills"].values()) >= 74


def test_the_oracle_gets_every_task_done(done):
    tasks = {task: done["tasks"][f"{task} at lab"] for task in TASKS}
    assert [task for task, found in tasks.items() if found["success"] < 0.75] == []
    assert sum(found["success"] * found["n"] for found in tasks.values()) >= 11


def test_a_command_against_the_obvious_wins(tmp_path):
    bench = here(tmp_path, (0, 20))
    said = bench.phrases("contrary", language.against_the_obvious(bench))
    assert len(said) == 20
    assert sum(one.success for one in said) >= 19
    assert sum(one.obvious in one.done for one in said) <= 1
