"""Tokens of people: what the settings take, what they show, and what a person gets."""

import json
import re

import pytest
from typer.testing import CliRunner

from services.correction_api import invite
from services.correction_api.config import ApiSettings
from services.correction_api.people import People, fresh_token, hashed
from shared.config import load
from shared.errors import ConfigError

TOKEN = "correct horse battery staple"


def settings(*sets):
    return load(ApiSettings, "api", sets=sets, environment={})


def test_a_token_and_its_hash_let_the_same_person_in():
    for kept in (TOKEN, hashed(TOKEN)):
        made = settings(f"people.anna={kept}", "people.ben=another token of some length")
        people = People(made.token, made.people)
        assert people.guarded
        assert people.find(["no", TOKEN]).name == "anna"
        assert people.find(["no", "é", "", "x" * 100_000, hashed(TOKEN)]) is None
    assert not People(None, {}).guarded


def test_settings_as_they_are_logged_show_no_token():
    made = settings(f"people.anna={TOKEN}", f"token={fresh_token()}")
    shown = json.dumps(made.model_dump(mode="json")) + repr(made)
    assert "anna" in shown
    assert TOKEN not in shown
    assert made.token.get_secret_value() not in shown


@pytest.mark.parametrize(
    ("sets", "words"),
    [
        (["people.anna=hunter2-short"], "at least 16 characters; `hld token NAME`"),
        (["token=hunter2-short"], "at least 16 characters"),
        (["people.anna=sha256:hunter2-hunter2"], "64 digits"),
        (["people.Anna=hunter2-hunter2-hunter2"], "should match pattern"),
        ([f"people.{name}=hunter2-hunter2-hunter2" for name in ("a", "b")], "the same token"),
        (["host=0.0.0.0", "people.anna=hunter2-hunter2-hunter2"], "tls_certificate"),
    ],
)
def test_a_wrong_token_is_refused_without_being_shown(sets, words):
    with pytest.raises(ConfigError, match=re.escape(words)) as refusal:
        settings(*sets)
    assert "hunter2" not in str(refusal.value)


def test_a_person_gets_a_fresh_token_and_the_line_that_lets_it_in():
    shown = CliRunner().invoke(_app(), ["anna"]).output
    token = re.search(r"^  (\S{32})$", shown, re.MULTILINE).group(1)
    line = re.search(r'^  anna = "(.+)"$', shown, re.MULTILINE).group(1)
    made = settings(f"people.anna={line}")
    assert People(None, made.people).find([token]).name == "anna"
    refused = CliRunner().invoke(_app(), ["Anna B"])
    assert refused.exit_code == 2


def _app():
    import typer

    app = typer.Typer()
    app.command()(invite.main)
    return app
