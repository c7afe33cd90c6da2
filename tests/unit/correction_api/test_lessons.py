"""What the learner told is kept beside the log, in a file of any age."""

from pathlib import Path

from alembic import command
from alembic.config import Config

from services.correction_api.store import engine
from services.correction_api.store.store import Store
from shared.messages.learned import LearnedAnswer
from shared.messages.policy import Version
from tests.unit.correction_api.store import correction, opened_store, receipt


def obeyed(store: Store, *names: str) -> None:
    for name in names:
        store.log.append(correction(name), "digest").result()
        store.log.answer(receipt(name)).result()


def test_what_is_learned_is_asked_about_no_more_and_outlives_a_restart(tmp_path: Path) -> None:
    file = tmp_path / "api.sqlite"
    with opened_store(file) as store:
        obeyed(store, "say-1", "say-2", "say-3")
        store.log.append(correction("say-4"), "digest").result()  # Without a receipt yet.
        assert list(store.lessons.open(0, 10).values()) == ["say-1", "say-2", "say-3"]
        answer = LearnedAnswer(learned={"say-1": Version(1, 2)}, held_out=("say-2",))
        changed = store.lessons.keep(answer).result()
        assert {entry.correction.id for entry in changed} == {"say-1", "say-2"}
        assert store.lessons.keep(answer).result() == []
    with opened_store(file) as store:
        assert list(store.lessons.open(0, 10).values()) == ["say-2", "say-3"]
        entries = {entry.correction.id: entry for entry in store.log.page(None, None, 10, None)}
        assert entries["say-1"].learned_in == Version(1, 2)
        assert (entries["say-2"].held_out, entries["say-3"].held_out) == (True, False)


def test_it_is_asked_page_by_page(tmp_path: Path) -> None:
    with opened_store(tmp_path / "api.sqlite") as store:
        obeyed(store, *(f"say-{number}" for number in range(5)))
        first = store.lessons.open(0, 2)
        second = store.lessons.open(max(first), 2)
        assert [*first.values(), *second.values()] == ["say-0", "say-1", "say-2", "say-3"]


def test_a_log_of_before_is_brought_to_the_form_of_today(tmp_path: Path) -> None:
    file = tmp_path / "api.sqlite"
    old = engine.open_engine(file, begin="BEGIN IMMEDIATE", size=1)
    config = Config()
    migrations = Path(engine.__file__).parent / "migrations"
    config.set_main_option("script_location", str(migrations))
    config.set_main_option("path_separator", "os")
    with old.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "0001")
    old.dispose()
    with opened_store(file) as store:
        obeyed(store, "say-1")
        assert [entry.learned_in for entry in store.log.page(None, None, 10, None)] == [None]
