"""Who is believed of what was heard, and what happens when nobody can hear."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from services.correction_api.config import SpeechSettings
from services.correction_api.problems import Problem
from services.correction_api.speech.ear import Ear
from services.correction_api.speech.engines import KINDS, Heard
from services.correction_api.speech.hear import Recognition, judge
from tests.waves import pcm

CHEESE, HAM = "pick up the cheese", "pick up the ham"
COMMANDS = (CHEESE, HAM, "put it on the plate", "wait")


def _judged(*commands: str | None) -> tuple[str | None, tuple[str, ...]]:
    found = judge([Heard(f"engine-{n}", "words", text) for n, text in enumerate(commands)])
    return found.agreed, found.choices


def test_two_that_agree_are_believed() -> None:
    assert _judged(CHEESE, CHEESE) == (CHEESE, ())


def test_one_alone_is_never_believed_but_can_be_chosen() -> None:
    assert _judged(CHEESE) == (None, (CHEESE,))
    assert _judged(CHEESE, None) == (None, (CHEESE,))
    assert _judged(None, CHEESE) == (None, (CHEESE,))


def test_two_that_differ_are_both_to_choose_from() -> None:
    assert _judged(CHEESE, HAM) == (None, (CHEESE, HAM))


def test_where_nothing_was_heard_there_is_nothing_to_choose() -> None:
    assert _judged(None, None) == (None, ())
    assert _judged() == (None, ())


def test_an_engine_that_raves_is_cut_short() -> None:
    assert len(judge([Heard("whisper", "you " * 1000, None)]).heard[0].text) == 200


def _with_ear(ear: Ear, act: Callable[[Ear], Awaitable[Recognition | None]]) -> Recognition | None:
    async def run() -> Recognition | None:
        try:
            return await act(ear)
        finally:
            await ear.close()

    return asyncio.run(run())


def test_without_an_engine_one_is_told_what_to_install() -> None:
    ear = Ear(SpeechSettings(), kinds=())
    with pytest.raises(Problem) as refused:
        ear.check()
    assert refused.value.status_code == 503
    assert "pip install 'hl-dagger[speech]'" in str(refused.value.detail)


def test_a_recogniser_that_fell_starts_anew_for_the_next_utterance() -> None:
    async def act(ear: Ear) -> Recognition:
        await ear.hear(pcm("cheese"), COMMANDS)
        process = ear._process
        assert process
        process.kill()
        await process.wait()
        return await ear.hear(pcm("plate"), COMMANDS)

    found = _with_ear(Ear(SpeechSettings()), act)
    assert found
    assert "put it on the plate" in (found.agreed, *found.choices)


def test_who_comes_beyond_the_queue_is_sent_away_at_once_and_the_others_are_heard() -> None:
    async def act(ear: Ear) -> Recognition:
        hearing = asyncio.ensure_future(ear.hear(pcm("cheese"), COMMANDS))
        await asyncio.sleep(0)  # Lets it begin.
        with pytest.raises(Problem) as refused:
            await ear.hear(pcm("cheese"), COMMANDS)
        assert refused.value.status_code == 503
        assert refused.value.headers == {"Retry-After": "1"}
        return await hearing

    found = _with_ear(Ear(SpeechSettings(waiting=1)), act)
    assert found
    assert CHEESE in (found.agreed, *found.choices)


@pytest.mark.skipif(
    not KINDS["whisper"].installed, reason=f"no second engine: {KINDS['whisper'].install}"
)
def test_with_two_engines_clear_words_are_agreed_upon() -> None:
    found = _with_ear(Ear(SpeechSettings()), lambda ear: ear.hear(pcm("plate"), COMMANDS))
    assert found
    assert [one.engine for one in found.heard] == ["pocketsphinx", "whisper"]
    assert found.agreed == "put it on the plate"
