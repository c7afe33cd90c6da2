"""The reader that comes with the project."""

import pytest

from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.reader.reader import Reader, restore


@pytest.fixture(scope="session")
def reader() -> Reader:
    return restore(checkpoint.load(checkpoint.bundled("low_level"))[0], shared_encoder())
