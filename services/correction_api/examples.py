"""Examples for the OpenAPI text; a test holds each against the model of its route."""

from typing import Any

from services.correction_api.problems import MEDIA_TYPE, TYPE_PREFIX

Json = dict[str, Any]

PROPOSED: list[Json] = [
    {"goal": {"family": "language", "text": "pick up the tomato"}, "score": 0.48},
    {"goal": {"family": "language", "text": "pick up the cheese"}, "score": 0.31},
]

ROBOT: Json = {
    "robot": "robot-1",
    "actor": "actor-1",
    "presence": "online",
    "age_s": 0.2,
    "state": "acting",
    "task": "sandwich",
    "prompt": "make a sandwich with cheese and tomato",
    "site": "far",
    "episode": "ep-5f1c",
    "number": 7,
    "step": 64,
    "command": PROPOSED[0]["goal"],
    "by": "policy",
    "chosen_by": "1.0",
    "author": None,
    "course": [
        {"step": 0, "text": "pick up the bread", "by": "policy"},
        {"step": 60, "text": "pick up the tomato", "by": "policy"},
    ],
    "decision": {
        "id": "ep-5f1c-3",
        "index": 3,
        "step": 60,
        "proposed": PROPOSED,
        "awaits_verdict": False,
    },
    "version": "1.0",
    "supervised": False,
    "real_time": True,
    "pending": 0,
    "pictures": 1.0,
    "cameras": ["top", "angle"],
}

DECISION: Json = {
    "id": "ep-5f1c-3",
    "robot": "robot-1",
    "episode": "ep-5f1c",
    "index": 3,
    "step": 60,
    "time_ns": 1_795_442_400_000_000_000,
    "task": "sandwich",
    "prompt": "make a sandwich with cheese and tomato",
    "previous": ["pick up the bread", "put it on the plate"],
    "proposed": PROPOSED,
    "executed": PROPOSED[0]["goal"],
    "chosen_by": "1.0",
    "version": "1.0",
    "awaits_verdict": False,
    "truth": {},
}

HELP: Json = {
    "asking": [
        {
            "robot": "robot-1",
            "episode": "ep-5f1c",
            "decision": "ep-5f1c-3",
            "step": 60,
            "since_ns": 1_795_442_400_000_000_000,
            "reason": "entropy",
            "doubt": 0.62,
            "waits_s": 12.5,
            "prompt": "make a sandwich with cheese and tomato",
            "command": PROPOSED[0]["goal"],
            "proposed": PROPOSED,
        }
    ],
    "suppressed": 0,
}

CORRECTION: Json = {
    "correction": {
        "id": "say-0a1b2c3d4e5f6071",
        "robot": "robot-1",
        "episode": "ep-5f1c",
        "kind": "override",
        "author": "anna",
        "goal": {"family": "language", "text": "pick up the cheese"},
        "decision": "ep-5f1c-3",
        "seen_step": 60,
        "hold_steps": None,
        "delay_steps": 0,
        "begun_ns": 1_795_442_401_000_000_000,
        "created_ns": 1_795_442_402_000_000_000,
        "note": None,
    },
    "status": "in force",
    "receipt": {
        "correction": "say-0a1b2c3d4e5f6071",
        "robot": "robot-1",
        "episode": "ep-5f1c",
        "accepted": True,
        "step": 71,
        "replaced": None,
        "reason": "",
        "time_ns": 1_795_442_402_004_000_000,
    },
    "reason": "",
    "replaced_by": None,
    "sequence": 12,
    "phrase": {"known": True, "nearest": []},
    "learned_in": "1.1",
    "held_out": False,
}

PENDING: Json = CORRECTION | {"status": "pending", "receipt": None, "learned_in": None}

_PAUSE: Json = {"kind": "pause", "goal": None, "decision": None, "seen_step": None}

PAUSED: Json = {
    "id": "stop-0a1b2c3d",
    "robots": [
        {
            "robot": "robot-1",
            "status": "in force",
            "reason": "",
            "correction": CORRECTION
            | {"correction": CORRECTION["correction"] | _PAUSE}
            | {"phrase": None, "learned_in": None},
        },
        {
            "robot": "robot-2",
            "status": "refused",
            "reason": "robot-2 is between two episodes; wait until the next one has begun",
            "correction": None,
        },
    ],
}

COMMANDS: Json = {
    "robot": "robot-1",
    "commands": ["pick up the bread", "pick up the cheese", "put it on the plate", "wait"],
    "asked": True,
}

UNDERSTOOD: Json = {
    "robot": "robot-1",
    "text": "grab the yellow slice",
    "step": 64,
    "known": False,
    "means": "pick up the cheese",
    "refused": "",
    "nearest": [{"command": "pick up the cheese", "score": 0.93}],
}

CORRECTIONS: Json = {"corrections": [CORRECTION], "next": "12"}

EPISODE: Json = {
    "id": "ep-5f1c",
    "robot": "robot-1",
    "number": 7,
    "task": "sandwich",
    "prompt": "make a sandwich with cheese and tomato",
    "site": "far",
    "seed": 1_000_000_007,
    "version": "1.0",
    "low_level_sha256": "5d" * 32,
    "outcome": "success",
    "steps": 512,
    "decisions": 26,
    "corrections": 2,
    "started_ns": 1_795_442_400_000_000_000,
    "ended_ns": 1_795_442_410_240_000_000,
}

LEARNER: Json = {
    "presence": "online",
    "age_s": 0.3,
    "learner": "learner-1",
    "time_ns": 1_795_442_402_000_000_000,
    "state": "collecting",
    "version": "1.1",
    "round": 1,
    "episodes": 12,
    "successes": 7,
    "corrections": 31,
    "decisions": 240,
    "reason": "",
    "progress": 0.0,
    "policy": {
        "version": "1.1",
        "created_ns": 1_795_442_300_000_000_000,
        "bank": ["pick up the bread", "pick up the cheese", "put it on the plate", "wait"],
        "low_level_sha256": "5d" * 32,
    },
    "outbox": 0,
}


SPEECH: Json = {
    "available": True,
    "reason": "",
    "engines": [
        {
            "engine": "pocketsphinx",
            "available": True,
            "install": "pip install 'hl-dagger[speech]'",
        },
        {"engine": "whisper", "available": False, "install": "pip install 'hl-dagger[whisper]'"},
    ],
    "media_type": "audio/l16; rate=16000",
    "max_s": 15.0,
    "commands": ["pick up the tomato", "pick up the cheese", "wait"],
}

RECOGNITION: Json = {
    "heard": [
        {
            "engine": "pocketsphinx",
            "text": "no the cheese first",
            "command": "pick up the cheese",
        },
    ],
    "agreed": None,
    "choices": ["pick up the cheese"],
}


def answered(example: Any, description: str) -> Json:
    """What OpenAPI is to say of a good answer."""
    return {"description": description, "content": {"application/json": {"example": example}}}


def refused(name: str, title: str, detail: str, status: int = 409, **more: Any) -> Json:
    """What OpenAPI is to say of an error, with an example of its own."""
    example = {"type": TYPE_PREFIX + name, "title": title, "status": status, "detail": detail}
    schema = {"$ref": "#/components/schemas/ProblemDetail"}
    return {
        "description": title,
        "content": {MEDIA_TYPE: {"schema": schema, "example": example | more}},
    }
