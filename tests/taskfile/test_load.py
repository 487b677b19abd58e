"""Task files load to their contents, and a dumped task loads again to the same."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pushpressslide.core.errors import TaskError
from pushpressslide.core.margins import LATEST_TORQUE
from pushpressslide.core.motion import Vehicle
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import (
    Belief,
    Box,
    Limits,
    Motion,
    Prism,
    Sensing,
    Support,
    Tolerance,
)
from pushpressslide.jobs.run import run
from pushpressslide.modes import MODES
from pushpressslide.robots.facts import load_facts
from pushpressslide.robots.urdf import urdf_text
from pushpressslide.taskfile import checks
from pushpressslide.taskfile.load import (
    check_task,
    dump_task,
    load_task,
    shipped_tasks,
    task_from_data,
)

MINIMAL: dict[str, Any] = {
    "name": "cube",
    "object": {"shape": {"box": [0.15, 0.15, 0.15]}, "mass": 2},
    "start": {"x": 0.4, "y": 0},
    "goal": {"x": 0.6, "y": 0},
    "robots": [{"model": "panda"}],
}


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


angles = st.one_of(st.integers(-180, 180), reals(-180, 180))
sizes = reals(0.01, 0.3)
frictions = reals(0.05, 1.95)
texts = st.text(
    st.characters(codec="utf-8", exclude_categories=("Cc", "Cs")), max_size=40
)


@st.composite
def shapes(draw: st.DrawFn) -> dict[str, Any]:
    kind = draw(st.sampled_from(["box", "prism", "cylinder"]))
    if kind == "box":
        return {"box": [draw(sizes) for _ in range(3)]}
    if kind == "cylinder":
        return {"cylinder": {"radius": draw(sizes), "height": draw(sizes)}}
    n = draw(st.integers(3, 9))
    radius = draw(reals(0.05, 0.3))
    sense = draw(st.sampled_from([-1, 1]))
    turn = draw(reals(0, 6))
    corners = [(sense * 2 * math.pi * i / n + turn) for i in range(n)]
    return {
        "prism": {
            "polygon": [[radius * math.cos(a), radius * math.sin(a)] for a in corners],
            "height": 0.2,
        }
    }


@st.composite
def task_dicts(draw: st.DrawFn) -> dict[str, Any]:
    maybe = st.none() | frictions
    interface = draw(st.sampled_from(["torque", "velocity", "position"]))
    latest = LATEST_TORQUE if interface == "torque" else 0.5
    return {
        "name": draw(st.from_regex(r"[A-Za-z][A-Za-z0-9_.-]{0,20}", fullmatch=True)),
        "description": draw(texts),
        "support": {"friction": draw(frictions)},
        "object": {"shape": draw(shapes()), "mass": draw(reals(0.01, 100))},
        "contact": {"friction": draw(frictions)},
        "start": {
            "x": draw(reals(0.5, 0.6)),
            "y": draw(reals(-0.2, 0.2)),
            "yaw_deg": draw(angles),
        },
        "goal": {
            "x": draw(reals(0.62, 0.65)),
            "y": draw(reals(-0.2, 0.2)),
            "yaw_deg": draw(angles),
        },
        "tolerance": {
            "position": draw(reals(1e-6, 0.01)),
            "yaw_deg": draw(reals(1e-6, 180)),
        },
        "robots": [
            {
                "model": draw(st.sampled_from(["hand", "hand", "panda"])),
                "base": {"yaw_deg": draw(angles)},
                "tip_radius": draw(sizes) / 3,
                "interface": interface,
                "rate": draw(reals(20, 2000)),
                "lag": draw(reals(0, 0.5)),
                "delay": draw(reals(0, latest)),
            }
        ],
        "obstacles": [
            {
                "name": "post",
                "box": [0.05, 0.05, 0.2],
                "movable": draw(st.booleans()),
                "pose": {"x": draw(reals(1.5, 2)), "y": 0, "yaw_deg": draw(angles)},
            }
        ],
        "modes": draw(st.sampled_from([None, ["rear_push"]])),
        "limits": {
            "time": draw(reals(1e-3, 3600)),
            "workspace": draw(
                st.sampled_from([None, {"x": [0.1, 0.7], "y": [-0.5, 0.5]}])
            ),
        },
        "belief": {
            "support_friction": draw(maybe),
            "mass": draw(maybe),
            "rho": draw(maybe),
        },
        "start_error": {"x": draw(reals(-0.02, 0.02)), "yaw_deg": draw(angles)},
        "sensing": {"yaw_noise_deg": draw(reals(0, 45)), "delay": draw(reals(0, 1))},
        "motion": {
            "speed": draw(reals(1e-4, 0.2)),
        },
    }


@given(task_dicts())
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_a_dumped_task_loads_again_to_an_equal_task(data: dict[str, Any]) -> None:
    task = task_from_data(data, "first")
    again = task_from_data(yaml.safe_load(dump_task(task)), "second")
    assert again == task
    assert dump_task(again) == dump_task(task)


@pytest.mark.parametrize("name", shipped_tasks())
def test_every_shipped_task_loads_describes_itself_and_survives_a_dump(
    name: str, tmp_path: Path
) -> None:
    task = load_task(name)
    assert task.name == name
    assert task.description
    file = tmp_path / "task.yaml"
    file.write_text(dump_task(task))
    assert load_task(file) == task


def test_what_a_file_leaves_out_has_the_defaults_of_the_task() -> None:
    task = task_from_data(MINIMAL, "test")
    assert task.motion == Motion()
    assert task.limits == Limits()
    assert task.sensing == Sensing()
    assert task.support == Support()
    assert task.tolerance == Tolerance()
    assert task.start_error == Pose2()
    assert task.belief == Belief()
    assert task.full_belief == Belief(0.3, 0.6, 2.0, (0.0, 0.0))
    assert task.modes is None
    robot = task.robots[0]
    assert robot == type(robot)("panda", (0.0, 0.0, 0.0))


def test_angles_are_degrees_in_the_file_and_radians_in_the_task() -> None:
    task = task_from_data(
        {**MINIMAL, "goal": {"x": 0.6, "y": 0, "yaw_deg": 90}}, "test"
    )
    assert task.goal == Pose2(0.6, 0.0, math.pi / 2)


def test_a_clockwise_polygon_is_turned_and_keeps_its_first_corner() -> None:
    polygon = [[0, 0], [0, 0.1], [0.2, 0]]
    shape = {"shape": {"prism": {"polygon": polygon, "height": 0.1}}, "mass": 1}
    task = task_from_data({**MINIMAL, "object": shape}, "test")
    assert isinstance(task.object.shape, Prism)
    assert task.object.shape.polygon == ((0.0, 0.0), (0.2, 0.0), (0.0, 0.1))
    assert task.object.center_of_mass == pytest.approx((0.2 / 3, 0.1 / 3))


def test_belief_follows_a_changed_truth_unless_it_was_given(tmp_path: Path) -> None:
    file = tmp_path / "task.yaml"
    file.write_text(
        dump_task(task_from_data({**MINIMAL, "belief": {"mass": 3}}, "test"))
    )
    task = load_task(file, ["support.friction=0.4", "object.mass=5"])
    assert task.full_belief == Belief(0.4, 0.6, 3.0, (0.0, 0.0))


def test_touching_bodies_are_allowed() -> None:
    fence = {"name": "fence", "box": [0.1, 0.15, 0.1], "pose": {"x": 0.725, "y": 0}}
    (obstacle,) = task_from_data({**MINIMAL, "obstacles": [fence]}, "test").obstacles
    assert obstacle.shape == Box((0.1, 0.15, 0.1))


def test_a_free_hand_reaches_everywhere() -> None:
    task = task_from_data(
        {**MINIMAL, "goal": {"x": 2, "y": 2}, "robots": [{"model": "hand"}]}, "test"
    )
    assert task.goal.x == 2.0


def test_a_robot_may_be_given_by_a_path_relative_to_the_file(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(urdf_text(load_facts("panda")))
    robots = [{"model": "arm.urdf", "tip_frame": "panda_link8"}]
    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump({**MINIMAL, "robots": robots}))
    task = load_task(file)
    assert task.robots[0].model == str(tmp_path / "arm.urdf")
    elsewhere = tmp_path / "below" / "task.yaml"
    elsewhere.parent.mkdir()
    elsewhere.write_text(dump_task(task))
    assert load_task(elsewhere) == task


@pytest.mark.parametrize("text", ["1e-2", ".01", "0.01", "1.0E-2", "+.01"])
def test_numbers_may_be_written_as_people_write_them(text: str) -> None:
    assert load_task("rear-push-rear", [f"motion.speed={text}"]).motion.speed == 0.01


def test_overrides_make_the_sections_that_the_file_lacks() -> None:
    task = load_task(
        "rear-push-rear",
        ["belief.mass=2", "limits.time=30", "object.shape={box: [0.1, 0.2, 0.3]}"],
    )
    assert task.full_belief.mass == 2.0
    assert task.limits.time == 30.0
    assert task.object.shape == Box((0.1, 0.2, 0.3))


@pytest.mark.parametrize("name", sorted(shipped_tasks()))
def test_every_vehicle_of_a_tasks_modes_is_accepted_and_no_other(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = load_task(name)
    # reach is the same with every vehicle, and looked at above
    monkeypatch.setattr(checks, "check_reach", lambda *_: None)
    count = len(task.robots)
    modes = task.modes or [name for name in MODES if MODES[name].arms <= count]
    if task.legs:
        return
    known = {vehicle for mode in modes for vehicle in MODES[mode].vehicles}
    for vehicle in get_args(Vehicle):
        override = [f"motion.vehicle={vehicle}"]
        if vehicle in known:
            assert load_task(name, override).motion.vehicle == vehicle
        else:
            with pytest.raises(TaskError, match=r"motion\.vehicle"):
                load_task(name, override)


def test_every_vehicle_is_one_of_some_mode() -> None:
    known = {vehicle for mode in MODES.values() for vehicle in mode.vehicles}
    assert known == set(get_args(Vehicle))


def test_a_task_built_in_python_is_checked_as_one_of_a_file() -> None:
    task = load_task("rear-push-rear")
    check_task(task)
    heavy = replace(task, object=replace(task.object, mass=2000.0))
    with pytest.raises(TaskError, match=r"object\.mass: 2000"):
        check_task(heavy)
    with pytest.raises(TaskError, match=r"object\.mass: 2000"):
        run(heavy, engine="planar")
    outside = replace(task, belief=Belief(center_of_mass=(0.9, 0.0)))
    with pytest.raises(TaskError, match=r"belief\.center_of_mass"):
        check_task(outside)
