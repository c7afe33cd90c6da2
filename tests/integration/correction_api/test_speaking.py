"""Speaking to the page in a real browser, whose microphone hears a recording."""

import json
import tempfile
import time
import wave as waves
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import Locator, Page, Route, expect, sync_playwright

from services.correction_api.routes.speech import MEDIA_TYPE
from shared.messages.correction import Kind
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import launch, line
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.waves import length_s, pcm

ALLOW = "--use-fake-ui-for-media-stream"
REFUSED = """
() => void (navigator.mediaDevices.getUserMedia = async () => {
  throw new DOMException("", "NotAllowedError");
})
"""
"""As where a person said no; a browser without a window can't ask anybody."""
LEAD_S = 3.0
"""Silence before the words: the recording runs from when the microphone is opened on."""
PATIENCE_S = 150.0


@contextmanager
def microphone(url: str, wave: str, *flags: str, **options: Any) -> Iterator[Page]:
    """The page in a browser of its own, since a recording is given to a whole browser.

    options: of the browser's context, such as `viewport`.
    """
    expect.set_options(timeout=60_000)  # For machines that are busy with something else.
    complaints = list[str]()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        sound = f"--use-file-for-fake-audio-capture={_recorded(Path(folder), wave)}%noloop"
        browser = launch(playwright, None, "--use-fake-device-for-media-stream", sound, *flags)
        page = browser.new_page(**options)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(url)
        yield page
        browser.close()
    assert complaints == []


def _recorded(folder: Path, name: str) -> Path:
    path = folder / f"{name}.wav"
    with waves.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(16_000)
        file.writeframes(bytes(int(32_000 * LEAD_S)) + pcm(name) + bytes(32_000))
    return path


def _card(page: Page, robot: FakeRobot) -> Locator:
    """The robot's card, once everything can be said to it."""
    card = page.locator("main")
    robot.decide()
    expect(card.locator(".proposal")).to_have_count(len(COMMANDS))
    expect(card.locator("canvas.drawn")).to_have_count(2)
    return card


def _talk(page: Page, card: Locator, wave: str) -> None:
    """Hold Space while the recording is played."""
    page.keyboard.down(" ")
    expect(card.locator(".speak.listening")).to_be_visible()
    page.wait_for_timeout(1000 * (LEAD_S + length_s(wave) + 0.5))  # While the words are said.
    page.keyboard.up(" ")


def _talk_until(page: Page, robot: FakeRobot, wave: str, outcome: str) -> Locator:
    """Talk, as people do again where a busy machine lost half of it; the card that shows it."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        card = _card(page, robot)
        _talk(page, card, wave)
        expect(card.locator(".speak.choosing, .speak.done, .speak.told")).to_be_visible()
        found = card.locator(outcome)
        if found.count() or time.monotonic() > deadline:
            expect(found).to_have_count(1)
            return card
        page.reload()


def test_words_spoken_while_space_is_held_are_offered_chosen_and_obeyed(
    api: httpx.Client, robot: FakeRobot
) -> None:
    with microphone(str(api.base_url), "cheese", ALLOW) as page:
        sent = list[str]()
        page.on(
            "request",
            lambda one: "speech" in one.url and sent.append(one.headers.get("content-type", "")),
        )
        card = _talk_until(page, robot, "cheese", f".choice:has-text('{COMMANDS[0]}')")
        chip = card.locator(".choice")
        assert robot.heard == []
        page.keyboard.press("Enter")
        expect(card.get_by_role("status")).to_contain_text(
            f"“{COMMANDS[0]}”, robot-1: in force since step"
        )
        expect(chip).to_have_count(0)
        assert sent[-1] == MEDIA_TYPE
        said = robot.heard[0]
        assert said.goal is not None
        assert (said.kind, said.goal.text) == (Kind.OVERRIDE, COMMANDS[0])
        assert said.heard is not None
        assert "the cheese first" in said.heard
        assert said.decision == f"robot-1-e1-{robot.index - 1}"
        # What was seen and when it began are those of the moment at which Space went down.
        assert said.created_ns - said.begun_ns > 1e9 * length_s("cheese")
        assert said.seen_step is not None
        assert said.seen_step < robot.receipts[said.id].step
        card.get_by_role("button", name="Undo").dispatch_event("click")  # It is there for 5 s only.
        eventually(lambda: robot.kinds() == [Kind.OVERRIDE, Kind.RETRACT])
        assert robot.heard[1].target == said.id


def test_what_is_agreed_upon_is_done_at_once_and_can_be_undone(
    api: httpx.Client, robot: FakeRobot
) -> None:
    """The answer of two engines is written by hand: only one of them is always installed."""

    def agree(route: Route) -> None:
        if route.request.method != "POST":
            route.continue_()
            return
        heard = [
            {"engine": engine, "text": "put it on the plate", "command": COMMANDS[2]}
            for engine in ("pocketsphinx", "whisper")
        ]
        route.fulfill(body=json.dumps({"heard": heard, "agreed": COMMANDS[2], "choices": []}))

    with microphone(str(api.base_url), "plate", ALLOW) as page:
        page.route("**/api/v1/speech*", agree)
        card = _card(page, robot)
        _talk(page, card, "plate")
        card.get_by_role("button", name="Undo").dispatch_event("click")  # It is there for 5 s only.
        eventually(lambda: robot.kinds() == [Kind.OVERRIDE, Kind.RETRACT])
        assert robot.heard[0].goal is not None
        assert robot.heard[0].goal.text == COMMANDS[2]
        expect(card.get_by_role("button", name="Undo")).to_have_count(0)


def differ(route: Route) -> None:
    """The answer of two engines, written by hand: only one of them is always installed."""
    if route.request.method != "POST":
        route.continue_()
        return
    heard = [
        {"engine": "pocketsphinx", "text": "the tomato", "command": COMMANDS[1]},
        {"engine": "whisper", "text": "The plate.", "command": COMMANDS[2]},
    ]
    body = {"heard": heard, "agreed": None, "choices": [COMMANDS[1], COMMANDS[2]]}
    route.fulfill(body=json.dumps(body))


def test_of_two_the_second_is_chosen_by_its_digit_and_escape_chooses_none_but_stops(
    api: httpx.Client, robot: FakeRobot
) -> None:
    with microphone(str(api.base_url), "plate", ALLOW) as page:
        page.route("**/api/v1/speech*", differ)
        card = _card(page, robot)
        _talk(page, card, "plate")
        expect(card.locator(".choice")).to_have_count(2)
        expect(line(page)).to_contain_text("“The plate.” (whisper)")
        page.keyboard.press("Escape")
        expect(card.locator(".choice")).to_have_count(0)
        eventually(lambda: robot.kinds() == [Kind.PAUSE])
        _talk(page, card, "plate")
        expect(card.locator(".choice")).to_have_count(2)
        page.keyboard.press("2")
        expect(card.locator(".caption q")).to_have_text(COMMANDS[2])
        assert robot.kinds() == [Kind.PAUSE, Kind.OVERRIDE]
        assert robot.heard[1].heard == "The plate."


def test_escape_stops_the_robot_while_somebody_speaks_and_a_tap_says_nothing(
    api: httpx.Client, robot: FakeRobot
) -> None:
    with microphone(str(api.base_url), "cheese", ALLOW) as page:
        card = _card(page, robot)
        asked = list[str]()
        page.on("request", lambda one: one.method == "POST" and asked.append(one.url))
        page.keyboard.press(" ")
        page.keyboard.down(" ")
        expect(card.locator(".speak.listening")).to_be_visible()
        page.keyboard.press("Escape")
        eventually(lambda: robot.kinds() == [Kind.PAUSE])
        page.keyboard.up(" ")
        expect(card.locator(".speak.idle")).to_be_visible()
        assert [url for url in asked if "speech" in url] == []


def test_a_tap_of_space_still_presses_the_button_in_focus(
    api: httpx.Client, robot: FakeRobot
) -> None:
    with microphone(str(api.base_url), "cheese", ALLOW) as page:
        card = _card(page, robot)
        card.get_by_role("button", name=COMMANDS[1]).focus()
        page.keyboard.press(" ")
        eventually(lambda: robot.kinds() == [Kind.OVERRIDE])


def test_silence_is_no_command_and_nothing_can_be_done_by_it(
    api: httpx.Client, robot: FakeRobot
) -> None:
    with microphone(str(api.base_url), "cheese", ALLOW) as page:
        card = _talk_until(page, robot, "cheese", ".choice")
        page.keyboard.press("Escape")
        _talk(page, card, "cheese")  # The recording is over: the microphone is silent now.
        expect(line(page)).to_contain_text("No command was recognised")
        assert robot.kinds() == [Kind.PAUSE]


def test_a_page_that_gets_no_microphone_says_why_and_what_to_do(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    host = "robots.example"
    with MemoryBus(router) as bus, running(bus, tmp_path, hosts=[host]) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        url = f"http://{host}:{api.base_url.port}/"
        resolve = f"--host-resolver-rules=MAP {host} 127.0.0.1"
        with microphone(url, "cheese", ALLOW, resolve) as page:
            assert not page.evaluate("isSecureContext")
            card = _card(page, robot)
            expect(card.get_by_role("button", name="Hold and talk")).to_be_disabled()
            words = card.locator(".heard")
            expect(words).to_contain_text("only to pages by https or from localhost")
            expect(words).to_contain_text("tls_certificate and tls_key")
            port = api.base_url.port
            expect(words).to_contain_text(f"ssh -L {port}:localhost:{port} {host}")
            page.keyboard.press("Escape")
            eventually(lambda: robot.kinds() == [Kind.PAUSE])


def test_a_microphone_that_is_not_allowed_is_told(api: httpx.Client, robot: FakeRobot) -> None:
    with microphone(str(api.base_url), "cheese") as page:
        _card(page, robot)
        page.evaluate(REFUSED)
        page.keyboard.down(" ")
        expect(line(page)).to_contain_text("not allowed for this page")
        page.keyboard.up(" ")
        assert robot.heard == []


def test_a_service_without_an_engine_says_what_to_do(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    speech = {"enabled": False}
    with MemoryBus(router) as bus, running(bus, tmp_path, speech=speech) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        with microphone(str(api.base_url), "cheese", ALLOW) as page:
            card = _card(page, robot)
            expect(card.locator(".heard")).to_contain_text("set speech.enabled to true")
            expect(card.get_by_role("button", name="Hold and talk")).to_be_disabled()
