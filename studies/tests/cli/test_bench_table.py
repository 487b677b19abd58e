"""The tables of ``pps bench`` fit the terminal."""

import pytest

from pushpressslide_studies.cli.bench_table import print_benchmarks

ROW = {
    "task": "bimanual-slide",
    "tick_us": 12.3,
    "p99_us": 33.1,
    "longest_us": 900.0,
    "run_over_played_back": 1.25,
    "wall_per_simulated": 0.38,
    "apart_mm": 0.02,
}


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_a_table_that_is_too_wide_cuts_no_word(
    columns: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    print_benchmarks({"runs": [ROW]})
    lines = capsys.readouterr().out.splitlines()
    words = [word for line in lines for word in line.split()]
    for expected in ("bimanual-slide", "percentile", "torques", "simulated", "1.25"):
        assert expected in words
    assert all(len(line) <= columns for line in lines)
