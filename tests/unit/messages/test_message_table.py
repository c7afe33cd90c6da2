"""The README of the messages says all that travels."""

import re

from tests.contract.samples import NUMBERS
from tests.integration.wire.processes import ROOT

README = (ROOT / "shared" / "messages" / "README.md").read_text()


def test_each_message_has_a_row():
    firsts = re.findall(r"^\|([^|]*)\|", README, re.MULTILINE)
    rows = {name for first in firsts for name in re.findall(r"`(\w+)`", first)}
    assert {cls.__name__ for cls in NUMBERS} <= rows


def test_each_module_is_named():
    modules = {path.stem for path in (ROOT / "shared" / "messages").glob("*.py")} - {"__init__"}
    assert {name for name in modules if f"{name}.py" not in README} == set()


def test_each_array_has_its_shape_in_the_legend():
    for cls in NUMBERS:
        for name in cls.ARRAYS:
            assert f"`{name}`" in README, f"{cls.__name__}.{name}"
