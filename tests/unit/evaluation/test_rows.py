"""What was measured is kept, and not measured again."""

import pytest

from shared.config import Settings
from shared.evaluation.attempts import Row
from shared.evaluation.rows import Rows, measure
from tests.unit.evaluation.rows import row


class Nothing(Settings):
    """A plan."""


class Here:
    """A pool that does the jobs in this process and keeps which they were."""

    def __init__(self):
        self.jobs = []

    def work(self, make, plan, jobs):
        worker = make(plan)
        for job in jobs:
            self.jobs.append(job)
            yield worker(job)


def rolled(plan):
    del plan
    return lambda seed: row(seed)


def run(pool, file, seeds, note="a"):
    rows = Rows(file, Row, note) if file else None
    return list(measure(pool, rolled, Nothing(), seeds, lambda one: one.seed, rows))


def test_what_lies_there_is_not_done_again(tmp_path):
    file, pool = tmp_path / "rows.jsonl", Here()
    first = run(pool, file, [1, 2])
    again = run(pool, file, [1, 2, 3])
    assert pool.jobs == [1, 2, 3]
    assert again == [*first, row(3)]


def test_rows_that_werent_asked_for_are_kept_but_not_told(tmp_path):
    file, pool = tmp_path / "rows.jsonl", Here()
    run(pool, file, [1, 2, 3])
    assert run(pool, file, [2]) == [row(2)]
    assert [one.seed for one in run(pool, file, [1, 2, 3])] == [1, 2, 3]
    assert pool.jobs == [1, 2, 3]


def test_a_half_written_last_row_is_done_again_and_the_file_is_whole_after_it(tmp_path):
    file, pool = tmp_path / "rows.jsonl", Here()
    run(pool, file, [1, 2])
    file.write_text(file.read_text()[:-30])
    assert run(pool, file, [1, 2]) == [row(1), row(2)]
    assert pool.jobs == [1, 2, 2]
    run(pool, file, [1, 2])
    assert pool.jobs == [1, 2, 2]


def test_rows_of_another_plan_are_moved_aside(tmp_path):
    file, pool = tmp_path / "rows.jsonl", Here()
    run(pool, file, [1, 2])
    run(pool, file, [1], note="b")
    run(pool, file, [1], note="a")
    assert pool.jobs == [1, 2, 1, 1]
    kept = [file, tmp_path / "rows.old-1.jsonl", tmp_path / "rows.old-2.jsonl"]
    assert [len(one.read_text().splitlines()) for one in kept] == [1, 2, 1]


@pytest.mark.parametrize("broken_after", [0, 1, 4])
def test_whenever_it_breaks_off_the_rows_so_far_are_kept(tmp_path, broken_after):
    file, pool = tmp_path / "rows.jsonl", Here()
    rows = Rows(file, Row, "a")
    going = measure(pool, rolled, Nothing(), [1, 2, 3, 4, 5], lambda one: one.seed, rows)
    for _ in range(broken_after):
        next(going)
    going.close()
    assert [one.seed for one in run(pool, file, [1, 2, 3, 4, 5])] == [1, 2, 3, 4, 5]
    assert pool.jobs == [1, 2, 3, 4, 5]


def test_without_a_file_everything_is_done(tmp_path):
    pool = Here()
    assert run(pool, None, [1, 2]) == [row(1), row(2)]
    assert list(tmp_path.iterdir()) == []
