"""Recordings of a synthetic voice; the README says how they were made."""

import wave
from pathlib import Path

WAVES = Path(__file__).parent


def pcm(name: str) -> bytes:
    """The samples of a recording: 16 bits, 16,000 a second."""
    with wave.open(str(WAVES / f"{name}.wav")) as file:
        assert (file.getframerate(), file.getnchannels(), file.getsampwidth()) == (16_000, 1, 2)
        return file.readframes(file.getnframes())


def length_s(name: str) -> float:
    """How long a recording lasts."""
    return len(pcm(name)) / 32_000
