"""Who may pass: this machine's names, this page's origin, whoever has the token."""

import asyncio
from typing import Any

import httpx
import pytest
from starlette.types import Receive, Scope, Send

from services.correction_api.config import ApiSettings
from services.correction_api.gate import MAX_BODY_BYTES, Gate

TOKEN = "0123456789abcdef"


async def _answer(scope: Scope, receive: Receive, send: Send) -> None:
    del scope
    while (await receive()).get("more_body"):
        continue
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"passed"})


def _ask(
    settings: ApiSettings, method: str = "GET", path: str = "/api/v1/robots", **rest: Any
) -> httpx.Response:
    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(Gate(_answer, settings))
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            return await client.request(method, path, **rest)

    return asyncio.run(ask())


@pytest.mark.parametrize("host", ["localhost:8000", "127.0.0.1", "[::1]:8000", "robots.example"])
def test_names_of_this_machine_pass(host: str) -> None:
    settings = ApiSettings(hosts=("robots.example",))
    assert _ask(settings, headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", ""])
def test_a_name_that_somebody_else_points_here_does_not(host: str) -> None:
    answer = _ask(ApiSettings(), headers={"Host": host})
    assert answer.status_code == 403
    assert answer.json()["type"].endswith(":host")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:9000"])
def test_a_page_of_somebody_else_may_not_say_anything(origin: str) -> None:
    answer = _ask(ApiSettings(), "POST", headers={"Origin": origin})
    assert answer.status_code == 403
    assert answer.json()["type"].endswith(":origin")
    assert _ask(ApiSettings(), "POST", headers={"Origin": "http://127.0.0.1"}).status_code == 200
    assert _ask(ApiSettings(), "POST").status_code == 200


@pytest.mark.parametrize(
    ("path", "guarded"),
    [
        ("/api/v1/robots", True),
        ("/api/v1/metrics", True),
        ("/metrics", True),
        ("/cell/api/v1/robots", True),
        ("/healthz", False),
        ("/api/v1/healthz", False),
        ("/", False),
        ("/main.js", False),
    ],
)
def test_the_api_is_behind_the_token_and_the_page_before_it(path: str, guarded: bool) -> None:
    settings = ApiSettings.model_validate({"token": TOKEN, "prefix": "/cell"})
    for headers in ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"}):
        answer = _ask(settings, path=path, headers=headers)
        assert answer.status_code == (401 if guarded else 200)
    good = {"Authorization": f"Bearer {TOKEN}"}
    assert _ask(settings, path=path, headers=good).status_code == 200


def test_the_prefix_without_its_slash_leads_to_the_page_under_the_name_it_was_called_by() -> None:
    settings = ApiSettings.model_validate({"prefix": "/cell/7", "token": TOKEN})
    for method in ("GET", "HEAD"):
        answer = _ask(settings, method, "/cell/7", params={"robot": "a b"})
        assert (answer.status_code, answer.headers["Location"]) == (307, "/cell/7/?robot=a+b")
    assert _ask(settings, path="/cell/7/").text == "passed"
    assert _ask(settings, path="/cell").text == "passed"  # Its proxy has taken the prefix off.
    assert _ask(settings, "POST", "/cell/7").text == "passed"
    assert _ask(ApiSettings(), path="").text == "passed"
    evil = {"Host": "evil.example"}
    without = ApiSettings(prefix="/cell/7")
    assert _ask(without, path="/cell/7", headers=evil).status_code == 403


@pytest.mark.parametrize("length", [str(MAX_BODY_BYTES + 1), "-1", "many"])
def test_a_body_that_says_it_is_too_large_is_not_read(length: str) -> None:
    assert _ask(ApiSettings(), "POST", headers={"Content-Length": length}).status_code == 413


def test_sound_may_be_larger_than_words_and_is_limited_too() -> None:
    speech = ApiSettings.model_validate({"prefix": "/cell", "speech": {"max_s": 10}})
    for path, limit in (("/cell/api/v1/speech", 320_000), ("/api/v1/speech", 320_000)):
        assert _ask(speech, "POST", path, content=bytes(limit)).status_code == 200
        answer = _ask(speech, "POST", path, content=bytes(limit + 1))
        assert answer.status_code == 413
        assert "10 s of speech" in answer.json()["detail"]


def test_every_answer_keeps_a_page_to_its_own_origin() -> None:
    for answer in (_ask(ApiSettings()), _ask(ApiSettings(), headers={"Host": "evil"})):
        assert answer.headers["Content-Security-Policy"].startswith("default-src 'self'")
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
