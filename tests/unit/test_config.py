"""Settings: what overrides what, and what happens to a wrong key."""

import pytest

from shared.config import Settings, load, load_or_exit
from shared.errors import ConfigError


class Inner(Settings):
    episodes: int = 5


class Outer(Settings):
    name: str = "default"
    round: Inner = Inner()


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "hld.toml"
    path.write_text('[learner]\nname = "file"\n[learner.round]\nepisodes = 6\n')
    return path


def test_the_command_line_beats_the_environment_beats_the_file_beats_the_default(file):
    def name(**sources):
        return load(Outer, "learner", environment=sources.pop("environment", {}), **sources).name

    assert name() == "default"
    assert name(file=file) == "file"
    environment = {"HLD_LEARNER_NAME": "environment", "HLD_ACTOR_NAME": "other"}
    assert name(file=file, environment=environment) == "environment"
    assert name(file=file, environment=environment, sets=["name=set"]) == "set"


def test_a_nested_key_is_set_without_losing_its_siblings(file):
    environment = {"HLD_LEARNER_ROUND__EPISODES": "7"}
    settings = load(Outer, "learner", file=file, environment=environment)
    assert settings.round.episodes == 7
    assert settings.name == "file"


@pytest.mark.parametrize("sets", ["round.episode=3", "nmae=x"])
def test_an_unknown_key_names_the_nearest_one(sets):
    with pytest.raises(ConfigError, match=r"round\.episodes|'name'"):
        load(Outer, "learner", sets=[sets], environment={})


def test_a_wrong_value_says_what_it_was():
    with pytest.raises(ConfigError, match=r"learner\.round\.episodes.*'many'"):
        load(Outer, "learner", sets=["round.episodes=many"], environment={})


def test_a_command_line_ends_with_code_two_and_one_line(capsys):
    with pytest.raises(SystemExit) as ended:
        load_or_exit(Outer, "learner", sets=["oops"], environment={})
    assert ended.value.code == 2
    assert "KEY=VALUE" in capsys.readouterr().err
