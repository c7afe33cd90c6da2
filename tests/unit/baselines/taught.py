"""Little demonstrations for the tests of the baselines, and arms on their way."""

from dataclasses import replace
from functools import cache

import numpy as np

from services.learner.baselines.data import Looks, Teaching, teach
from services.learner.baselines.fit import ArmFit
from services.learner.baselines.work import FIRST_SEED, fresh
from services.learner.pretrain.meanings import Prompts
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.policies.fitter import FitSettings
from shared.workcell.skills import COMMANDS

SETTINGS = FitSettings(steps=20, batch=8)


@cache
def teaching() -> Teaching:
    """One episode with many mistakes."""
    return teach((FIRST_SEED + 1,), mistakes=0.2, slips=0.002)


@cache
def few() -> Teaching:
    """The same, but only some looks that come early in it."""

    def early(looks: Looks, count: int) -> Looks:
        rows = np.flatnonzero(np.diff(looks.windows)[:, 0])[:count]
        return Looks(looks.seen.take(rows), looks.windows[rows])

    taught = teaching()
    return Teaching(early(taught.decisions, 4), early(taught.moments, 4), taught.steps)


@cache
def prompts() -> Prompts:
    return Prompts(10, 0, shared_encoder())


def begun(arm, taught=None, settings=SETTINGS, kept=None):
    """A fit before its first update, or where it was kept."""
    taught = taught or teaching()
    pair, bank = fresh(arm, 0, taught), PhraseBank.of(COMMANDS)
    return ArmFit(pair, bank, taught, settings, 4, prompts(), kept)


def relabelled(taught: Teaching) -> Teaching:
    """The same, but every word about what is right or done is another."""

    def other(text: str) -> str:
        return COMMANDS[(COMMANDS.index(text) + 1) % len(COMMANDS)]

    def looks(old: Looks) -> Looks:
        shown = old.seen.examples
        labels = [other(text) for text in shown.labels]
        previous = [tuple(map(other, texts)) for texts in shown.previous]
        examples = replace(shown, labels=labels, previous=previous)
        return replace(old, seen=replace(old.seen, examples=examples))

    commands = ((taught.steps.commands + 1) % len(COMMANDS)).astype(np.int16)
    steps = replace(taught.steps, commands=commands, done=~taught.steps.done)
    return Teaching(looks(taught.decisions), looks(taught.moments), steps)
