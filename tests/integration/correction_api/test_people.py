"""Several people at once: whose word it is, who is here, and whose word holds in the end."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from services.correction_api.people import fresh_token, hashed
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.test_live import page, read

CORRECTIONS = "api/v1/robots/robot-1/corrections"
SAID = {"kind": "override", "text": "pick up the tomato"}
ANNA, BEN = fresh_token(), fresh_token()
PEOPLE = {"anna": hashed(ANNA), "ben": hashed(BEN)}


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


@pytest.fixture
def guarded(router: MemoryRouter, robot: FakeRobot, tmp_path: Path) -> Iterator[httpx.Client]:
    """An API that knows Anna and Ben, called by Anna unless a test says otherwise."""
    del robot  # It only has to be there.
    with MemoryBus(router) as bus, running(bus, tmp_path, people=PEOPLE) as api:
        api.headers.update(bearer(ANNA))
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        yield api


def test_each_person_has_a_token_and_speaks_under_their_own_name(guarded: httpx.Client) -> None:
    assert guarded.get("api/v1/me").json() == {"person": "anna"}
    assert guarded.get("api/v1/me", headers=bearer(BEN)).json() == {"person": "ben"}
    for wrong in ("x" * 32, hashed(ANNA), "é" * 20):
        headers = {"Authorization": f"Bearer {wrong}".encode()}
        answer = guarded.get("api/v1/me", headers=headers)
        assert (answer.status_code, answer.json()["title"]) == (401, "A token is needed")
    for author, body in (("anna", SAID), ("ben", SAID | {"author": "ben"})):
        headers = bearer({"anna": ANNA, "ben": BEN}[author])
        view = guarded.post(CORRECTIONS, json=body, headers=headers).json()
        assert view["correction"]["author"] == author


def test_nobody_speaks_in_somebody_elses_name(guarded: httpx.Client, robot: FakeRobot) -> None:
    answer = guarded.post(CORRECTIONS, json=SAID | {"author": "ben"})
    assert answer.status_code == 403
    assert answer.json()["type"].endswith(":author")
    assert "leave author out, or say 'anna'" in answer.json()["detail"]
    assert guarded.post(CORRECTIONS, json=SAID | {"id": "mine"}).status_code == 201
    taken = guarded.post(CORRECTIONS, json=SAID | {"id": "mine"}, headers=bearer(BEN))
    assert (taken.status_code, taken.json()["type"].split(":")[-1]) == (409, "id-used")
    assert [said.author for said in robot.heard] == ["anna"]


def test_nobody_decides_about_versions_in_somebody_elses_name(guarded: httpx.Client) -> None:
    body = {"verb": "rollback", "version": 0, "reason": "1.1 drops the bread"}
    answer = guarded.post("api/v1/policy/rulings", json=body | {"author": "ben"})
    assert (answer.status_code, answer.json()["type"].split(":")[-1]) == (403, "author")
    kept = guarded.post("api/v1/policy/rulings", json=body | {"author": "anna"})
    assert (kept.status_code, kept.json()["ruling"]["author"]) == (202, "anna")


def test_without_people_everybody_names_themselves(api: httpx.Client) -> None:
    assert api.get("api/v1/me").json() == {"person": None}
    view = api.post(CORRECTIONS, json=SAID | {"author": "carla"}).json()
    assert view["correction"]["author"] == "carla"


def test_who_was_taken_out_of_the_settings_is_shut_out_and_the_others_are_not(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    del robot
    left = {"ben": hashed(BEN)}
    token = fresh_token()
    with MemoryBus(router) as bus, running(bus, tmp_path, people=left, token=token) as api:
        assert api.get("api/v1/me", headers=bearer(ANNA)).status_code == 401
        assert api.get("api/v1/me", headers=bearer(BEN)).json() == {"person": "ben"}
        assert api.get("api/v1/me", headers=bearer(token)).json() == {"person": None}
        with pytest.raises(InvalidStatus) as refusal, _here(api, ANNA):
            pass
        assert refusal.value.response.status_code == 401


def test_pages_are_told_who_is_here_and_which_robot_they_look_at(guarded: httpx.Client) -> None:
    with _here(guarded, ANNA) as anna, _here(guarded, BEN) as ben:
        ben.send(json.dumps({"focus": "robot-1"}))
        found = {"name": "ben", "robots": ["robot-1"]}
        _until(anna, [{"name": "anna", "robots": []}, found])
        ben.send(json.dumps({"watch": [], "author": "anna"}))
        assert "this token is ben's" in read(ben, "problem")["problem"]["detail"]
        ben.send(json.dumps({"focus": None}))
        _until(anna, [{"name": "anna", "robots": []}, {"name": "ben", "robots": []}])
        ben.close()
        _until(anna, [{"name": "anna", "robots": []}])


def test_a_page_without_a_token_says_itself_who_sits_before_it(api: httpx.Client) -> None:
    with page(api) as one, page(api) as other:
        other.send(json.dumps({"author": "dora", "focus": "robot-1"}))
        _until(one, [{"name": "dora", "robots": ["robot-1"]}])


def test_of_two_people_on_one_robot_the_later_one_holds_and_both_are_told(
    guarded: httpx.Client, robot: FakeRobot
) -> None:
    with _here(guarded, ANNA) as anna, _here(guarded, BEN) as ben:
        first = guarded.post(CORRECTIONS, json=SAID).json()
        assert first["replaced_by"] is None
        assert _told(ben, first)["correction"]["author"] == "anna"
        body = {"kind": "override", "text": "wait"}
        second = guarded.post(CORRECTIONS, json=body, headers=bearer(BEN)).json()
        replaced = {
            "correction": second["correction"]["id"],
            "author": "ben",
            "kind": "override",
            "step": second["receipt"]["step"],
        }
        for told in (anna, ben):
            assert _told(told, second)["replaced_by"] is None
            assert _told(told, first, replaced=True)["replaced_by"] == replaced
    kept = guarded.get(f"api/v1/corrections/{first['correction']['id']}").json()
    # What its words mean may have become known only after the first answer.
    assert kept == first | {"replaced_by": replaced, "phrase": kept["phrase"]}
    shown = guarded.get("api/v1/robots/robot-1").json()
    assert (shown["command"]["text"], shown["author"]) == ("wait", "ben")
    assert robot.command == "wait"


@pytest.mark.parametrize("kind", ["release", "retract"])
def test_what_somebody_else_lifts_says_so_and_what_they_reword_holds_on(
    guarded: httpx.Client, kind: str
) -> None:
    first = guarded.post(CORRECTIONS, json=SAID).json()
    name = first["correction"]["id"]
    edit = {"kind": "edit", "target": name, "text": "pick up the ham"}
    assert guarded.post(CORRECTIONS, json=edit, headers=bearer(BEN)).status_code == 201
    assert guarded.get(f"api/v1/corrections/{name}").json()["replaced_by"] is None
    body = {"kind": kind} | ({"target": name} if kind == "retract" else {})
    lifted = guarded.post(CORRECTIONS, json=body, headers=bearer(BEN)).json()
    shown = guarded.get("api/v1/corrections").json()["corrections"]
    by = next(view for view in shown if view["correction"]["id"] == name)["replaced_by"]
    assert (by["author"], by["kind"], by["step"]) == ("ben", kind, lifted["receipt"]["step"])


def _here(api: httpx.Client, token: str):  # type: ignore[no-untyped-def]
    return page(api, subprotocols=["hld", f"token.{token}"])


def _until(connection: Any, here: list[dict[str, Any]]) -> None:
    """Read on until these people are here."""
    while read(connection, "people")["people"]["here"] != here:
        continue


def _told(connection: Any, said: dict[str, Any], *, replaced: bool = False) -> dict[str, Any]:
    """The next event about a correction, once it is in force (and replaced)."""
    while True:
        view = read(connection, "correction")["correction"]
        same = view["correction"]["id"] == said["correction"]["id"]
        if same and view["status"] == "in force" and replaced == bool(view["replaced_by"]):
            return dict(view)
