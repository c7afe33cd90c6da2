"""Whether a command is known, and which ones are meant perhaps."""

from services.correction_api.phrases import look_up
from services.correction_api.views import Phrase

BANK = ("pick up the cheese", "pick up the ham", "put it on the plate", "wait")


def test_a_known_command_is_known() -> None:
    assert look_up("wait", BANK) == Phrase(known=True)


def test_a_slip_of_the_finger_is_new_and_the_meant_one_comes_first() -> None:
    phrase = look_up("Pick up the chese", BANK)
    assert phrase is not None
    assert not phrase.known
    assert phrase.nearest[0] == "pick up the cheese"


def test_something_new_is_near_to_nothing() -> None:
    assert look_up("xxxx", BANK) == Phrase(known=False)


def test_before_any_policy_spoke_nothing_is_said_of_a_command() -> None:
    assert look_up("wait", ()) is None
