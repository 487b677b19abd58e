"""Selection ranks the fastest mode first, because it knows the time of each mode."""

import pytest

from pushpressslide.core import margins
from pushpressslide_studies.bench import bench, selection
from pushpressslide_studies.bench.selection import CASES
from pushpressslide_studies.cli.bench_table import print_benchmarks

FEW = (
    "cube ahead",
    "tile turned on the spot",
    "flat box turned on the spot",
    "flat box, smooth tips",
)


@pytest.fixture(scope="module")
def rows():
    """Return the study of a few of its tasks."""
    return selection.study([case for case in CASES if case.name in FEW])


def test_the_mode_ranked_first_reaches_the_goal_soonest(rows):
    assert [row["task"] for row in rows] == list(FEW)
    assert all(row["right"] for row in rows), [row["times"] for row in rows]
    assert len({row["winner"] for row in rows}) == 4, (
        "one mode would be right without any choice"
    )


def test_times_are_estimated_to_half_a_second(rows):
    runs = [
        figures
        for row in rows
        for figures in row["modes"].values()
        if figures["reached"]
    ]
    assert len(runs) > len(rows)
    for figures in runs:  # the planar engine begins before the touch
        assert figures["estimated"] - margins.ARM.approach == pytest.approx(
            figures["true"], abs=0.5
        )


def test_twenty_different_tasks_for_one_and_two_arms():
    assert (
        len({case.name for case in CASES})
        == len({(case.start, case.goal) for case in CASES})
        == 20
    )
    assert {len(case.robots) for case in CASES} == {1, 2}


def test_the_table_leaves_out_what_is_itself_a_table(
    monkeypatch, tmp_path, rows, capsys
):
    monkeypatch.setattr(selection, "study", lambda: rows)
    monkeypatch.setenv("COLUMNS", "250")
    print_benchmarks(bench.bench(["select"], out=tmp_path)["benchmarks"])
    shown = capsys.readouterr().out
    assert "ranked first" in shown
    assert "{" not in shown
