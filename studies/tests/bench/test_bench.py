"""The benchmarks compare like with like, report missing solvers, and print their
results.
"""

import json

import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.core.errors import TaskError
from pushpressslide_studies.bench import bench, compared, contestants, coverage, solvers


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(compared, "ROUNDS", 3)
    monkeypatch.setattr(bench, "CASES", 20)
    monkeypatch.setattr(bench, "SAMPLES", 2000)
    monkeypatch.setattr(contestants, "WRENCHES", 40)


def ratios(rows):
    return {row["what"]: row["ratio"] for row in rows}


def test_ratios_are_to_the_first_contestant_and_an_absent_one_says_why(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(compared, "perf_counter", lambda: clock[0])

    def takes(seconds: float) -> None:
        clock[0] += seconds

    rows = compared.compared(
        {
            "quick": [(takes, (2.0,))] * 3,
            "slow": [(takes, (14.0,))] * 3,
            "absent": "not here",
        }
    )
    assert [row["what"] for row in rows] == ["quick", "slow", "absent"]
    assert rows[0]["ratio"] == 1.0
    assert rows[0]["median_us"] == pytest.approx(2e6)
    assert rows[1]["ratio"] == pytest.approx(7.0)
    assert rows[2] == {
        "what": "absent",
        "median_us": None,
        "p99_us": None,
        "ratio": None,
        "note": "not here",
    }


def test_every_solver_is_timed_beside_the_closed_form(quick, tmp_path):
    pushes, presses = (
        ratios(bench.bench([name], out=tmp_path)["benchmarks"][name])
        for name in ("pushes", "presses")
    )
    assert {"DAQP", "DAQP, workspace kept", "Drake OSQP"} <= pushes.keys()
    assert {"Clarabel"} <= presses.keys()
    for found in (pushes, presses):
        assert found["closed form"] == 1.0
        assert all(ratio is not None for ratio in found.values())


def test_all_contestants_solve_the_same_problem(quick):
    for taking_part, least in (
        (contestants.push_contestants(0), 9),
        (contestants.press_contestants(0), 6),
    ):
        assert len(taking_part) >= least
        ours = taking_part["closed form"]
        for name, calls in taking_part.items():
            if name.startswith("closed form"):
                continue
            assert len(calls) == len(ours)
            for (function, arguments), (allocate, wanted) in zip(
                calls[::7], ours[::7], strict=True
            ):
                forces = function(*arguments)
                total = [f + g for f, g in zip(forces[:2], forces[2:], strict=True)]
                assert total == pytest.approx(wanted[:2], abs=1e-2), name
                assert allocate(*wanted).status == "ok"


def test_a_solver_that_is_not_installed_is_named(quick, monkeypatch, tmp_path):
    def absent(*args, **kwargs):
        raise ModuleNotFoundError("No module named 'daqp'", name="daqp")

    monkeypatch.setattr(solvers, "daqp_pushes", absent)
    rows = {
        row["what"]: row
        for row in bench.bench(["pushes"], out=tmp_path)["benchmarks"]["pushes"]
    }
    assert rows["DAQP"]["ratio"] is None
    assert "pip install" in rows["DAQP"]["note"]
    assert rows["Drake OSQP"]["ratio"] is not None


def test_the_result_is_kept_with_versions(quick, tmp_path):
    result = bench.bench(
        ["turning", "coverage"], out=tmp_path, progress=lambda done, total: None
    )
    kept = json.loads((tmp_path / "result.json").read_text())
    assert (
        kept["benchmarks"].keys()
        == result["benchmarks"].keys()
        == {"turning", "coverage"}
    )
    assert {"python", "pushpressslide", "numpy", "daqp", "clarabel"} <= kept[
        "versions"
    ].keys()
    assert (tmp_path / "orthogonal-pushes.png").stat().st_size > 10_000


def test_a_tick_is_counted_in_empty_calls(quick, monkeypatch, tmp_path):
    monkeypatch.setattr(bench, "CALLS", 300)
    rows = ratios(bench.bench(["tick"], out=tmp_path)["benchmarks"]["tick"])
    assert rows["empty function call"] == 1.0
    assert set(bench.TICKS) <= rows.keys()


def test_an_unknown_benchmark_is_refused_with_the_names_there_are(tmp_path):
    with pytest.raises(
        TaskError,
        match="pushes, presses, tick, agreement, coverage, turning, sticking, select",
    ):
        bench.bench(["speed"], out=tmp_path)
    result = CliRunner().invoke(app, ["bench", "speed", "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1


def test_the_command_prints_a_table_or_json(quick, tmp_path):
    shown = CliRunner().invoke(
        app, ["bench", "turning", "agreement", "--out", str(tmp_path / "a")]
    )
    assert shown.exit_code == 0
    assert "closest" in shown.stdout
    assert "flag_differs" in shown.stdout
    plain = CliRunner().invoke(
        app, ["bench", "turning", "--json", "--out", str(tmp_path / "b")]
    )
    assert json.loads(plain.stdout)["benchmarks"]["turning"][0]["outside"] == 0


@pytest.mark.parametrize(
    ("mu", "possible", "symmetric"),
    [(0.2, 0.060, 0.60), (0.5, 0.124, 0.65), (0.8, 0.156, 0.71)],
)
def test_the_even_split_covers_part_of_what_is_possible(mu, possible, symmetric):
    row = coverage.coverage(mu, 30_000, 3)
    assert row["possible"] == pytest.approx(possible, abs=0.008)
    assert row["symmetric"] == pytest.approx(symmetric, abs=0.03)
    assert row["bias"] > 0.1
    assert 0.5 < row["drift"] < 1.0


@pytest.mark.parametrize("mu", coverage.FRICTIONS)
def test_no_sampled_centre_of_turning_is_outside_of_its_region(mu):
    row = coverage.turning_centers(mu, 5000, 4)
    assert row["outside"] == 0
    assert row["radius"] <= row["closest"] < 1.1 * row["radius"]
