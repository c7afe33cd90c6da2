"""One thread writes, many jobs share a commit, and no job can spoil another."""

import threading
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Connection, insert

from services.correction_api.store.store import Store
from services.correction_api.store.tables import outbox
from services.correction_api.store.writer import StoreError
from tests.unit.correction_api.store import opened_store


def _add(store: Store, name: str) -> "Future[Any]":
    values = {"id": name, "key": "k", "payload": b"x"}
    return store.writer.submit(lambda connection: connection.execute(insert(outbox), values))


def test_jobs_that_wait_together_are_committed_together(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        gate, transactions = threading.Event(), set[int]()
        store.writer.submit(lambda _: gate.wait(5))

        def work(connection: Connection) -> None:
            transactions.add(id(connection.get_transaction()))

        futures = [store.writer.submit(work) for _ in range(20)]
        gate.set()
        for future in futures:
            future.result(5)
    assert len(transactions) == 1


def test_a_job_that_fails_takes_no_other_with_it(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        gate = threading.Event()
        store.writer.submit(lambda _: gate.wait(5))
        futures = [_add(store, name) for name in ("one", "one", "two")]
        gate.set()
        futures[0].result(5)
        with pytest.raises(StoreError, match="UNIQUE"):
            futures[1].result(5)
        futures[2].result(5)
        assert [parcel.id for parcel in store.parcels.pending()] == ["one", "two"]


def test_a_full_disk_is_an_error_of_the_store_and_passes(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:

        def limit(pages: int) -> None:
            query = f"PRAGMA max_page_count={pages}"
            store.writer.submit(lambda connection: connection.exec_driver_sql(query)).result(5)

        limit(1)
        big = {"id": "big", "key": "k", "payload": b"x" * 500_000}
        job = store.writer.submit(lambda connection: connection.execute(insert(outbox), big))
        with pytest.raises(StoreError, match="full"):
            job.result(5)
        limit(10_000)
        _add(store, "small").result(5)
        assert [parcel.id for parcel in store.parcels.pending()] == ["small"]


def test_closing_writes_what_is_queued_and_takes_no_more(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        futures = [_add(store, f"p-{number}") for number in range(50)]
        store.writer.close()
        assert all(future.done() for future in futures)
        with pytest.raises(StoreError, match="closed"):
            _add(store, "late")
