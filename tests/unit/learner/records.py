"""Messages for tests, with everything filled in that a test doesn't care about."""

from typing import Any

import numpy as np

from services.learner.labels.aggregate import Label, LabelSettings, derive
from services.learner.store.memory import head_of
from services.learner.store.store import History
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision, Proposal
from shared.messages.episode import Episode, Outcome
from shared.messages.goal import LanguageGoal
from shared.messages.policy import Version
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling, Verb
from shared.seeds import COLLECTION

LOW = "a" * 64
CHEESE, HAM, TOAST = "pick up the cheese", "pick up the ham", "pick up the toast"


def arrays(shade: int = 0) -> dict[str, Any]:
    """An observation of one shade of grey."""
    return {
        "images": np.full((2, 64, 64, 3), shade, np.uint8),
        "proprioception": np.zeros(22, np.float32),
        "objects": np.zeros((9, 9), np.float32),
    }


def decision(episode: str = "e-1", step: int = 0, executed: str = CHEESE, **over: Any) -> Decision:
    """A decision that the version 1.0 took."""
    best = over.pop("best", executed)
    fields = {
        "id": f"{episode}-{step}",
        "robot": "robot-1",
        "episode": episode,
        "index": step // 20,
        "step": step,
        "time_ns": 1_000 + step,
        "task": "sandwich",
        "prompt": "make a sandwich with cheese",
        "proposed": (Proposal(goal=LanguageGoal(text=best), score=0.9),),
        "executed": LanguageGoal(text=executed),
        "chosen_by": "1.0",
        "version": Version(1, 0),
        "arrays": arrays(step % 256),
    }
    return Decision.model_validate({**fields, **over})


def correction(id_: str, text: str | None = None, **over: Any) -> Correction:
    """An override to `text`; another kind where one is given."""
    fields = {
        "id": id_,
        "robot": "robot-1",
        "episode": "e-1",
        "kind": Kind.OVERRIDE,
        "author": "ada",
        "goal": LanguageGoal(text=text) if text else None,
        "begun_ns": 1,
        "created_ns": 2,
    }
    return Correction.model_validate({**fields, **over})


def receipt(id_: str, step: int | None, **over: Any) -> Receipt:
    """The robot obeyed at `step`; None: it refused."""
    fields = {
        "correction": id_,
        "robot": "robot-1",
        "episode": "e-1",
        "accepted": step is not None,
        "step": step,
        "reason": "" if step is not None else "its episode is over",
        "time_ns": 10 + (step or 0),
    }
    return Receipt.model_validate({**fields, **over})


def episode(id_: str = "e-1", **over: Any) -> Episode:
    """A finished attempt of 200 steps."""
    fields = {
        "id": id_,
        "robot": "robot-1",
        "number": 1,
        "task": "sandwich",
        "prompt": "make a sandwich with cheese",
        "site": "demo",
        "seed": COLLECTION.start + 5,
        "version": Version(1, 0),
        "low_level_sha256": LOW,
        "outcome": Outcome.SUCCESS,
        "steps": 200,
        "decisions": 0,
        "corrections": 0,
        "started_ns": 1,
        "ended_ns": 2,
    }
    return Episode.model_validate({**fields, **over})


def ruling(id_: str = "say-1", **over: Any) -> Ruling:
    """Version 0 again; another verb where one is given."""
    fields = {"id": id_, "verb": Verb.ROLLBACK, "author": "ada", "created_ns": 3}
    if "verb" not in over:
        fields["version"] = 0
    return Ruling.model_validate({**fields, **over})


def history_of(*messages: Any) -> History:
    """What a store would tell of these messages."""
    kinds: dict[type, list[Any]] = {
        kind: [] for kind in (Decision, Correction, Receipt, Episode, Ruling)
    }
    for message in messages:
        kinds[type(message)].append(message)
    heads = tuple(map(head_of, kinds.pop(Decision)))
    return History(heads, *map(tuple, kinds.values()))


def labels_of(*messages: Any, **over: Any) -> dict[int, Label]:
    """The labels of what happened, by step; the episode e-1 is added where none is given."""
    ended = [] if any(isinstance(message, Episode) for message in messages) else [episode()]
    found = derive(history_of(*messages, *ended), LabelSettings(**over), LOW)
    return {int(label.decision.rsplit("-", 1)[1]): label for label in found}


def texts(labels: dict[int, Label]) -> dict[int, str]:
    """What each decision should have been, by step."""
    return {step: label.text for step, label in labels.items()}


def every_20(last: int, **over: Any) -> list[Decision]:
    """A decision every 20 steps."""
    return [decision(step=step, **over) for step in range(0, last + 1, 20)]
