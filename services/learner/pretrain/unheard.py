"""Phrases of the exam: their words were kept from every reader that is shipped.

Drawn once by a fixed seed, for what measures a low level in its cell.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from services.learner.pretrain.lexicon import exam
from services.learner.pretrain.words import Said, Speaker
from shared.workcell.objects import OBJECT_NAMES
from shared.workcell.skills import SKILLS, Skill

SEED = 1
EACH = 15
"""Phrases of each command."""
REFUSALS = 20
"""Phrases of each kind that is to be refused."""
TRIES = 60


class Unheard(NamedTuple):
    """A phrase that was never taught. new: what in it is: "noun", "verb" or "both"."""

    phrase: str
    new: str


def unheard_phrases() -> list[list[Unheard]]:
    """For each command different phrases; every other one with courtesy or protest.

    In turn with a new verb, a new noun (thing or place), both; to wait there is only the verb.
    """
    known, new = exam()
    rng = np.random.default_rng(SEED)
    speakers = {
        "verb": Speaker(new, known, known, rng),
        "noun": Speaker(known, new, known, rng),
        "both": Speaker(new, new, known, rng),
    }
    return [_of(skill, speakers) for skill in SKILLS]


def unheard_refusals() -> list[str]:
    """What must be refused and was never heard."""
    known, new = exam()
    rng = np.random.default_rng(SEED)
    speaker = Speaker(new, new, known, rng)
    old_verbs = Speaker(known, new, known, rng)
    kinds: list[Callable[[], Said]] = [
        old_verbs.unknown_thing,
        old_verbs.unknown_place,
        speaker.chat,
        lambda: speaker.unknown_act(str(rng.choice(OBJECT_NAMES))),
    ]
    told = [kind().text for kind in kinds for _ in range(REFUSALS)]
    return list(dict.fromkeys(told))


def _of(skill: Skill, speakers: dict[str, Speaker]) -> list[Unheard]:
    kinds = ("verb",) if skill.verb == "wait" else tuple(speakers)
    told: dict[str, str] = {}
    for turn in range(TRIES):
        new = kinds[turn % len(kinds)]
        said = _say(skill, speakers[new], placed=new != "verb", framed=new != "noun")
        said = said if turn % 2 else speakers[new].dressed(said)
        told.setdefault(said.text, new)
        if len(told) == EACH:
            break
    return [Unheard(text, new) for text, new in told.items()]


def _say(skill: Skill, speaker: Speaker, placed: bool, framed: bool) -> Said:
    if skill.object is not None:
        return speaker.pick(skill.object, framed)
    return speaker.wait() if skill.verb == "wait" else speaker.put(skill.verb, placed=placed)
