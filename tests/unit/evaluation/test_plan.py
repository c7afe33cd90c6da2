"""What is evaluated, by the names that people use."""

import pytest

from shared.code import ROOT
from shared.errors import ConfigError, HldError, PolicyError
from shared.evaluation import phrase
from shared.evaluation.phrase import READING, Phrases
from shared.evaluation.plan import Plan, find_high_level, parse_seeds
from shared.seeds import purpose


def test_every_high_level_is_evaluated_on_the_same_scenes_which_are_for_nothing_else():
    plan = Plan(tasks=("sandwich", "pack"), seeds=(3, 9))
    assert plan.cases() == plan.model_copy(update={"high_level": "oracle"}).cases()
    assert {purpose(case.seed) for case in plan.cases()} == {"evaluation"}
    assert [case.task for case in plan.cases()] == ["sandwich", "pack"] * 3


def test_more_seeds_are_the_same_ones_and_some_more():
    few, many = Plan(seeds=(0, 4)).cases(), Plan(seeds=(0, 9)).cases()
    assert many[:4] == few


def test_rows_of_a_site_are_not_those_of_another_that_took_its_name(tmp_path):
    site = tmp_path / "mine.toml"
    site.write_text('name = "mine"\n')
    plan, phrases = Plan(site=str(site)), Phrases(site=str(site))
    before = plan.note(), phrases.note()
    assert (plan.note(), phrases.note()) == before
    site.write_text('name = "mine"\ndistractors = 8\n')
    assert plan.note() != before[0]
    assert phrases.note() != before[1]


def test_what_phrases_were_taken_for_by_other_rules_is_not_kept(monkeypatch):
    before = Phrases().note()
    monkeypatch.setattr(phrase, "READING", ("shared/policies/reader/reader.py",))
    assert Phrases().note() != before
    assert all(any(ROOT.glob(pattern)) for pattern in READING)


@pytest.mark.parametrize(("text", "seeds"), [("0:60", (0, 60)), ("7:8", (7, 8)), ("5", (0, 5))])
def test_seeds_are_read(text, seeds):
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "3:3", "4:2", "-1:5", "a:b", "0:999999999999", "1:2:3"])
def test_seeds_that_are_none_are_an_error_with_an_example(text):
    with pytest.raises(ConfigError, match="0:60"):
        parse_seeds(text)


def shelf(data, *versions):
    for version in versions:
        folder = data / "learner" / "versions" / version
        folder.mkdir(parents=True)
        (folder / "card.json").write_text("{}")


def test_a_version_is_found_where_the_learner_keeps_it(tmp_path):
    shelf(tmp_path, "1.0", "1.1", "2.2")
    assert find_high_level("1.1", tmp_path).endswith("versions/1.1")
    assert find_high_level("base", tmp_path) == "base"
    folder = str(tmp_path / "learner" / "versions" / "2.2")
    assert find_high_level(folder, tmp_path) == folder


def test_weights_that_were_announced_anew_are_found_by_their_number(tmp_path):
    shelf(tmp_path, "1.0", "1.1", "2.2")
    assert find_high_level("2.1", tmp_path).endswith("versions/1.1")
    with pytest.raises(PolicyError, match=r"1\.0, 1\.1, 2\.2"):
        find_high_level("1.2", tmp_path)


@pytest.mark.parametrize("name", ["1.7", "bases", ""])
def test_a_high_level_that_isnt_there_is_an_error_that_names_those_that_are(tmp_path, name):
    with pytest.raises(PolicyError, match="base, oracle"):
        find_high_level(name, tmp_path)


@pytest.mark.parametrize(
    "wrong", [{"site": "moon"}, {"tasks": ("dance",)}, {"skills": 7}, {"low_level": "/nowhere"}]
)
def test_a_plan_that_cant_work_is_refused_before_it_begins(wrong):
    with pytest.raises(HldError):
        Plan(**wrong).check()
