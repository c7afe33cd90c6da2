"""What a round brought, in words that hold for every way in which it can end."""

import pytest

from services.correction_api.brought import brought
from shared.messages.lineage import Compared, RoundTold, Share


def share(value: float, n: int = 200) -> Share:
    return Share(share=value, n=n)


def told(**fields: object) -> RoundTold:
    made = {"number": 1, "epoch": 1, "parent": 0, "state": "passed", "begun_ns": 1, "made": 1}
    return RoundTold.model_validate(made | {"corrections": 14} | fields)


TRIALS = Compared(before=share(0.52), after=share(0.71))


@pytest.mark.parametrize(
    ("round_", "alone", "words"),
    [
        (told(trials=TRIALS), {}, "14 corrections: 52 % → 71 %, n = 200 in the gate's paired ep"),
        (
            told(trials=TRIALS),
            {0: share(0.5, 60), 1: share(0.625, 40)},
            "14 corrections: 50 % → 63 %, n = 60 and 40 on evaluation seeds",
        ),
        (
            told(held_out=TRIALS, corrections=1),
            {0: share(0.5)},
            "1 correction: agreement with held-out labels 52 % → 71 %, n = 200",
        ),
        (told(corrections=0), {}, "no corrections: in force, and not measured"),
        (
            told(unjudged="held out 3 labels, needs 20: not judged"),
            {},
            "14 corrections: in force, and not measured; held out 3 labels, needs 20: not judged",
        ),
        (
            told(unjudged="held out 3 labels, needs 20: not judged", trials=TRIALS),
            {},
            "14 corrections: 52 % → 71 %, n = 200 in the gate's paired episodes",
        ),
        (told(state="running", made=None), {}, "14 corrections: at work"),
        (
            told(state="refused", made=None, trials=TRIALS, reason="it fell"),
            {},
            "14 corrections: 52 % → 71 %, n = 200 in the gate's paired episodes; "
            "held back, since it fell",
        ),
        (
            told(state="failed", made=None, reason="no memory"),
            {},
            "14 corrections: broken off, since no memory",
        ),
    ],
)
def test_a_round_is_told_in_words(round_: RoundTold, alone: dict[int, Share], words: str) -> None:
    assert brought(round_, alone).startswith(words)
