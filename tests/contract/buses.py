"""What tests of a bus do again and again: hear, see that somebody listens, ask until somebody is
there."""

from shared.errors import NoAnswerError
from tests.integration.wire.processes import until


def heard_by(bus, keys, **options):
    """What a new subscription hears, as a list that grows; the subscription."""
    heard = []
    subscription = bus.subscribe(keys, lambda key, data: heard.append((key, data)), **options)
    return heard, subscription


def in_touch(bus, key):
    until(lambda: bus.watched(key), what=f"{key} is watched")


def answered(bus, key, payload=b""):
    """Ask until somebody is there: a bus hears of those who serve within milliseconds."""
    answers = []

    def tried():
        try:
            answers.append(bus.ask(key, payload, timeout_s=1))
        except NoAnswerError:
            return False
        return True

    until(tried)
    return answers[0]
