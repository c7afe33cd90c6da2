"""Examples of what is read afterwards; a test holds each against the model of its route."""

from services.correction_api.examples import CORRECTION, DECISION, EPISODE, Json

EPISODES: Json = {
    "episodes": [EPISODE | {"calls": 1, "taught": 2}],
    "tally": [{"version": "1.0", "episodes": 20, "successes": 6, "corrections": 88}],
    "tasks": ["bus", "pack", "sandwich"],
    "next": None,
}

ACCOUNT: Json = {
    "id": "ep-5f1c",
    "robot": "robot-1",
    "episode": EPISODES["episodes"][0],
    "corrections": [CORRECTION],
    "more": False,
    "calls": [
        {
            "decision": "ep-5f1c-3",
            "step": 60,
            "time_ns": 1_795_442_400_000_000_000,
            "reason": "entropy",
            "doubt": 0.62,
            "waits_s": 0.0,
        }
    ],
}

_TOLD = ("id", "index", "step", "time_ns", "prompt", "proposed", "executed", "chosen_by", "version")

RECORDING: Json = {
    "episode": "ep-5f1c",
    "robot": "robot-1",
    "decisions": [
        {name: DECISION[name] for name in _TOLD}
        | {"asked": "interval", "entropy": 0.93, "choice": "best", "help": None}
    ],
    "next": None,
}

PROGRESS: Json = {
    "versions": [
        {
            "version": "1.1",
            "number": 1,
            "also": ["2.1"],
            "service": {"share": 0.9, "n": 20, "low": 0.699, "high": 0.972},
            "alone": {"share": 0.71, "n": 200, "low": 0.644, "high": 0.768},
            "corrections": 31,
            "human_s": 84.5,
        }
    ]
}

_BEFORE = {"share": 0.52, "n": 200, "low": 0.451, "high": 0.588}

POLICY: Json = {
    "version": "1.1",
    "versions": [
        {
            "version": "1.1",
            "number": 1,
            "created_ns": 1_795_442_300_000_000_000,
            "round": 1,
            "again": None,
            "ruling": None,
            "robots": [],
            "in_force": True,
        }
    ],
    "rounds": [
        {
            "number": 1,
            "epoch": 1,
            "parent": 0,
            "made": 1,
            "state": "passed",
            "episodes": 24,
            "corrections": 14,
            "labels": 433,
            "held_out": None,
            "retained": None,
            "unjudged": "",
            "trials": {"before": _BEFORE, "after": PROGRESS["versions"][0]["alone"]},
            "trials_p": 0.0001,
            "seconds": 99.1,
            "promotable": False,
            "reason": "",
            "begun_ns": 1_795_442_200_000_000_000,
            "ended_ns": 1_795_442_300_000_000_000,
            "brought": "14 corrections: 52 % → 71 %, n = 200 in the gate's paired episodes",
        }
    ],
    "rulings": [],
}

RULING: Json = {
    "ruling": {
        "id": "rule-0a1b2c3d4e5f6071",
        "verb": "rollback",
        "author": "anna",
        "round": None,
        "version": 1,
        "phrase": None,
        "means": None,
        "reason": "1.2 drops the bread",
        "created_ns": 1_795_442_400_000_000_000,
    },
    "state": "waiting",
    "made": None,
    "why": "",
}

REPORT: Json = {
    "schema": 1,
    "title": "Transitions: interval, completion, both",
    "date": "2026-11-26",
    "command": "hld experiment transitions --n 120",
    "site": "lab",
    "figures": {
        "oracle": {
            "slow": {
                "interval": {
                    "success": 0.57,
                    "n": 120,
                    "interval": [0.49, 0.66],
                    "decisions": 17,
                }
            }
        }
    },
}

REPORTS: Json = {"reports": [{"name": "transitions", "measured": True, "hint": ""}]}
