"""The log: said once, closed once, in order, and with its parcels in the same commit."""

from pathlib import Path

from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext

from services.correction_api.store.engine import open_engine, upgrade
from services.correction_api.store.log import Status
from services.correction_api.store.tables import metadata
from shared.messages.correction import Kind
from tests.unit.correction_api.store import correction, opened_store, receipt


def test_the_migrations_make_the_tables_that_the_code_knows(tmp_path: Path) -> None:
    engine = open_engine(tmp_path / "a.sqlite", size=1)
    upgrade(engine)
    upgrade(engine)  # Again: nothing to do.
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
        assert connection.exec_driver_sql("PRAGMA synchronous").scalar() == 2
    engine.dispose()


def test_a_correction_is_kept_once_and_the_first_one_wins(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        first = store.log.append(correction("c-1"), "digest").result()
        again = store.log.append(correction("c-1", created_ns=99), "other").result()
        assert (again.sequence, again.digest) == (first.sequence, "digest")
        assert again.correction.created_ns == 1
        assert [parcel.id for parcel in store.parcels.pending()] == ["correction/c-1"]


def test_a_receipt_closes_once_and_follows_its_correction(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        store.log.append(correction("c-1"), "d").result()
        closed = store.log.answer(receipt("c-1")).result()
        assert closed is not None
        assert closed.entry.status is Status.IN_FORCE
        assert store.log.answer(receipt("c-1", reason="late")).result() is None
        assert store.log.answer(receipt("c-unknown")).result() is None
        found = store.log.find("c-1")
        assert found is not None
        assert found.receipt == receipt("c-1")
        sent = [(parcel.id, parcel.key.rpartition("/")[2]) for parcel in store.parcels.pending()]
        assert sent == [("correction/c-1", "correction"), ("receipt/c-1", "receipt")]


def test_what_expired_has_no_receipt_and_cannot_come_in_force(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        store.log.append(correction("c-1"), "d").result()
        expired = store.log.expire(correction("c-1"), "nobody answered").result()
        assert expired is not None
        assert (expired.entry.status, expired.entry.reason) == (Status.EXPIRED, "nobody answered")
        assert store.log.answer(receipt("c-1")).result() is None


def test_what_is_said_of_the_past_does_not_expire_but_is_kept(tmp_path: Path) -> None:
    past = correction("c-1").model_copy(
        update={"kind": Kind.RETRACT, "goal": None, "target": "c-0"}
    )
    with opened_store(tmp_path / "a.sqlite") as store:
        store.log.append(past, "d").result()
        closed = store.log.expire(past, "nobody answered").result()
        assert closed is not None
        assert (closed.entry.status, closed.entry.reason) == (Status.KEPT, "nobody answered")
        late = past.model_copy(update={"id": "c-2"})
        assert store.log.append(late, "d", Status.KEPT).result().status is Status.KEPT
        assert store.log.pending() == []
        assert store.log.answer(receipt("c-2")).result() is None


def test_what_is_pending_outlives_the_process_in_order(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        for name in ("c-2", "c-1", "c-3"):
            store.log.append(correction(name), "d").result()
        store.log.answer(receipt("c-1")).result()
    with opened_store(tmp_path / "a.sqlite") as store:
        assert [entry.correction.id for entry in store.log.pending()] == ["c-2", "c-3"]
        assert len(store.parcels) == 4


def test_pages_run_from_the_newest_to_the_oldest(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        for number in range(5):
            robot = f"robot-{number % 2}"
            store.log.append(correction(f"c-{number}", robot=robot), "d").result()
        page = store.log.page(None, None, 2, None)
        assert [entry.correction.id for entry in page] == ["c-4", "c-3"]
        rest = store.log.page(None, None, 9, page[-1].sequence)
        assert [entry.correction.id for entry in rest] == ["c-2", "c-1", "c-0"]
        mine = store.log.page("robot-1", "robot-1-e1", 9, None)
        assert [entry.correction.id for entry in mine] == ["c-3", "c-1"]


def test_a_parcel_that_the_learner_refuses_is_kept_aside(tmp_path: Path) -> None:
    with opened_store(tmp_path / "a.sqlite") as store:
        for name in ("c-1", "c-2"):
            store.log.append(correction(name), "d").result()
        store.parcels.refuse("correction/c-1", "unknown robot")
        assert [parcel.id for parcel in store.parcels.pending()] == ["correction/c-2"]
        store.parcels.done("correction/c-2")
        assert len(store.parcels) == 0
