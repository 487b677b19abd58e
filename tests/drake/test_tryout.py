"""First trials of a demanding new user: other arms, shapes, wrong beliefs, noise,
obstacles, limits.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.paths.clearance import CLEARANCE
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.robots.facts import load_facts
from pushpressslide.robots.urdf import urdf_text
from pushpressslide.sim.engine import run as run_drake
from pushpressslide.taskfile.load import task_from_data
from pushpressslide.view.drake.live import LiveView

ROD = '<frame name="tool" link="panda_link8" xyz="0 0 0.15" rpy="0 0 0"/></robot>'


def task(**more: Any) -> Task:
    """Return a push of a 12 cm box to the left of a Panda: 25 cm ahead, with a turn of
    20 degrees.
    """
    data: dict[str, Any] = {
        "name": "tryout",
        "object": {"shape": {"box": [0.12, 0.12, 0.12]}, "mass": 1.0},
        "start": {"x": 0.5, "y": -0.15, "yaw_deg": 90},
        "goal": {"x": 0.456, "y": 0.1, "yaw_deg": 110},
        "robots": [{"model": "panda"}],
    }
    return task_from_data(data | more, "tryout")


def close(of: Task, engine: Any = "drake") -> tuple[dict[str, Any], Record]:
    """Run and check that the goal is reached within 3 mm and 1 degree and that the arm
    kept its limits.
    """
    plan, record, _ = simulate(of, engine=engine)
    measured = result(of, plan, record, {})
    assert measured["success"], measured["reason"]
    assert measured["final_position_error"] <= 3e-3
    assert measured["final_yaw_error"] <= math.radians(1.0)
    if engine == "drake":
        assert measured["torque_limit_violation_fraction"] < 1e-3
        assert measured["joint_limit_margin"] > 0.0
    return measured, record


def arm_file(folder: Path, kind: str) -> dict[str, Any]:
    """Write a Panda as a file, and a frame at a rod: with link shapes, or an axis
    fixed.
    """
    text = urdf_text(load_facts("panda"), collision=kind == "shapes").replace(
        "</robot>", ROD
    )
    if kind == "six":
        first = text.index('<joint name="panda_joint3"')
        middle = text.index("</joint>", first)
        end = text.index("</transmission>", first)
        fixed = (
            text[first:middle].replace('type="revolute"', 'type="fixed"') + "</joint>"
        )
        text = text[:first] + fixed + text[end + len("</transmission>") :]
    path = folder / f"{kind}.urdf"
    path.write_text(text)
    return {"model": str(path), "tip_frame": "tool"}


@pytest.mark.parametrize(
    ("robot", "more"),
    [
        ({"model": "hand", "base": {"z": 0.5}}, {}),
        pytest.param({"model": "iiwa7"}, {}, marks=pytest.mark.long),
        pytest.param(
            {"model": "iiwa7", "base": {"z": 0.15, "yaw_deg": -40}},
            {},
            marks=pytest.mark.long,
        ),
        pytest.param(
            {"model": "panda", "base": {"z": 0.2}}, {}, marks=pytest.mark.long
        ),
        pytest.param(
            {"model": "panda", "base": {"x": 0.9, "y": -0.7, "yaw_deg": 90}},
            {
                "start": {"x": 0.75, "y": -0.25},
                "goal": {"x": 1.0, "y": -0.206, "yaw_deg": 20},
            },
            marks=pytest.mark.long,
        ),
        pytest.param(
            {"model": "panda"},
            {
                "start": {"x": 0.42, "y": 0.0},
                "goal": {"x": 0.67, "y": 0.044, "yaw_deg": 20},
            },
            marks=pytest.mark.long,
        ),
    ],
)
def test_other_arms_at_other_places_do_the_same_push(robot: dict, more: dict) -> None:
    close(task(robots=[robot], **more))


@pytest.mark.parametrize(
    "kind", ["shapes", pytest.param("six", marks=pytest.mark.long)]
)
def test_an_arm_given_as_urdf_does_it_too(kind: str, tmp_path: Path) -> None:
    """Shapes of links do not touch anything in the simulation; six axes are enough."""
    close(task(robots=[arm_file(tmp_path, kind)]))


SHAPES: dict[str, dict[str, Any]] = {
    "cylinder": {"shape": {"cylinder": {"radius": 0.06, "height": 0.12}}},
    "tall": {"shape": {"box": [0.12, 0.12, 0.25]}},
    "triangle": {
        "shape": {
            "prism": {"polygon": [[0, 0], [0.16, 0.02], [0.03, 0.15]], "height": 0.1}
        },
        "center_of_mass": [0.075, 0.05],
    },
    "off-centre": {
        "shape": {"box": [0.12, 0.12, 0.12]},
        "center_of_mass": [0.02, 0.015],
    },
}


@pytest.mark.long
@pytest.mark.parametrize("name", SHAPES)
def test_other_shapes_are_pushed_as_well(name: str) -> None:
    close(task(object=SHAPES[name] | {"mass": 1.0}))


@pytest.mark.long
@pytest.mark.parametrize(
    "more",
    [
        {"belief": {"support_friction": 0.21}},
        {"belief": {"support_friction": 0.39}},
        {"belief": {"mass": 2.0}},
        {"robots": [{"model": "panda", "tip_radius": 0.01}]},
        {"robots": [{"model": "panda", "tip_radius": 0.03}]},
        {"motion": {"speed": 0.1}},
        {"motion": {"time_step": 0.002}},
    ],
)
def test_wrong_beliefs_other_tips_and_speeds_do_no_harm(more: dict) -> None:
    close(task(**more))


NOISE = {
    "position_noise": 5e-4,
    "yaw_noise_deg": 0.2,
    "force_noise": 0.2,
    "delay": 0.02,
}


def test_measurement_noise_and_delay_are_borne_on_the_planar_engine() -> None:
    plan, record, _ = simulate(task(sensing=NOISE), engine="planar")
    assert result(plan.task, plan, record, {})["success"]


def post(x: float, y: float, **more: Any) -> list[dict[str, Any]]:
    return [
        {"name": "post", "box": [0.04, 0.04, 0.3], "pose": {"x": x, "y": y}, **more}
    ]


@pytest.mark.long
@pytest.mark.parametrize("x", [0.38, 0.62])
def test_the_arm_stays_clear_of_a_post_beside_the_path(x: float) -> None:
    measured, _ = close(task(obstacles=post(x, 0.0)))
    assert measured["clearance_driven"] > 0.5 * CLEARANCE  # of what was planned with


def test_a_movable_obstacle_out_of_the_way_stays_where_it_is() -> None:
    measured, _ = close(task(obstacles=post(0.70, 0.2, movable=True, mass=0.5)))
    assert measured["bodies"]["post"]["displacement"] < 1e-3


@pytest.mark.parametrize("x", [0.5, 0.57])
def test_a_post_in_the_objects_way_is_refused_with_the_gap(x: float) -> None:
    choice = next(
        c for c in pps.select(task(obstacles=post(x, 0.0))) if "post" in c.reason
    )
    assert not choice.feasible
    assert "the object comes within 0 mm of obstacle 'post' at (" in choice.reason
    assert "allowed from 10 mm" in choice.reason


def test_an_obstacle_near_the_start_is_no_reason_to_refuse() -> None:
    """8 mm away before the motion, and farther on the way: what stands there already may
    stay. A way along it as near all the time is refused.
    """
    box = {"shape": {"box": [0.12, 0.12, 0.12]}, "mass": 1.0}
    goal = {"x": 0.5, "y": 0.1, "yaw_deg": 90}
    size = [0.02, 0.3, 0.1]
    apart = {
        "name": "wall",
        "box": size,
        "pose": {"x": 0.58, "y": -0.2, "yaw_deg": -10},
    }
    along = {"name": "wall", "box": size, "pose": {"x": 0.578, "y": -0.15}}
    assert pps.select(task(object=box, goal=goal, obstacles=[apart]))[0].feasible
    pushed = ["rear_push"]
    refused = pps.select(task(object=box, goal=goal, obstacles=[along], modes=pushed))
    assert refused[0].refusal is not None
    assert refused[0].refusal.code == "obstacle"


def test_time_that_is_too_short_ends_the_run_with_the_reason() -> None:
    from dataclasses import replace

    plan = pps.plan(task())
    short = replace(
        plan, task=replace(plan.task, limits=replace(plan.task.limits, time=2.0))
    )
    assert run_drake(short).reason == "time_limit"


def test_watching_live_changes_nothing_but_tells_where() -> None:
    from dataclasses import replace

    plan = pps.plan(task())
    plan = replace(
        plan, task=replace(plan.task, limits=replace(plan.task.limits, time=0.5))
    )
    told: list[str] = []
    seen = run_drake(plan, view=LiveView(plan, told.append))
    unseen = run_drake(plan)
    assert len(told) == 1
    assert told[0].startswith("http://localhost:")
    for name, values in unseen.arrays.items():
        if not name.startswith("tick_"):
            assert np.array_equal(values, seen.arrays[name], equal_nan=True), name


@pytest.mark.long
def test_a_seed_decides_every_bit_of_a_noisy_run() -> None:
    of = task(sensing=NOISE)
    first, second, other = (simulate(of, seed=seed)[1] for seed in (3, 3, 4))
    for name, values in first.arrays.items():
        if not name.startswith("tick_"):
            assert np.array_equal(values, second.arrays[name], equal_nan=True), name
    assert not np.array_equal(
        first.arrays["object_pose"][-1], other.arrays["object_pose"][-1]
    )
