"""Figures, representations and tables of a record."""

import importlib.util
import sys
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.record import Record


@pytest.fixture(scope="module")
def run() -> Record:
    return pps.run(pps.load_task("rear-push-rear"), engine="planar")


def test_a_run_is_measured(run: Record) -> None:
    assert run.success
    assert run.figures == pps.result(run)


def test_a_record_that_was_not_measured_says_so(run: Record) -> None:
    with pytest.raises(RuntimeError, match="not measured"):
        _ = replace(run, figures={}).success


def test_reprs_are_one_short_line(run: Record) -> None:
    for thing in (run, run.plan, run.plan.task, pps.select(run.plan.task)[0]):
        text = repr(thing)
        assert "\n" not in text
        assert len(text) < 200


def test_a_table_without_pandas_says_what_to_install(
    run: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(pps.PushPressSlideError, match="pip install pandas"):
        run.to_dataframe()


@pytest.mark.skipif(not importlib.util.find_spec("pandas"), reason="needs pandas")
def test_a_record_becomes_a_table(run: Record) -> None:
    table = run.to_dataframe()
    assert len(table) == len(run.arrays["time"])
    assert (table["object_x"].to_numpy() == run.arrays["object_pose"][:, 0]).all()
    force = run.arrays["measured_force"][:, 0, 1]
    assert (table["tip0_fy"].to_numpy() == force).all()
    assert list(dict.fromkeys(table["phase"])) == ["touch", "move", "release"]


def test_rooms_can_be_explored() -> None:
    assert "friction" in dir(pps.mechanics)
    assert dir(pps.modes) == ["MODES", *sorted(pps.modes.MODES)]
    assert "world" in dir(pps.planar)
    assert pps.mechanics.friction.push_outcome
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = pps.mechanics.nothing
