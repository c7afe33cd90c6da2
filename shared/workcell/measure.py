"""Measure the cell: skills and tasks by the scripted expert, speed. Prints a table and JSON."""

import argparse
import json
import time
from collections import Counter
from typing import Any

import numpy as np

from shared.workcell.cell import Cell
from shared.workcell.env import WorkcellEnv
from shared.workcell.expert import act
from shared.workcell.objects import KITCHEN, TABLE, Stock, rows
from shared.workcell.site import site_names
from shared.workcell.skills import (
    ATTEMPT_STEPS,
    PUT_DOWN,
    PUT_IN_BIN,
    PUT_IN_TUB,
    PUT_ON_PLATE,
    achieved,
    parse,
    pick,
)
from shared.workcell.tasks import TASKS

Row = dict[str, Any]

DECISION_STEPS = 20


PUTS = {
    KITCHEN: ((PUT_ON_PLATE, PUT_IN_BIN, PUT_DOWN), (0.4, 0.4, 0.2)),
    TABLE: ((PUT_IN_TUB, PUT_IN_BIN, PUT_DOWN), (0.4, 0.4, 0.2)),
}
"""What follows a pick on each table, and how often."""


def chain(rng: np.random.Generator, stock: Stock) -> list[str]:
    """All things of a table, one after another, each picked up and put somewhere."""
    puts, shares = PUTS[stock]
    return [
        command
        for item in rng.permutation(rows(stock))
        for command in (pick(int(item)), puts[int(rng.choice(len(puts), p=shares))])
    ]


def attempt(cell: Cell, command: str, steps: int = ATTEMPT_STEPS) -> int | None:
    """Carry out one command from here; the steps it took, None where they did not suffice."""
    skill, before = parse(command), cell.state()
    for step in range(steps):
        state = cell.state()
        if achieved(skill, before, state):
            return step
        cell.step(act(state, skill))
    return None


def skill_rates(episodes: int, site: str = "lab") -> dict[str, Row]:
    """Rate of success and median steps for each verb, one attempt each."""
    cell, tried, took = Cell(site), Counter[str](), dict[str, list[int]]()
    for episode in range(episodes):
        rng, stock = np.random.default_rng(episode), (KITCHEN, TABLE)[episode % 2]
        cell.reset(rng, stock)
        for command in chain(rng, stock):
            steps, verb = attempt(cell, command), parse(command).verb
            tried[verb] += 1
            took.setdefault(verb, []).extend([] if steps is None else [steps])
    return {
        verb: {
            "attempts": count,
            "success": len(took[verb]) / count,
            "median_steps": float(np.median(took[verb])),
        }
        for verb, count in tried.items()
    }


def rollout(env: WorkcellEnv, seed: int, task: str) -> tuple[bool, int]:
    """One episode, the oracle commanding every 20 steps and the expert acting."""
    env.reset(seed=seed, options={"task": task})
    command = None
    while True:
        if env.elapsed_steps % DECISION_STEPS == 0:
            command = env.task.next_command(env.state, env.brief, command)
        assert command is not None  # step 0 is a decision
        _, _, terminated, truncated, _ = env.step(act(env.state, parse(command)))
        if terminated or truncated:
            return terminated, env.elapsed_steps


def task_rates(episodes: int) -> dict[str, Row]:
    """Rate of success and mean steps for each task at each site, and control steps a second."""
    rates = {}
    for site in site_names():
        env = WorkcellEnv(site)
        for task in TASKS:
            start = time.process_time()
            runs = [rollout(env, seed, task) for seed in range(episodes)]
            steps = sum(steps for _, steps in runs)
            rates[f"{task} @ {site}"] = {
                "episodes": episodes,
                "success": float(np.mean([done for done, _ in runs])),
                "mean_steps": steps / episodes,
                "control_steps_per_cpu_s": steps / (time.process_time() - start),
                "failed_seeds": [seed for seed, (done, _) in enumerate(runs) if not done],
            }
        env.close()
    return rates


def render_ms(count: int = 50) -> dict[str, float]:
    """Milliseconds for a pair of small pictures, and for one presentation picture."""
    env = WorkcellEnv()
    env.images(), env.picture()
    start = time.perf_counter()
    for _ in range(count):
        env.images()
    small = (time.perf_counter() - start) / count
    start = time.perf_counter()
    env.picture()
    large = time.perf_counter() - start
    env.close()
    return {"pair_64": small * 1e3, "picture_960x720": large * 1e3}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m shared.workcell.measure", description=__doc__)
    parser.add_argument("--episodes", type=int, default=100)
    episodes = parser.parse_args().episodes
    skills, tasks, render = skill_rates(episodes), task_rates(episodes), render_ms()
    for name, row in {**skills, **tasks, "render": render}.items():
        print(f"{name:22}", *(f"{key}={_short(value)}" for key, value in row.items()))
    print(json.dumps({"skills": skills, "tasks": tasks, "render_ms": render}))


def _short(value: object) -> str:
    return f"{value:.3f}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
