from collections.abc import Iterator

import pytest

from tests.integration.wire.processes import RouterProcess


@pytest.fixture
def router() -> Iterator[RouterProcess]:
    with RouterProcess() as process:
        yield process
