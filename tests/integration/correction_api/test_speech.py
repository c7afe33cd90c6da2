"""Speech over HTTP, by real recordings: the command that was meant, or what would be right."""

from pathlib import Path

import httpx
import numpy as np
import pytest

from services.correction_api.lexicon import Lexicon
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.waves import pcm

L16 = {"Content-Type": "audio/l16; rate=16000"}
PATH = "api/v1/speech?robot=robot-1"


@pytest.fixture(autouse=True)
def _decided(api: httpx.Client, robot: FakeRobot) -> None:
    """The robot has told which commands it knows."""
    robot.decide()
    eventually(lambda: api.get(PATH).json()["commands"])


def _noise(loudness: float, seconds: float = 2.0) -> bytes:
    samples = np.random.default_rng(0).normal(0, loudness, int(16_000 * seconds))
    return samples.astype("<i2").tobytes()


@pytest.mark.parametrize(
    ("name", "command"), [("cheese", "pick up the cheese"), ("plate", "put it on the plate")]
)
def test_a_spoken_command_is_recognised_and_nothing_is_done_by_it(
    api: httpx.Client, robot: FakeRobot, name: str, command: str
) -> None:
    answer = api.post(PATH, content=pcm(name), headers=L16)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert command in (found["agreed"], *found["choices"])
    sphinx = next(one for one in found["heard"] if one["engine"] == "pocketsphinx")
    assert sphinx["command"] == command
    assert sphinx["text"]
    assert robot.heard == []


def test_silence_and_noise_are_no_command(api: httpx.Client) -> None:
    for sound in (bytes(64_000), _noise(3), _noise(300)):
        found = api.post(PATH, content=sound, headers=L16).json()
        assert (found["agreed"], found["choices"]) == (None, [])


def test_one_robots_commands_are_not_listened_for_at_another(
    api: httpx.Client, router: MemoryRouter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Lexicon, "commands", lambda _: ())  # As before a low level told its own.
    with MemoryBus(router) as bus:
        other = FakeRobot(bus, "robot-2")
        eventually(lambda: api.get("api/v1/robots/robot-2").status_code == 200)
        path = "api/v1/speech?robot=robot-2"
        assert api.get(path).json()["commands"] == []
        found = api.post(path, content=pcm("cheese"), headers=L16).json()
        assert (found["agreed"], found["choices"]) == (None, [])
        other.close()
    assert api.get("api/v1/speech").json()["commands"] == [*COMMANDS]


def test_what_is_there_is_told(api: httpx.Client) -> None:
    told = api.get(PATH).json()
    assert told["available"]
    assert told["media_type"] == L16["Content-Type"]
    assert told["commands"] == [*COMMANDS]
    engines = {one["engine"]: one for one in told["engines"]}
    assert engines["pocketsphinx"]["available"]
    assert engines["whisper"]["install"] == "pip install 'hl-dagger[whisper]'"


@pytest.mark.parametrize(
    "given", ["", "audio/wav", "audio/l16", "audio/l16; rate=48000", "audio/l16; rate=16000; x=1"]
)
def test_another_sound_is_refused_with_the_right_type(api: httpx.Client, given: str) -> None:
    answer = api.post(PATH, content=pcm("cheese"), headers={"Content-Type": given})
    assert answer.status_code == 415
    assert L16["Content-Type"] in answer.json()["detail"]


def test_a_speech_that_is_too_long_is_refused_before_it_is_read(api: httpx.Client) -> None:
    answer = api.post(PATH, content=_noise(300, 15.1), headers=L16)
    assert answer.status_code == 413
    assert "15 s" in answer.json()["detail"]

    def parts():  # type: ignore[no-untyped-def]
        yield from (bytes(32_000) for _ in range(16))

    answer = api.post(PATH, content=parts(), headers=L16)
    assert answer.status_code == 413


@pytest.mark.parametrize("body", [b"", b"abc"])
def test_half_a_sample_is_no_sound(api: httpx.Client, body: bytes) -> None:
    assert api.post(PATH, content=body, headers=L16).status_code == 422


def test_an_unknown_robot_is_named(api: httpx.Client) -> None:
    answer = api.post("api/v1/speech?robot=robot-l", content=pcm("cheese"), headers=L16)
    assert answer.status_code == 404
    assert "robot-1" in answer.json()["detail"]


def test_where_it_is_turned_off_the_page_is_told_why(router: MemoryRouter, tmp_path: Path) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, speech={"enabled": False}) as api:
        told = api.get("api/v1/speech").json()
        assert not told["available"]
        answer = api.post("api/v1/speech", content=pcm("cheese"), headers=L16)
        assert answer.status_code == 503
        assert int(answer.headers["Retry-After"]) > 0
        assert answer.json()["detail"] == told["reason"]
        assert "speech.enabled" in told["reason"]


def test_the_words_that_were_heard_stay_with_the_correction(
    api: httpx.Client, robot: FakeRobot
) -> None:
    said = {"kind": "override", "text": COMMANDS[0], "heard": "no the cheese first"}
    assert api.post("api/v1/robots/robot-1/corrections", json=said).status_code == 201
    assert robot.heard[0].heard == "no the cheese first"
