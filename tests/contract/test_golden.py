"""Bytes that were written once are read for ever."""

import importlib
import pkgutil

import numpy as np
import pytest

import shared.messages
from shared.messages.message import Message
from shared.wire.codec import decode, encode
from tests.contract.samples import GOLDEN, NUMBERS, UNFIT, golden_file, samples

FILES = sorted(GOLDEN.iterdir())
PARTS = {
    "Proposal",
    "LanguageGoal",
    "TensorRef",
    "Help",
    "TrialResult",
    "Near",
    "Recorded",
    "Share",
    "Compared",
    "RoundTold",
    "VersionTold",
    "RulingTold",
}  # They travel within others only.


def message_classes():
    """Every message class of `shared/messages` that travels by itself."""
    found = {}
    for module in pkgutil.iter_modules(shared.messages.__path__):
        for value in vars(importlib.import_module(f"shared.messages.{module.name}")).values():
            if isinstance(value, type) and issubclass(value, Message) and value is not Message:
                found[value.__name__] = value
    return {name: cls for name, cls in found.items() if name not in PARTS}


def assert_same(left, right):
    """Arrays make `==` of two messages undecided, so heads and arrays are compared apart."""
    assert left.without_arrays() == right.without_arrays()
    assert left.arrays.keys() == right.arrays.keys()
    for name in left.arrays:
        assert left.arrays[name].dtype == right.arrays[name].dtype
        np.testing.assert_array_equal(left.arrays[name], right.arrays[name])


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_golden_bytes_of_every_age_are_still_read(path):
    cls = {name.lower(): cls for name, cls in message_classes().items()}[path.stem.split("-")[0]]
    message = decode(cls, path.read_bytes())
    assert_same(decode(cls, encode(message)), message)


@pytest.mark.parametrize("cls", NUMBERS, ids=lambda cls: cls.__name__)
def test_the_newest_golden_bytes_say_what_the_sample_says(cls):
    assert_same(decode(cls, golden_file(cls, NUMBERS[cls]).read_bytes()), samples()[cls])


def test_every_message_has_a_sample_with_every_field_set():
    assert set(message_classes().values()) == set(NUMBERS) == set(samples())
    for cls, message in samples().items():
        unset = {name for name in cls.model_fields if name not in message.model_fields_set}
        assert unset - {"arrays", "reason"} == UNFIT.get(cls, set()), cls


def test_no_golden_file_was_taken_away():
    wanted = {golden_file(cls, n) for cls, last in NUMBERS.items() for n in range(1, last + 1)}
    assert set(FILES) == wanted
