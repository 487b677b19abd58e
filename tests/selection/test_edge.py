"""Edge of a table: conditions that keep an object on it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

from pushpressslide.control.correction import Replanner
from pushpressslide.core import margins
from pushpressslide.core.errors import TaskError
from pushpressslide.core.footprint import edge_depths
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.geometry.shapes import Box, Cylinder, Prism
from pushpressslide.modes.base import Measured
from pushpressslide.planning.swept import swept
from pushpressslide.selection.edge import edge_refusal
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan
from pushpressslide.taskfile.load import dump_task, task_from_data

TABLE = [[0.2, -0.4], [0.2, 0.4], [0.8, 0.4], [0.8, -0.4]]
NEAR: dict[str, Any] = {
    "name": "near-the-edge",
    "support": {"friction": 0.3, "region": TABLE},
    "object": {"shape": {"box": [0.12, 0.12, 0.08]}, "mass": 0.8},
    "contact": {"friction": 0.7},
    "start": {"x": 0.45, "y": -0.2},
    "goal": {"x": 0.775, "y": -0.1, "yaw_deg": 90},
    "robots": [{"model": "panda"}],
}
# an L with the robot in its notch
CORNER = [[0.2, 0.2], [0.2, 0.55], [0.75, 0.55], [0.75, -0.5], [0.4, -0.5], [0.4, 0.2]]


def task(**changes: object) -> Task:
    return task_from_data({**NEAR, **changes}, "near-the-edge.yaml")


def refusal(**changes: object) -> str:
    with pytest.raises(TaskError) as error:
        task(**changes)
    line = str(error.value)
    assert "\n" not in line
    return line


def least_depth(made: Plan) -> float:
    """Smallest distance [m] of the centre of mass from tipping over the edge."""
    part = made.task
    assert part.support.region is not None
    top = shapely.Polygon(part.support.region)
    poses = swept(part.object, made.segments, part.motion.clearance)
    places = np.array([X.apply(part.object.center_of_mass) for X in poses])
    return float(edge_depths(part.object.shape, poses, places, top).min())


@pytest.mark.parametrize("yaw", [0.0, 0.4, math.pi])
def test_a_box_over_a_straight_edge_is_held_up_to_the_edge(yaw: float) -> None:
    table = shapely.box(-1.0, -1.0, 0.0, 1.0)
    poses = [Pose2(x, 0.0, yaw) for x in (-0.3, -0.05, -0.01, 0.01)]
    places = np.array([X.position for X in poses])
    depths = edge_depths(Box((0.2, 0.2, 0.1)), poses, places, table)
    assert depths == pytest.approx([math.inf, 0.05, 0.01, -0.01], abs=1e-9)


def test_what_the_table_carries_of_a_concave_base_counts_with_its_hull() -> None:
    """A U across a slit of the table stands on its two legs, its centre over the slit."""
    legs = ((-0.1, -0.1), (-0.06, -0.1), (-0.06, 0.06), (0.06, 0.06), (0.06, -0.1))
    shape = Prism((*legs, (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)), 0.05)
    slit = shapely.box(-0.04, -1.0, 0.04, 1.0)
    table = shapely.box(-1.0, -1.0, 1.0, 1.0).difference(slit)
    here = edge_depths(shape, [Pose2()], np.zeros((1, 2)), table)
    beyond = edge_depths(shape, [Pose2()], np.array([[0.0, -0.2]]), table)
    assert here[0] == math.inf
    assert beyond[0] == pytest.approx(-0.1)


def test_off_the_table_the_depth_is_the_distance_to_it() -> None:
    table = shapely.box(-1.0, -1.0, 0.0, 1.0)
    far = edge_depths(
        Cylinder(0.05, 0.1), [Pose2(0.3, 0.0)], np.array([[0.3, 0.0]]), table
    )
    assert far[0] == pytest.approx(-0.3)


def test_the_way_to_a_goal_at_the_edge_keeps_the_margin() -> None:
    part = task()
    assert least_depth(plan(part)) >= margins.EDGE_MARGIN * 0.06 - 1e-6


def test_a_way_that_leads_over_the_edge_is_refused_with_the_figure() -> None:
    beside = {"friction": 0.3, "region": [[0.2, -0.27], [0.8, -0.27], [0.8, 0.4]]}
    part = task(support=beside, goal={"x": 0.68, "y": -0.2, "yaw_deg": 170})
    codes = {c.refusal.code for c in select(part) if c.refusal is not None}
    assert "edge" in codes
    for choice in select(part):
        if choice.feasible:
            assert (
                edge_refusal(part.scene, part.motion.clearance, choice.segments) is None
            )
        if choice.refusal is not None and choice.refusal.code == "edge":
            assert choice.refusal.figure is not None
            assert choice.refusal.allowed is not None
            assert choice.refusal.figure < choice.refusal.allowed
            assert "support.region" in str(choice.refusal)


def test_without_a_region_no_way_is_refused_for_an_edge() -> None:
    part = task(support={"friction": 0.3})
    assert edge_refusal(part.scene, part.motion.clearance, plan(part).segments) is None


def test_what_stands_over_the_edge_is_brought_away_from_it() -> None:
    """The centre of mass is 5 mm inside the edge, less than its margin, at the start."""
    part = task(start={"x": 0.795, "y": 0.1}, goal={"x": 0.5, "y": 0.1})
    made = plan(part)
    assert least_depth(made) == pytest.approx(0.005, abs=1e-3)


def test_a_way_round_the_inner_corner_of_a_table_is_found() -> None:
    part = task(
        support={"friction": 0.3, "region": CORNER},
        start={"x": 0.28, "y": 0.4},
        goal={"x": 0.55, "y": -0.35, "yaw_deg": 90},
    )
    made = plan(part)
    assert least_depth(made) >= margins.EDGE_MARGIN * 0.06 - 1e-6


def test_a_drag_moves_the_load_ahead_by_friction_times_height() -> None:
    """A tall box is refused nearer to an edge that it is pushed to than a low one."""
    made = plan(task(goal={"x": 0.70, "y": -0.2}))
    part = made.task
    assert part.support.region is not None
    (x, y) = made.segments[-1].goal.position
    ahead = [
        replace(s, contacts=tuple(_at(c, 0.4) for c in s.contacts))
        for s in made.segments
    ]
    cut = ((0.2, -0.4), (x + 0.03, -0.4), (x + 0.03, 0.4), (0.2, 0.4))
    short = replace(part, support=replace(part.support, region=cut))
    assert (
        edge_refusal(short.scene, short.motion.clearance, made.segments) is None
        or y != -0.2
    )
    refused = edge_refusal(short.scene, short.motion.clearance, ahead)
    assert refused is not None
    assert refused.code == "edge"


def _at(contact: Any, height: float) -> Any:
    return replace(contact, height=height)


def test_a_plan_made_on_the_way_stays_on_the_table() -> None:
    made = plan(task(goal={"x": 0.70, "y": -0.2}, support={"friction": 0.3}))
    part = made.task
    segment = made.segments[0]
    touched = tuple(contact.point for contact in segment.contacts)
    X_WB = segment.body_pose(0.0)
    cut = ((0.2, -0.4), (0.6, -0.4), (0.6, 0.4), (0.2, 0.4))
    assert Replanner(part.queries()).replan(
        made.segments, Measured.touching(X_WB, made.segments[0].contacts, touched, 1.0)
    )
    short = replace(part, support=replace(part.support, region=cut))
    assert not Replanner(short.queries()).replan(
        made.segments, Measured.touching(X_WB, made.segments[0].contacts, touched, 1.0)
    )


def test_the_task_comes_back_from_its_file() -> None:
    import yaml

    part = task()
    written = yaml.safe_load(dump_task(part))
    assert task_from_data(written, "near-the-edge.yaml") == part


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"start": {"x": 0.81, "y": 0}}, ("start:", "10.0 mm beyond")),
        ({"start": {"x": 1.0, "y": 0}}, ("start:", "200.0 mm beyond")),
        (
            {"start_error": {"x": 0.36}},
            ("start_error:", "10.0 mm beyond"),
        ),
        ({"goal": {"x": 0.79, "y": 0}}, ("goal:", "18.0 mm or more", "10.0 mm inside")),
        (
            {"support": {"region": [[0, 0], [1, 1], [1, 0], [0, 1]]}},
            ("support.region:", "crosses itself"),
        ),
        (
            {"support": {"kind": "incline", "angle_deg": 5, "region": TABLE}},
            ("support.region:", "only a table has one"),
        ),
        (
            {
                "obstacles": [
                    {
                        "name": "cube",
                        "box": [0.05, 0.05, 0.05],
                        "pose": {"x": 0.83, "y": 0.2},
                        "movable": True,
                    }
                ]
            },
            ("obstacles[0].pose:", "30.0 mm beyond"),
        ),
    ],
)
def test_what_would_fall_off_the_table_is_refused(
    changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    line = refusal(**changes)
    assert all(word in line for word in words), line
