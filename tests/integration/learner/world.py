"""What robots and people send to a learner."""

from typing import Any, NamedTuple

from shared.messages.episode import Episode
from shared.messages.message import Message
from shared.wire.codec import encode
from shared.wire.keys import robot_key, service_key
from tests.unit.learner.records import CHEESE, HAM, correction, decision, episode, receipt


class Sent(NamedTuple):
    """A message and where it goes."""

    key: str
    payload: bytes
    id: str


def happenings(name: str, low_level_sha256: str, overrides: int = 3) -> list[Sent]:
    """One episode in the order in which it is sent: decisions, words, and the episode itself."""
    sent = []
    for number in range(overrides):
        step = number * 40
        sent.append(_robot("decision", decision(name, step, executed=CHEESE)))
        said = correction(
            f"{name}-c{number}",
            HAM,
            episode=name,
            decision=f"{name}-{step}",
            seen_step=step,
            hold_steps=10,
        )
        sent.append(_api("correction", said))
        sent.append(_api("receipt", receipt(said.id, step, episode=name)))
    done = episode(name, decisions=overrides, corrections=overrides)
    ended: Episode = done.model_copy(update={"low_level_sha256": low_level_sha256})
    return [*sent, _robot("episode", ended)]


def _robot(name: str, message: Any) -> Sent:
    return Sent(robot_key("lab", "robot-1", name), encode(message), f"{name} {message.id}")


def _api(name: str, message: Message) -> Sent:
    key = service_key("lab", "correction-api", "api-1", name)
    about = getattr(message, "id", None) or message.model_dump()["correction"]
    return Sent(key, encode(message), f"{name} {about}")
