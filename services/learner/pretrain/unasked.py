"""What asks for nothing: prohibitions, complaints and remarks, and how many of them are acted out.

Each file of `unasked/` has phrases by way of speaking. By `a` the rules on clauses grew; the
others are `held_out`: no rule was made by one, and nobody looked at what was missed in it.
`python -m services.learner.pretrain.unasked` counts.
"""

import tomllib
from functools import cache
from importlib import resources
from typing import NamedTuple

from services.learner.pretrain.reading_exam import STOCKS, present
from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.reader.meant import WAIT_ROW
from shared.policies.reader.reader import Reader, restore

HELD_OUT = "held_out"


class Unasked(NamedTuple):
    """phrases: none of them asks for an act. held_out: no rule was ever made because of one."""

    name: str
    phrases: tuple[str, ...]
    held_out: bool


@cache
def unasked() -> tuple[Unasked, ...]:
    """All files, by name."""
    folder = resources.files("services.learner.pretrain").joinpath("unasked")
    tables = {file.name: tomllib.loads(file.read_text()) for file in folder.iterdir()}
    return tuple(
        Unasked(
            name.removesuffix(".toml"),
            tuple(text for key, texts in tables[name].items() if key != HELD_OUT for text in texts),
            bool(tables[name].get(HELD_OUT)),
        )
        for name in sorted(tables)
    )


def acted_out(reader: Reader, phrases: tuple[str, ...]) -> list[str]:
    """Those that are read as an act that can be done on one of the tables, something in hand."""
    return [text for text in phrases if any(_acts(reader, text, row) for row in range(len(STOCKS)))]


def _acts(reader: Reader, text: str, stock: int) -> bool:
    there = present(STOCKS[stock])
    row = reader.read(text, there).command
    return row is not None and row != WAIT_ROW and bool(reader.possible(there)[row])


def main() -> None:
    """Count, by the reader of the project."""
    reader = restore(checkpoint.load(checkpoint.bundled("low_level"))[0], shared_encoder())
    for one in unasked():
        missed = acted_out(reader, one.phrases)
        kind = "held out" if one.held_out else "for development"
        print(
            f"{one.name}, {kind}: {len(one.phrases) - len(missed)} of {len(one.phrases)} not done"
        )


if __name__ == "__main__":
    main()
