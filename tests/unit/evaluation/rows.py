"""Rows that were made up."""

from shared.evaluation.attempts import Attempt, Row

SHA = "a" * 64


def row(seed=2_000_000_000, success=True, task="sandwich", failure="", attempts=(), **fields):
    return Row(
        seed=seed,
        task=task,
        prompt="do it",
        success=success,
        progress=1.0 if success else 0.5,
        failure="" if success else failure or "out of time",
        attempts=attempts,
        low_level_sha256=SHA,
        **{"steps": 100, "decisions": 5, "asked": {"start": 1, "interval": 4}, **fields},
    )


def attempt(command="pick up the ham", skill="pick up", success=True, wrong=0, steps=40):
    return Attempt(command=command, skill=skill, success=success, begin=0, steps=steps, wrong=wrong)
