"""What every `Store` promises, held against each implementation; and what SQL adds to it."""

import json
import threading
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.operations import Operations
from alembic.runtime.migration import MigrationContext
from sqlalchemy import JSON, text

from services.learner.store.memory import MemoryStore
from services.learner.store.migrate import migrate
from services.learner.store.sql import SqlStore, open_engine, sqlite_url
from services.learner.store.store import (
    Answer,
    Arrival,
    Kept,
    Manifest,
    Marks,
    PolicyRecord,
    Round,
    RoundState,
    Store,
    Tally,
    Trial,
)
from services.learner.store.tables import METADATA
from services.learner.store.writer import StoreClosedError
from shared.errors import RefusedError
from shared.messages.policy import TensorRef
from tests.unit.learner.records import (
    HAM,
    LOW,
    TOAST,
    correction,
    decision,
    episode,
    receipt,
    ruling,
)

REF = TensorRef(name="w", sha256="c" * 64, dtype="float32", shape=(2,), size_bytes=8)
MESSAGES: list[Kept] = [decision(), correction("c", HAM), receipt("c", 3), episode(), ruling()]


@pytest.fixture(params=["sqlite", "memory"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    made: Store = (
        SqlStore(sqlite_url(tmp_path / "learner.db"))
        if request.param == "sqlite"
        else MemoryStore()
    )
    yield made
    made.close()


def policy(number: int = 0, epoch: int = 1) -> PolicyRecord:
    return PolicyRecord(
        number=number,
        epoch=epoch,
        tensors=(REF,),
        bank=(HAM, TOAST),
        settings={"width": 8, "name": "x"},
        low_level_sha256=LOW,
        marks=Marks(episodes=1),
        created_ns=5,
    )


def founded(store: Store) -> Store:
    store.found(policy(epoch=store.take_over("learner", 1)))
    return store


def a_round(number: int = 1, epoch: int = 1) -> Round:
    manifest = Manifest(marks=Marks(decisions=3), excluded=("e-9",), settings={"a": {"b": 1}})
    return Round(number=number, epoch=epoch, parent=0, seed=7, manifest=manifest, begun_ns=11)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_the_same_message_again_changes_nothing(store: Store, message: Kept) -> None:
    assert store.add(message, 1)
    before = store.survey(Manifest())
    assert not store.add(message, 2)
    assert store.survey(Manifest()) == before


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (decision(executed=HAM), decision(executed=TOAST)),
        (correction("c", HAM), correction("c", TOAST)),
        (receipt("c", 3), receipt("c", 4)),
        (episode(), episode(steps=9)),
        (ruling(), ruling(version=1)),
    ],
)
def test_another_message_with_the_same_id_is_refused(
    store: Store, first: Kept, second: Kept
) -> None:
    store.add(first, 1)
    with pytest.raises(RefusedError, match="has the id"):
        store.add(second, 2)
    assert not store.add(first, 3)


def test_history_gives_back_what_arrived_of_finished_episodes(store: Store) -> None:
    others: list[Kept] = [decision("e-2"), correction("d", HAM, episode="e-2")]
    for message in MESSAGES + others:
        store.add(message, 1)
    history = store.history(Manifest(marks=store.survey(Manifest()).marks))
    assert history.rulings == (ruling(),)
    assert history.decisions[0].time_ns == decision().time_ns
    assert [head.id for head in history.decisions] == ["e-1-0"]
    assert history.decisions[0].executed == decision().executed.text
    assert history.corrections == (correction("c", HAM),)
    assert history.receipts == (receipt("c", 3),)
    assert history.episodes == (episode(),)


def test_history_leaves_out_what_its_manifest_excludes_and_what_came_later(store: Store) -> None:
    messages: list[Kept] = [decision(step=0), episode(), decision("e-2"), episode("e-2")]
    for message in messages:
        store.add(message, 1)
    marks = store.survey(Manifest()).marks
    store.add(decision(step=20), 1)
    history = store.history(Manifest(marks=marks, excluded=("e-2",)))
    assert [head.id for head in history.decisions] == ["e-1-0"]
    assert [found.id for found in history.episodes] == ["e-1"]


def test_whole_decisions_come_back_with_their_pictures_in_the_order_asked(store: Store) -> None:
    for step in (0, 20, 40):
        store.add(decision(step=step), 1)
    found = [*store.decisions(["e-1-40", "e-1-0"])]
    assert [int(one.arrays["images"][0, 0, 0, 0]) for one in found] == [40, 0]
    assert found[0].model_dump() == decision(step=40).model_dump()
    with pytest.raises(RefusedError, match="e-1-60"):
        [*store.decisions(["e-1-60"])]


def test_a_survey_says_what_each_new_episode_still_lacks(store: Store) -> None:
    store.add(episode(decisions=2, corrections=1), 77)
    assert store.survey(Manifest()).arrivals == (Arrival("e-1", False, 77, 2, 1, 0),)
    messages: list[Kept] = [decision(step=0), decision(step=20), MESSAGES[1], MESSAGES[2]]
    for message in messages:
        store.add(message, 1)
    store.add(correction("a", kind="approve"), 1)
    store.add(receipt("a", 4), 1)
    store.add(correction("late", HAM), 1)
    store.add(receipt("late", None), 1)
    survey = store.survey(Manifest())
    assert survey.arrivals == (Arrival("e-1", False, 77, 0, 0, 1),)
    assert store.survey(Manifest(marks=survey.marks)).arrivals == ()
    excluding = Manifest(marks=survey.marks, excluded=("e-1",))
    assert store.survey(excluding).arrivals == survey.arrivals


def test_a_survey_counts_the_commands_that_were_newly_said_of_the_past(store: Store) -> None:
    store.add(correction("c", HAM), 1)
    store.add(correction("w", HAM, kind="relabel", first_step=0, end_step=40), 1)
    before = store.survey(Manifest())
    assert before.hindsight == 1
    store.add(correction("e", HAM, kind="edit", target="c"), 1)
    store.add(correction("y", kind="endorse", first_step=0, end_step=40), 1)
    assert store.survey(Manifest(marks=before.marks)).hindsight == 1


def test_a_survey_counts_what_was_taken_back_if_the_last_round_had_it(store: Store) -> None:
    store.add(correction("c", HAM), 1)
    store.add(correction("w", HAM, kind="relabel", first_step=0, end_step=40), 1)
    store.add(correction("d", HAM, episode="e-2"), 1)
    store.add(episode(), 1)
    store.add(episode("e-2"), 1)
    manifest = Manifest(marks=store.survey(Manifest()).marks, excluded=("e-2",))
    store.add(correction("n", TOAST), 1)
    for number, target in enumerate(("c", "c", "w", "d", "n", "never")):
        episode_ = "e-2" if target == "d" else "e-1"
        taken = correction(f"r-{number}", kind="retract", target=target, episode=episode_)
        store.add(taken, 1)
    assert store.survey(manifest).hindsight == 2  # c and w; the others no round had.
    assert store.survey(Manifest()).hindsight == 1  # w, newly said; nothing was had.
    later = Manifest(marks=store.survey(manifest).marks)
    assert store.survey(later).hindsight == 0


def test_a_tally_counts_what_came_after_its_marks(store: Store) -> None:
    assert store.tally(Marks()) == Tally()
    for message in MESSAGES:
        store.add(message, 1)
    store.add(episode("e-2", outcome="timeout"), 1)
    store.add(episode("e-3", outcome="aborted"), 1)
    assert store.tally(Marks()) == Tally(episodes=2, successes=1, corrections=1, decisions=1)
    assert store.tally(store.survey(Manifest()).marks) == Tally()


def test_each_learner_that_takes_over_has_a_higher_epoch(store: Store) -> None:
    assert store.epoch() == 0
    assert [store.take_over(name, 1) for name in ("a", "b", "a")] == [1, 2, 3]
    assert store.epoch() == 3


def test_who_lost_the_store_can_begin_no_round_and_make_no_version(store: Store) -> None:
    founded(store).begin(a_round())
    store.take_over("newcomer", 2)
    with pytest.raises(RefusedError, match="epoch 2"):
        store.begin(a_round(2))
    with pytest.raises(RefusedError, match="epoch 2"):
        store.end(a_round().model_copy(update={"state": RoundState.PASSED}), policy(1))
    assert store.rounds()[0].state is RoundState.RUNNING


def test_a_round_and_the_version_it_made_are_kept_together(store: Store) -> None:
    founded(store).begin(a_round())
    assert store.rounds() == (a_round(),)
    ended = a_round().model_copy(
        update={"state": RoundState.PASSED, "made": 1, "ended_ns": 12, "figures": {"loss": 0.5}}
    )
    store.end(ended, policy(1))
    assert store.rounds() == (ended,)
    assert (store.version(), store.version(0), store.version(5)) == (policy(1), policy(0), None)


def test_a_round_begins_once_and_ends_once(store: Store) -> None:
    founded(store).begin(a_round())
    with pytest.raises(RefusedError, match="begun before"):
        store.begin(a_round())
    store.end(a_round().model_copy(update={"state": RoundState.FAILED, "reason": "x"}))
    with pytest.raises(RefusedError, match="not running"):
        store.end(a_round().model_copy(update={"state": RoundState.PASSED}), policy(1))
    assert store.version() == policy(0)


def test_a_version_on_trial_is_not_in_force_until_its_round_has_ended(store: Store) -> None:
    founded(store).begin(a_round())
    tried = policy(1).model_copy(update={"robots": ("robot-1",)})
    running = a_round().model_copy(update={"candidate": {"bank": [HAM]}, "made": 1})
    store.advance(running, tried)
    assert store.rounds() == (running,)
    assert (store.version(), store.versions()) == (policy(0), (policy(0), tried))
    with pytest.raises(RefusedError, match="a version 1 already"):
        store.advance(running, policy(1))
    store.end(running.model_copy(update={"state": RoundState.PASSED}), policy(1))
    assert (store.version(), store.versions()) == (policy(1), (policy(0), policy(1)))
    with pytest.raises(RefusedError, match="not running"):
        store.advance(running)


def test_a_ruling_is_answered_once_together_with_the_version_it_made(store: Store) -> None:
    founded(store).add(ruling("say-1"), 1)
    store.add(ruling("say-2", verb="alias", phrase=HAM, means=TOAST), 2)
    assert [answer.answered_ns for answer in store.answers()] == [None, None]
    again = policy(1).model_copy(update={"again": 0, "ruling": "say-1"})
    answer = Answer(ruling=ruling("say-1"), answered_ns=9, made=1)
    store.answer(answer, again)
    assert (store.answers()[0], store.version()) == (answer, again)
    with pytest.raises(RefusedError, match="answered before"):
        store.answer(answer, policy(2))
    with pytest.raises(RefusedError, match="unknown"):
        store.answer(Answer(ruling=ruling("say-3"), answered_ns=9))
    assert store.version() == again


def test_a_trial_is_kept_once_and_found_by_policy_and_plan(store: Store) -> None:
    trials = [
        Trial(policy=LOW, plan="p", seed=seed, success=seed > 3, row={"steps": seed})
        for seed in (3, 4)
    ]
    assert [store.add_trial(trial) for trial in (*trials, trials[0])] == [True, True, False]
    assert store.trials(LOW, "p") == {trial.seed: trial for trial in trials}
    assert (store.trials(LOW, "q"), store.trials("b" * 64, "p")) == ({}, {})


def test_a_store_is_founded_once(store: Store) -> None:
    assert store.version() is None
    with pytest.raises(RefusedError, match="a version already"):
        founded(store).found(policy())


def test_many_threads_write_at_once_and_nothing_is_lost_or_double(store: Store) -> None:
    def write(robot: int) -> None:
        for step in range(40):
            news.append(store.add(decision(f"e-{robot % 4}", step), 1))

    news: list[bool] = []
    threads = [threading.Thread(target=write, args=(robot,)) for robot in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(news), sum(news)) == (320, 160)
    assert store.tally(Marks()).decisions == 160


def test_migrations_and_tables_say_the_same(tmp_path: Path) -> None:
    engine = open_engine(sqlite_url(tmp_path / "learner.db"))
    with engine.begin() as connection:
        migrate(connection)
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, METADATA) == []
        assert context.get_current_heads() == ("0002",)
    engine.dispose()


def test_a_store_of_the_first_form_is_brought_to_the_one_of_today(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "learner.db")
    engine = open_engine(url)
    with engine.begin() as connection:
        context = MigrationContext.configure(connection)
        with Operations.context(context):
            import_module("services.learner.store.revisions.r0001_first").upgrade()
        connection.exec_driver_sql("CREATE TABLE alembic_version (version_num VARCHAR(32))")
        connection.exec_driver_sql("INSERT INTO alembic_version VALUES ('0001')")
        connection.exec_driver_sql("INSERT INTO epochs VALUES (1, 'learner', 1)")
        row = policy().model_dump(mode="json")
        old = [name for name in row if name not in ("robots", "again", "ruling")]
        table = METADATA.tables["versions"]
        columns = ", ".join(old)
        places = ", ".join(f":{name}" for name in old)
        values = {
            name: json.dumps(row[name]) if isinstance(table.c[name].type, JSON) else row[name]
            for name in old
        }
        connection.execute(text(f"INSERT INTO versions ({columns}) VALUES ({places})"), values)
    engine.dispose()
    store = SqlStore(url)
    assert (store.version(), store.epoch(), store.answers()) == (policy(), 1, ())
    store.close()


def test_a_store_opens_again_with_all_that_it_had(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "learner.db")
    first = SqlStore(url)
    founded(first).begin(a_round())
    first.add(decision(), 1)
    first.close()
    again = SqlStore(url)
    assert (again.version(), again.rounds(), again.epoch()) == (policy(), (a_round(),), 1)
    assert not again.add(decision(), 2)
    again.close()


def test_sqlite_flushes_at_each_commit_and_minds_foreign_keys(tmp_path: Path) -> None:
    engine = open_engine(sqlite_url(tmp_path / "learner.db"))
    with engine.begin() as connection:
        pragmas = ("journal_mode", "synchronous", "foreign_keys")
        assert [connection.scalar(text(f"PRAGMA {name}")) for name in pragmas] == ["wal", 2, 1]
    engine.dispose()


def test_one_bad_record_does_not_hold_up_those_committed_with_it(tmp_path: Path) -> None:
    store = SqlStore(sqlite_url(tmp_path / "learner.db"))
    with pytest.raises(RefusedError):
        store.end(a_round())  # Never begun.
    assert store.add(decision(), 1)
    store.close()


def test_a_locked_file_makes_writers_wait_and_not_fail(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "learner.db")
    store, other = SqlStore(url), open_engine(url)
    added = threading.Event()
    with other.connect() as connection:
        connection.exec_driver_sql("SELECT 1")
        connection.rollback()
        locked = connection.execution_options(writes=True)
        locked.exec_driver_sql("SELECT 1")

        def add() -> None:
            store.add(decision(), 1)
            added.set()

        writer = threading.Thread(target=add)
        writer.start()
        assert not added.wait(0.3)
        locked.rollback()
    assert added.wait(10)
    writer.join()
    store.close()
    other.dispose()


def test_a_closed_store_fails_in_a_way_that_is_asked_again(tmp_path: Path) -> None:
    store = SqlStore(sqlite_url(tmp_path / "learner.db"))
    store.close()
    with pytest.raises(StoreClosedError):
        store.add(decision(), 1)
