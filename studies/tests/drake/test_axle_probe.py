"""The virtual axle in Drake, open loop, against the exact model with the contact's
height.
"""

import math
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

import pytest

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.shapes import Box
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper.virtual_axle import (
    TASK,
    TOLERANCE,
    Case,
    run_case,
    virtual_axle,
)
from pushpressslide_studies.sim.axle_probe import Probe, probe_axle


@cache
def row_of(case: Case) -> dict:
    return run_case(load_task(TASK), case)


@pytest.mark.parametrize(
    "case", [Case(15, 8.0, 0.1), Case(75, 8.0, 0.1), Case(165, 8.0, 0.1)], ids=str
)
def test_the_box_turns_about_the_predicted_axle(case: Case) -> None:
    row = row_of(case)
    assert row["measured"] == pytest.approx(row["predicted"], abs=3e-3)
    assert row["measured_force_angle"] == pytest.approx(
        math.radians(case.angle), abs=2e-3
    )
    assert row["measured_load"] == pytest.approx(case.load, rel=1e-3)
    assert row["measured_slip"] < 5e-4
    low, high = row["measured_axle_band"]
    assert high - low < 2e-3


def test_pulled_and_pushed_it_turns_about_points_over_twenty_centimetres_apart() -> (
    None
):
    pulled = row_of(Case(15, 8.0, 0.1))
    pushed = row_of(Case(165, 8.0, 0.1))
    assert pulled["measured"] - pushed["measured"] > 0.2
    assert pulled["without_height"] == pytest.approx(pushed["without_height"], abs=1e-6)


@pytest.mark.parametrize("angle", [60.0, 150.0])
def test_a_light_body_turns_about_the_predicted_axle(angle: float) -> None:
    """30 g under a press of 4 N: the drag has a lever of 2 mm, so that little friction
    at the tip turns the body otherwise.
    """
    base = load_task(TASK)
    light = ObjectModel(Box((0.1, 0.1, 0.05)), 0.03, (0.0, 0.0))
    task = replace(base, object=light)
    place = (0.03, 0.0)
    found = probe_axle(task, Probe(place, 4.0, math.radians(angle)))
    press = Press(light, task.support.friction, place, found.load)
    twist = press.twist(found.force_angle)
    assert found.axle == pytest.approx(-twist.vy / twist.w, rel=0.015)
    low, high = found.axle_band
    assert high - low < 2e-3


def test_a_hand_that_keeps_its_yaw_moves_the_axle_by_its_spin_friction() -> None:
    follows = row_of(Case(75, 8.0, 0.1))
    held = row_of(Case(75, 8.0, 0.1, "hand's yaw held"))
    assert held["measured"] - follows["measured"] < -8e-3


def test_a_push_that_does_not_move_the_object_measures_nothing() -> None:
    with pytest.raises(SimulationError, match="too slow to tell about what"):
        probe_axle(load_task(TASK), Probe((0.2, 0.0), 8.0, 1.0, speed=1e-4, cells=3.0))


def test_a_probe_gives_the_same_figures_again() -> None:
    probe = Probe((0.2, 0.0), 8.0, 1.0, cells=3.0)
    assert asdict(probe_axle(load_task(TASK), probe)) == asdict(
        probe_axle(load_task(TASK), probe)
    )


@pytest.mark.long
def test_every_probe_of_the_table_is_within_ten_millimetres(tmp_path: Path) -> None:
    result = virtual_axle(tmp_path)
    rows = result["rows"]
    assert len({row["angle"] for row in rows}) >= 8
    assert len({row["load"] for row in rows}) >= 3
    assert len({row["height"] for row in rows}) >= 2
    assert {"forward", "backward"} <= {row["direction"] for row in rows}
    for row in rows:
        assert not row["skipped"]
        assert abs(row["measured"] - row["predicted"]) <= TOLERANCE, row
    paper = [abs(row["measured"] - row["paper"]) for row in rows]
    assert min(paper) > 10.0 * TOLERANCE
    for name in ("report.html", "table.md", "axles.png", "result.json"):
        assert (tmp_path / name).is_file()
