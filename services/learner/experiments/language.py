"""Does the low level do what is said: in other words, against the obvious, and only what it can?"""

from typing import Any

import numpy as np

from services.learner.experiments import sides
from services.learner.experiments.bench import Bench
from services.learner.experiments.findings import Findings, Panel, Plot, Table, cell, curve
from services.learner.experiments.scenes import setting_for
from services.learner.pretrain.everyday import FORMS, forms_of, has_new_word, sealed, writings
from services.learner.pretrain.unheard import unheard_phrases, unheard_refusals
from shared.evaluation.phrase import Said, Trial
from shared.evaluation.scene import ANYTHING, Setting
from shared.intervals import rate
from shared.workcell.skills import ATTEMPT_STEPS, COMMANDS, WAIT, parse

MOST_LEAD = 5


def run(bench: Bench) -> Findings:
    """Phrases that were never trained on, commands against the obvious, what can't be done."""
    everyday = _Everyday(bench)
    reworded = bench.phrases("reworded", _reworded(bench))
    contrary = bench.phrases("contrary", against_the_obvious(bench))
    outlandish = bench.phrases("outlandish", _impossible(bench, unheard_refusals()))
    kinds = [kind for _, _, kind in _sentences(bench)]
    by_new = {
        new: _figures([one for one, kind in zip(reworded, kinds, strict=True) if kind == new])
        for new in ("verb", "noun", "both")
    }
    by_command = _by_expected(reworded)
    figures = {
        "everyday": everyday.figures(),
        "reworded": {**_figures(reworded), "new": by_new, "commands": by_command},
        "contrary": {
            **_figures(contrary),
            "moving": _figures([one for one in contrary if one.expected != WAIT]),
            "did_the_obvious": rate([one.obvious in one.done for one in contrary]),
        },
        "outlandish": rate([bool(one.refused) for one in outlandish]),
        "sides": sides.figures(bench),
    }
    return Findings(
        title="Language: what is said is done",
        method=(
            "Everyday: phrases for each command by several writers who had not seen what was "
            "taught, with other verbs and nouns, in other orders, with courtesy and protest; what "
            "was missed in them has been taught since, except those held out; each "
            f"is said in one scene; success is that it was achieved within {ATTEMPT_STEPS} steps, "
            "or refused where no robot here can obey.",
            "Reworded: a sentence for a command, with a verb or a noun or both that the low level "
            "was never taught, half of them with a word of courtesy or protest, is said once a "
            "scene; success is the same. The words are rare: the common ones are taught.",
            "Contrary: in the midst of a task, when the next step is obvious, a command is said "
            "that contradicts it; success is that the command was achieved, and not the obvious.",
            "Outlandish: sentences that no robot here can obey, with words never taught; success "
            "is that they are refused. These, and the everyday ones to be refused, are said with "
            "something in a hand, so that picks and puts are possible.",
            "Sides: of two things that one name fits, the left or the right one is told, in "
            f"{len(sides.FORMS)} forms, with and without 'no', each for both; success is that "
            "this one was taken, the opposite that the other one was.",
        ),
        figures=figures,
        tables=(
            _table(figures),
            _by_command("Everyday", figures["everyday"]["commands"]),
            _by_command("Reworded", by_command),
        ),
        plots=(
            Plot(
                name="language",
                title="Commands in other words",
                x_label="",
                panels=(
                    Panel(
                        title="achieved",
                        curves=(
                            curve("everyday", figures["everyday"]["commands"]),
                            curve("reworded", by_command),
                        ),
                    ),
                ),
            ),
        ),
    )


class _Everyday:
    """Phrases of all writings, each in a scene of its own; of a command at most as many as there
    are scenes."""

    def __init__(self, bench: Bench) -> None:
        writers: dict[Trial, str] = {}
        for writing in writings():
            for command, phrases in writing.said.items():
                for number, phrase in enumerate(phrases[: bench.n]):
                    held = writing.held.get(phrase, ANYTHING)
                    setting = setting_for(parse(command), bench, number, held)
                    trial = Trial(setting=setting, phrase=phrase, expected=command)
                    writers.setdefault(trial, writing.name)
        refused = [text for writing in writings() for text in writing.refused[: bench.n]]
        self._writers = list(writers.values())
        self._said = bench.phrases("everyday", list(writers))
        self._refused = bench.phrases("everyday-refused", _impossible(bench, refused))

    def figures(self) -> dict[str, Any]:
        """All, by writing, by command, of phrases with a new word; and of what is to be refused.

        Held out is what no other writing has.
        """
        by_writing = {
            name: _figures(
                [one for one, its in zip(self._said, self._writers, strict=True) if its == name]
            )
            for name in dict.fromkeys(self._writers)
        }
        held_out = sealed(writings())
        unseen = [one for one in self._said if one.phrase in held_out]
        return {
            **_figures(self._said),
            "writings": by_writing,
            "held_out": {**_figures(unseen), "forms": _by_form(unseen)},
            "new_word": _figures([one for one in self._said if has_new_word(one.phrase)]),
            "commands": _by_expected(self._said),
            "impossible": rate([bool(one.refused) for one in self._refused]),
            "impossible_held_out": rate(
                [bool(one.refused) for one in self._refused if one.phrase in held_out]
            ),
        }


def _by_expected(said: list[Said]) -> dict[str, dict[str, Any]]:
    return {text: _figures([one for one in said if one.expected == text]) for text in COMMANDS}


def _by_form(said: list[Said]) -> dict[str, dict[str, Any]]:
    forms = [forms_of(one.phrase, str(one.expected)) for one in said]
    return {
        form: _figures([one for one, its in zip(said, forms, strict=True) if form in its])
        for form in FORMS
    }


def _sentences(bench: Bench) -> list[tuple[str, str, str]]:
    """Command, sentence, and what is new in it: `bench.n` of each command."""
    return [
        (text, *sentences[number % len(sentences)])
        for text, sentences in zip(COMMANDS, unheard_phrases(), strict=True)
        for number in range(bench.n)
    ]


def _reworded(bench: Bench) -> list[Trial]:
    return [
        Trial(setting=setting_for(parse(text), bench, row % bench.n), phrase=phrase, expected=text)
        for row, (text, phrase, _) in enumerate(_sentences(bench))
    ]


def against_the_obvious(bench: Bench) -> list[Trial]:
    """In the midst of tasks, a command that contradicts the obvious next step; one a scene."""
    tasks, trials = bench.tasks(), []
    for number in range(bench.n):
        seed, task = bench.seed(number), tasks[number % len(tasks)]
        lead = int(np.random.default_rng(seed).integers(MOST_LEAD))
        trials.append(Trial(setting=Setting(seed=seed, task=task, lead=lead)))
    return trials


def _impossible(bench: Bench, phrases: list[str]) -> list[Trial]:
    """Said with something in a hand: with empty hands every put is refused anyway."""
    task = bench.tasks()[0]
    setting = Setting(seed=bench.seed(0), task=task, holding=ANYTHING)
    return [Trial(setting=setting, phrase=phrase, steps=1) for phrase in phrases]


def _figures(said: list[Said]) -> dict[str, Any]:
    return {
        **rate([one.success for one in said]),
        "understood": rate(
            [not one.refused and one.nearest[0].command == one.expected for one in said]
        ),
        "refused": rate([bool(one.refused) for one in said]),
    }


def _table(figures: dict[str, Any]) -> Table:
    contrary, outlandish = figures["contrary"], figures["outlandish"]
    everyday = figures["everyday"]
    rows = (
        ("everyday, held out, achieved", *_rate(everyday["held_out"])),
        *(
            (f"everyday, held out, {form}, achieved", *_rate(found))
            for form, found in everyday["held_out"]["forms"].items()
        ),
        ("everyday, held out, read rightly", *_rate(everyday["held_out"]["understood"])),
        ("everyday, held out, impossible, refused", *_rate(everyday["impossible_held_out"])),
        ("everyday, all, achieved", *_rate(everyday)),
        *(
            (f"everyday, writing {name}, achieved", *_rate(found))
            for name, found in everyday["writings"].items()
        ),
        ("everyday, with a word never taught, achieved", *_rate(everyday["new_word"])),
        ("everyday, read rightly", *_rate(everyday["understood"])),
        ("everyday, refused", *_rate(everyday["refused"])),
        ("everyday, impossible, refused", *_rate(everyday["impossible"])),
        ("reworded, achieved", cell(figures["reworded"]), str(figures["reworded"]["n"])),
        *(
            (f"reworded, new {new}, achieved", cell(found), str(found["n"]))
            for new, found in figures["reworded"]["new"].items()
        ),
        ("reworded, read rightly", *_rate(figures["reworded"]["understood"])),
        ("reworded, refused", *_rate(figures["reworded"]["refused"])),
        ("contrary, achieved", cell(contrary), str(contrary["n"])),
        ("contrary, without waits, achieved", *_rate(contrary["moving"])),
        ("contrary, the obvious done instead", *_rate(contrary["did_the_obvious"])),
        ("outlandish, refused", *_rate(outlandish)),
        ("told by its side, taken", *_rate(figures["sides"])),
        *(
            (f"told by its side, {side}, taken", *_rate(found))
            for side, found in figures["sides"]["sides"].items()
        ),
        *(
            (f"told as '{form}', taken", *_rate(found))
            for form, found in figures["sides"]["forms"].items()
        ),
        ("told by its side, refused", *_rate(figures["sides"]["refused"])),
        ("told by its side, the opposite taken", *_rate(figures["sides"]["opposite"])),
    )
    return Table(title="In short", columns=("what", "share (95 %)", "n"), rows=rows)


def _rate(found: dict[str, Any]) -> tuple[str, str]:
    return cell(found), str(found["n"])


def _by_command(name: str, by_command: dict[str, Any]) -> Table:
    rows = tuple(
        (text, cell(found), cell(found["understood"]), str(found["n"]))
        for text, found in by_command.items()
    )
    columns = ("command", "achieved (95 %)", "nearest of all (95 %)", "n")
    return Table(title=f"{name}, by command", columns=columns, rows=rows)
