"""A router and small checkpoints for all tests of this folder, and a learner for each."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from shared.wire.bus import Bus, BusSettings, open_bus
from tests.integration.learner.lab import Lab
from tests.integration.learner.process import Process
from tests.unit.learner.checkpoints import Checkpoints, small_checkpoints


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Checkpoints:
    return small_checkpoints(tmp_path_factory.mktemp("checkpoints"))


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    log = tmp_path_factory.mktemp("router") / "log"
    process = Process("deploy.router", "--set", f'listen=["{endpoint}"]', log=log)
    yield endpoint
    process.end()


@pytest.fixture
def bus(router: str) -> Iterator[Bus]:
    with open_bus(BusSettings(connect=(router,))) as session:
        assert session.joined(20)
        yield session


@pytest.fixture
def lab(tmp_path: Path, router: str, bus: Bus, checkpoints: Checkpoints) -> Iterator[Lab]:
    made = Lab(tmp_path, router, bus, checkpoints)
    yield made
    made.close()
