"""Questions that a reader of phrases was asked, its answers, and their figures."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from services.learner.pretrain.words import Said
from shared.intervals import rate
from shared.workcell.objects import OBJECT_NAMES, Stock
from shared.workcell.skills import COMMANDS, PUT_DOWN, PUT_IN_BIN, PUT_IN_TUB, PUT_ON_PLATE

TARGETS = (PUT_ON_PLATE, PUT_IN_BIN, PUT_IN_TUB)
HEARD = "only known words"
UNHEARD = ("new verb", "new name", "new verb and name", "new courtesy")


class Question(NamedTuple):
    """A phrase said in a scene. kind: what is asked; strange: no word of its name was taught."""

    kind: str
    said: Said
    stock: Stock
    strange: bool = False


class Answer(NamedTuple):
    """A question and the command it was read as, "" for a refusal."""

    question: Question
    read: str

    @property
    def right(self) -> bool:
        """It was read as it was meant."""
        return self.read == self.question.said.meant


def figures(answers: Sequence[Answer]) -> dict[str, Any]:
    """Rates with intervals by kind; of unheard words all together; what was confused."""
    kinds = list(dict.fromkeys(one.question.kind for one in answers))
    by_kind = {kind: rates([one for one in answers if one.question.kind == kind]) for kind in kinds}
    unheard = [one for one in answers if one.question.kind in UNHEARD]
    refusals = [one for one in answers if one.question.kind.startswith("refuse")]
    strange = [one for one in unheard if one.question.strange]
    commands = [one for one in answers if one.question.said.meant]
    return {
        "unheard words": rates(unheard),
        "unheard name, no word of it known": rates(strange),
        "kinds": by_kind,
        "refusals": rate([one.right for one in refusals]),
        "acts": {
            act: rates([one for one in unheard if one.question.said.meant in texts])
            for act, texts in {
                "pick": COMMANDS[: len(OBJECT_NAMES)],
                "put": TARGETS,
                "down": (PUT_DOWN,),
                "wait": ("wait",),
            }.items()
        },
        "confused": {
            "down and pick": rate([_confused(one, (PUT_DOWN,), COMMANDS[:15]) for one in commands]),
            "plate, bin and tub": rate([_confused(one, TARGETS, TARGETS) for one in commands]),
            "down and the rest of the puts": rate(
                [_confused(one, (PUT_DOWN,), TARGETS) for one in commands]
            ),
        },
    }


def rates(answers: Sequence[Answer]) -> dict[str, Any]:
    """Read rightly; refused; in the rest of the cases another command was read."""
    return {
        **rate([one.right for one in answers]),
        "refused": round(float(np.mean([not one.read for one in answers])), 4) if answers else 0.0,
    }


def _confused(answer: Answer, these: Sequence[str], those: Sequence[str]) -> bool:
    """One of these was meant and another of those read, or the other way round."""
    meant, read = answer.question.said.meant, answer.read
    return meant != read and (
        (meant in these and read in those) or (meant in those and read in these)
    )


def table(found: dict[str, Any]) -> str:
    """The figures as lines of text."""
    rows = {
        **found["kinds"],
        **{f"unheard words, {act}": rates for act, rates in found["acts"].items()},
        "unheard name, no word of it known": found["unheard name, no word of it known"],
        "unheard words": found["unheard words"],
        "refusals": found["refusals"],
        **{f"confused: {pair}": rates for pair, rates in found["confused"].items()},
    }
    lines = [f"{'':36} {'rate':>6} {'95 %':>15} {'refused':>8} {'n':>6}"]
    for name, one in rows.items():
        low, high = one["interval"]
        refused = f"{one['refused']:.3f}" if "refused" in one else ""
        lines.append(
            f"{name:36} {one['success']:6.3f} {low:7.3f}-{high:.3f} {refused:>10} {one['n']:6}"
        )
    return "\n".join(lines)
