"""Does the low level do what is said: in other words, against the obvious, and only what it can?"""

from typing import Any

import numpy as np

from services.learner.experiments.bench import Bench
from services.learner.experiments.findings import Findings, Panel, Plot, Table, cell, curve
from services.learner.experiments.scenes import setting_for
from services.learner.pretrain.unheard import unheard_phrases, unheard_refusals
from shared.evaluation.phrase import Said, Trial
from shared.evaluation.scene import Setting
from shared.evaluation.watch import ATTEMPT_STEPS
from shared.intervals import rate
from shared.workcell.skills import COMMANDS, parse

MOST_LEAD = 5


def run(bench: Bench) -> Findings:
    """Phrases that were never trained on, commands against the obvious, what can't be done."""
    reworded = bench.phrases("reworded", _reworded(bench))
    contrary = bench.phrases("contrary", _contrary(bench))
    outlandish = bench.phrases("outlandish", _outlandish(bench))
    kinds = [kind for _, _, kind in _sentences(bench)]
    by_new = {
        new: _figures([one for one, kind in zip(reworded, kinds, strict=True) if kind == new])
        for new in ("verb", "noun", "both")
    }
    by_command = {
        text: _figures([one for one in reworded if one.expected == text]) for text in COMMANDS
    }
    figures = {
        "reworded": {**_figures(reworded), "new": by_new, "commands": by_command},
        "contrary": {
            **_figures(contrary),
            "did_the_obvious": rate([one.obvious in one.done for one in contrary]),
        },
        "outlandish": rate([bool(one.refused) for one in outlandish]),
    }
    return Findings(
        title="Language: what is said is done",
        method=(
            "Reworded: a sentence for a command, with a verb or a noun or both that the low level "
            "was never taught, half of them with a word of courtesy or protest, is said once a "
            f"scene; success is that the command was achieved within {ATTEMPT_STEPS} steps.",
            "Contrary: in the midst of a task, when the next step is obvious, a command is said "
            "that contradicts it; success is that the command was achieved, and not the obvious.",
            "Outlandish: sentences that no robot here can obey, with words never taught; success "
            "is that they are refused.",
        ),
        figures=figures,
        tables=(_table(figures), _by_command(by_command)),
        plots=(
            Plot(
                name="language",
                title="Reworded commands",
                x_label="",
                panels=(Panel(title="reworded", curves=(curve("achieved", by_command),)),),
            ),
        ),
    )


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


def _contrary(bench: Bench) -> list[Trial]:
    tasks, trials = bench.tasks(), []
    for number in range(bench.n):
        seed, task = bench.seed(number), tasks[number % len(tasks)]
        lead = int(np.random.default_rng(seed).integers(MOST_LEAD))
        trials.append(Trial(setting=Setting(seed=seed, task=task, lead=lead)))
    return trials


def _outlandish(bench: Bench) -> list[Trial]:
    task = bench.tasks()[0]
    return [
        Trial(setting=Setting(seed=bench.seed(0), task=task), phrase=phrase, steps=1)
        for phrase in unheard_refusals()
    ]


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
    rows = (
        ("reworded, achieved", cell(figures["reworded"]), str(figures["reworded"]["n"])),
        *(
            (f"reworded, new {new}, achieved", cell(found), str(found["n"]))
            for new, found in figures["reworded"]["new"].items()
        ),
        ("reworded, read rightly", *_rate(figures["reworded"]["understood"])),
        ("reworded, refused", *_rate(figures["reworded"]["refused"])),
        ("contrary, achieved", cell(contrary), str(contrary["n"])),
        ("contrary, the obvious done instead", *_rate(contrary["did_the_obvious"])),
        ("outlandish, refused", *_rate(outlandish)),
    )
    return Table(title="In short", columns=("what", "share (95 %)", "n"), rows=rows)


def _rate(found: dict[str, Any]) -> tuple[str, str]:
    return cell(found), str(found["n"])


def _by_command(by_command: dict[str, Any]) -> Table:
    rows = tuple(
        (text, cell(found), cell(found["understood"]), str(found["n"]))
        for text, found in by_command.items()
    )
    columns = ("command", "achieved (95 %)", "nearest of all (95 %)", "n")
    return Table(title="Reworded, by command", columns=columns, rows=rows)
