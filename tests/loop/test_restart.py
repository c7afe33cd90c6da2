"""Each process is killed in turn while the loop runs: the others carry on, it takes up its work."""

import os
import signal

import pytest

from tests.loop.fleet import Fleet

pytestmark = pytest.mark.alone

QUICK = (
    "learner.round.corrections=15",
    "learner.round.after_s=0",
    "learner.train.steps=3",
    "learner.train.threads=1",  # Robots have the cores: two would wait for each other.
    "learner.gate.unjudged=let-out",  # Fifteen corrections are made in an episode or two.
    "learner.gate.max_fall=1",  # So few updates make no better version.
    "learner.gate.chance=1",
)

ROUND_S = 300.0
"""Robots don't wait for the round, and leave it little of two cores."""


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    with Fleet(folder, oracle=True, robots=2, sets=QUICK) as fleet:
        fleet.wait_for(lambda: total(fleet, "decisions") > 5, "the loop runs")
        yield fleet


def total(fleet, table):
    """Rows that the learner keeps; 0 while there is no store."""
    try:
        return fleet.read("learner", f"select count(*) from {table}")[0][0]
    except Exception:
        return 0


@pytest.mark.timeout(400)
@pytest.mark.parametrize("name", ["oracle", "actor-1", "api", "learner", "router"])
def test_a_killed_process_comes_back_and_the_loop_goes_on(fleet, name):
    child = fleet.child(name)
    pid = child.pid
    before = {table: total(fleet, table) for table in ("decisions", "corrections", "episodes")}
    os.kill(pid, signal.SIGKILL)
    fleet.wait_for(lambda: child.running and child.pid != pid, f"{name} was started again")
    for table, rows in before.items():
        fleet.wait_for(
            lambda table=table, rows=rows: total(fleet, table) > rows + (table == "decisions") * 20,
            f"new {table} after {name} was killed",
        )
    others = [one for one in fleet.family.children if one.name != name]
    assert all(one.running for one in others)


@pytest.mark.timeout(400)
def test_in_the_end_nothing_is_lost_and_nothing_is_double(fleet):
    fleet.wait_for(lambda: versions(fleet) >= 1, "a round made a version", ROUND_S)
    fleet.child("oracle").ask_to_end()
    fleet.child("oracle").wait()
    acknowledged = {
        row[0] for row in fleet.read("api", "select id from corrections")
    }  # fmt: skip
    kept = lambda: {row[0] for row in fleet.read("learner", "select id from corrections")}  # noqa: E731
    fleet.wait_for(lambda: acknowledged <= kept(), "every correction reached the learner")
    counted = "(select count(*) from decisions d where d.episode = e.id)"
    short = f"select e.id, e.decisions, {counted} from episodes e where e.decisions <> {counted}"
    fleet.wait_for(lambda: not fleet.read("learner", short), "every decision reached the learner")


def versions(fleet):
    """Versions after the base."""
    return fleet.read("learner", "select count(*) from versions where number > 0")[0][0]
