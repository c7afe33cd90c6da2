"""Which skills does the low level have: each by itself, and in tasks with an oracle above it."""

from typing import Any

import numpy as np

from services.learner.experiments.bench import Bench
from services.learner.experiments.findings import Findings, Panel, Plot, Table, cell, curve
from services.learner.experiments.scenes import setting_for
from shared.evaluation.attempts import skill_name
from shared.evaluation.phrase import Said, Trial
from shared.evaluation.summary import summarize
from shared.intervals import rate
from shared.workcell.site import site_names
from shared.workcell.skills import ATTEMPT_STEPS, SKILLS, Skill


def run(bench: Bench) -> Findings:
    """Each skill: one attempt a scene. Each task: one episode a scene, at each site."""
    skills = [skill for skill in SKILLS if skill.verb != "wait"]
    trials = {skill.text: _trials(skill, bench) for skill in skills}
    said = bench.phrases(f"skills-{bench.site}", [one for some in trials.values() for one in some])
    alone = {text: _figures([one for one in said if one.expected == text]) for text in trials}
    sites = (
        [bench.site] if bench.small else sorted(site_names(), key=lambda name: name != bench.site)
    )
    tasks = {
        f"{task} at {site}": summarize(
            bench.episodes(
                f"oracle-{task}-{site}", bench.plan(high_level="oracle", tasks=(task,), site=site)
            )
        )
        for site in sites
        for task in bench.tasks()
    }
    return Findings(
        title="What the low level can do",
        method=(
            f"Each skill is attempted once a scene, within {ATTEMPT_STEPS} control steps, in the "
            f"{bench.site}; the scripted expert prepares the scene: for a put it has done 0, 2 or "
            "4 skills of a task, and then picked up a random thing.",
            "In tasks an oracle, which knows the true state, says at each decision what is right.",
        ),
        figures={"skills": alone, "verbs": _verbs(said, skills), "tasks": tasks},
        tables=(_alone(alone), _in_tasks(tasks)),
        plots=(
            Plot(
                name="skills",
                title="Skills",
                x_label="",
                panels=(Panel(title="one attempt each", curves=(curve("π_LL", alone),)),),
            ),
        ),
    )


def _trials(skill: Skill, bench: Bench) -> list[Trial]:
    return [
        Trial(setting=setting_for(skill, bench, number), phrase=skill.text, expected=skill.text)
        for number in range(bench.n)
    ]


def _figures(said: list[Said]) -> dict[str, Any]:
    steps = [one.steps for one in said if one.success]
    return {
        **rate([one.success for one in said]),
        "median_steps": float(np.median(steps)) if steps else None,
    }


def _verbs(said: list[Said], skills: list[Skill]) -> dict[str, Any]:
    names = {skill.text: skill_name(skill) for skill in skills}
    return {
        name: _figures([one for one in said if names[one.expected] == name])
        for name in dict.fromkeys(names.values())
    }


def _alone(alone: dict[str, Any]) -> Table:
    rows = [
        (text, cell(found), str(found["n"]), str(found["median_steps"] or ""))
        for text, found in alone.items()
    ]
    columns = ("skill", "success (95 %)", "n", "median steps")
    return Table(title="One skill, one attempt", columns=columns, rows=tuple(rows))


def _in_tasks(tasks: dict[str, Any]) -> Table:
    rows = [
        (
            name,
            cell(found),
            str(found["n"]),
            f"{found['steps']:.0f}",
            ", ".join(
                f"{skill} {rates['success']:.3f} of {rates['n']}"
                for skill, rates in found["skills"].items()
            ),
        )
        for name, found in tasks.items()
    ]
    columns = ("task", "success (95 %)", "n", "steps", "attempts at skills")
    return Table(title="Tasks, the oracle above", columns=columns, rows=tuple(rows))
