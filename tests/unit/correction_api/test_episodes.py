"""Episodes on disk: found by what they were like, and what people's attention went to."""

from pathlib import Path

from sqlalchemy import text

from services.correction_api.store.engine import open_engine, upgrade
from services.correction_api.store.episodes import Episodes, Filter
from services.correction_api.store.log import Status
from shared.messages.correction import MAX_SPEAKING_S, speaking_s
from shared.messages.episode import Episode, Outcome
from shared.messages.help import Help, Reason
from shared.messages.policy import Version
from tests.unit.correction_api.store import correction, opened_store

SECOND = 1_000_000_000


def episode(id_: str, **fields: object) -> Episode:
    made = {
        "id": id_,
        "robot": "robot-1",
        "number": 1,
        "task": "sandwich",
        "prompt": "a sandwich",
        "site": "far",
        "seed": 1,
        "version": Version(1, 0),
        "low_level_sha256": "ab" * 32,
        "outcome": Outcome.SUCCESS,
        "steps": 200,
        "decisions": 4,
        "corrections": 0,
        "started_ns": 1,
        "ended_ns": 2,
    }
    return Episode.model_validate(made | fields)


def found(episodes: Episodes, **wanted: object) -> list[str]:
    rows = episodes.page(Filter.model_validate(wanted), 10, None)
    return [one.episode.id for one in rows]


def test_every_filter_parts_those_that_are_like_it_from_the_others(tmp_path: Path) -> None:
    with opened_store(tmp_path / "log.sqlite") as store:
        episodes = store.episodes
        episodes.add(episode("plain"))
        episodes.add(episode("lost", outcome=Outcome.TIMEOUT, task="bus", robot="robot-2"))
        episodes.add(episode("told", corrections=2, version=Version(1, 1)))
        episodes.add(episode("robot-1-e1", outcome=Outcome.ABORTED))
        call = Help(decision="lost-1", step=20, time_ns=1, reason=Reason.STUCK, doubt=0.5)
        episodes.call("lost", call)
        episodes.call("lost", call)
        store.log.append(correction("say-1"), "d").result()
        everything = ["robot-1-e1", "told", "lost", "plain"]
        assert found(episodes) == everything
        for wanted, those in (
            ({"task": "bus"}, ["lost"]),
            ({"robot": "robot-2"}, ["lost"]),
            ({"version": "1.1"}, ["told"]),
            ({"success": True}, ["told", "plain"]),
            ({"corrected": True}, ["robot-1-e1", "told"]),
            ({"doubt": True}, ["lost"]),
        ):
            assert found(episodes, **wanted) == those
        for name in ("success", "corrected", "doubt"):
            rest = {*everything} - {*found(episodes, **{name: True})}
            assert {*found(episodes, **{name: False})} == rest
        assert found(episodes, success=False, doubt=False) == ["robot-1-e1"]
        assert episodes.calls("lost") == [call]
        assert episodes.tasks() == ["bus", "sandwich"]
        lost = episodes.get("lost")
        assert lost is not None
        assert (lost.calls, lost.taught) == (1, 0)


def test_what_was_refused_teaches_nothing(tmp_path: Path) -> None:
    with opened_store(tmp_path / "log.sqlite") as store:
        store.episodes.add(episode("robot-1-e1"))
        store.log.append(correction("say-1"), "d", Status.REFUSED).result()
        assert found(store.episodes, corrected=True) == []


def test_human_seconds_are_what_it_took_to_say_it_within_bounds(tmp_path: Path) -> None:
    assert speaking_s(1 * SECOND, 3 * SECOND) == 2.0
    assert speaking_s(3 * SECOND, 1 * SECOND) == 0.0
    assert speaking_s(0, 10_000 * SECOND) == MAX_SPEAKING_S
    with opened_store(tmp_path / "log.sqlite") as store:
        store.episodes.add(episode("robot-1-e1"))
        store.episodes.add(episode("robot-2-e1", outcome=Outcome.ABORTED))
        said = [("one", "robot-1", 4), ("two", "robot-1", 2), ("gone", "robot-2", 9)]
        for name, robot, seconds in said:
            spoken = correction(name, robot=robot, created_ns=1 + seconds * SECOND)
            store.log.append(spoken, "d").result()
        assert store.episodes.attention() == {"1.0": 6.0}


def test_a_log_of_before_gets_the_task_of_its_episodes(tmp_path: Path) -> None:
    engine = open_engine(tmp_path / "log.sqlite")
    upgrade(engine, "0001")
    told = {"id": "old", "message": episode("old", task="pack").model_dump_json()}
    with engine.begin() as connection:
        insert = (
            "INSERT INTO episodes (id, robot, version, outcome, corrections, message) "
            "VALUES (:id, 'robot-1', '1.0', 'success', 0, :message)"
        )
        connection.execute(text(insert), told)
    engine.dispose()
    with opened_store(tmp_path / "log.sqlite") as store:
        assert found(store.episodes, task="pack") == ["old"]
