"""Parameters that a run identifies, with their intervals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pushpressslide.control.identified import Identified
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.identification.center import TOUCHED
from pushpressslide.identification.drag import (
    LEAST_WINDOWS,
    MOMENT,
    Drag,
    DragIdentifier,
    DragState,
)
from pushpressslide.identification.parameter import Parameter
from pushpressslide.jobs.run import run
from pushpressslide.report.metrics import result
from pushpressslide.report.page_tables import lookup
from pushpressslide.report.parameters import parameter_lines, parameters_part
from pushpressslide.taskfile.load import load_task

RHO = 0.05
DT = 0.004


def pushed(noise: float, windows: int, seed: int = 0, moment: float = 0.0) -> DragState:
    """State after straight pushes with a force of 4 N and a ``moment`` [N m]."""
    random = np.random.default_rng(seed)
    identifier = DragIdentifier(RHO, 0.2)
    state = DragState()
    for tick in range(windows * 50 + 60):
        force = (4.0 + noise * float(random.normal()), 0.0)
        pose = Pose2(0.05 * DT * tick, 0.0, 0.0)
        lever = (-0.06, -moment / 4.0)
        state = identifier.step(state, DT * tick, pose, force, lambda at=lever: at)
    return state


def test_the_drag_of_a_straight_push_is_its_force() -> None:
    drag = Drag.of_windows(pushed(0.0, 10), 0.0, 0.0)
    assert drag is not None
    assert drag.mean == pytest.approx(4.0)
    assert drag.deviation == pytest.approx(0.0, abs=1e-12)


def test_a_moment_adds_to_the_drag_and_to_its_doubt() -> None:
    drag = Drag.of_windows(pushed(0.0, 10, moment=0.1), 0.0, 0.0)
    assert drag is not None
    assert drag.mean == pytest.approx(math.hypot(4.0, 0.1 / RHO))
    assert drag.deviation == pytest.approx(MOMENT * (drag.mean - 4.0))


def test_errors_of_lever_and_force_are_propagated() -> None:
    state = pushed(0.0, 10, moment=0.1)
    unsure = Drag.of_windows(state, 0.02, 0.0)
    shifted = [
        Drag.of_windows(pushed(0.0, 10, moment=0.1 + sign * 4.0 * 0.02 * RHO), 0.0, 0.0)
        for sign in (-1.0, 1.0)
    ]
    assert unsure is not None
    low, high = (one.mean for one in shifted if one is not None)
    own = MOMENT * (unsure.mean - 4.0)
    changed = math.sqrt(unsure.deviation**2 - own**2)
    assert changed == pytest.approx(0.5 * (high - low), rel=1e-2)
    biased = Drag.of_windows(pushed(0.0, 10), 0.0, 0.03)
    assert biased is not None
    assert biased.deviation == pytest.approx(0.03)


def test_too_few_windows_give_no_interval() -> None:
    assert Drag.of_windows(pushed(0.0, LEAST_WINDOWS - 1), 0.0, 0.0) is None
    assert Drag.of_windows(pushed(0.0, LEAST_WINDOWS), 0.0, 0.0) is not None


def test_the_interval_of_a_noisy_force_holds_the_truth_as_often_as_it_says() -> None:
    held = 0
    for seed in range(200):
        drag = Drag.of_windows(pushed(1.0, 20, seed), 0.0, 0.0)
        assert drag is not None
        held += not Parameter(drag.mean, drag.deviation, 4.0).contradicts_belief
    assert 0.90 <= held / 200 <= 0.99


def test_an_object_at_rest_tells_no_drag() -> None:
    identifier = DragIdentifier(RHO, 0.2)
    state = DragState()
    for tick in range(600):
        state = identifier.step(
            state, DT * tick, Pose2(), (4.0, 0.0), lambda: (-0.06, 0.0)
        )
    assert state.levels == ()


def test_the_surer_value_stays_of_each_parameter() -> None:
    drag = Parameter(0.3, 0.1, 0.2)
    place = Parameter(0.01, 0.002, 0.0, (0.0, 1.0))
    sure = Identified({"mass_times_friction": drag, "center_of_mass": place})
    unsure = Identified({"mass_times_friction": Parameter(0.9, 0.2, 0.2)})
    assert sure.better(unsure) == sure
    assert unsure.better(sure) == sure
    assert Identified().better(sure) == sure
    assert sure.better(Identified()) == sure
    found = sure.figures["parameters"]
    assert found["mass_times_friction"]["believed"] == 0.2
    center = found["center_of_mass"]
    assert center["high"] - center["value"] == pytest.approx(1.96 * 0.002)
    assert center["direction"] == [0.0, 1.0]
    assert Identified().figures == {}


@pytest.mark.parametrize(("believed", "contradicted"), [(1.19, False), (1.21, True)])
def test_a_belief_outside_the_interval_is_contradicted(
    believed: float, contradicted: bool
) -> None:
    assert Parameter(1.0, 0.1, believed).contradicts_belief == contradicted


def test_page_and_text_say_what_contradicts_the_belief() -> None:
    sure = Identified({"mass_times_friction": Parameter(3.0, 0.1, 0.3)}).figures
    (line,) = parameter_lines(sure)
    assert line.endswith("contradicts belief")
    assert "contradicts belief" in parameters_part(sure)
    assert parameters_part({"parameters": None}) == ""
    place = Parameter(0.0101, TOUCHED, 0.0, (0.0, 1.0))
    assert "10.1 mm" in parameters_part(Identified({"center_of_mass": place}).figures)


def found_in(name: str, **sensing: Any) -> tuple[Record, dict[str, Any]]:
    """Record and parameters of a run with late pictures."""
    late = {"pose_delay": 0.048, "pose_rate": 30.0, "position_noise": 5e-4}
    overrides = {f"sensing.{key}": value for key, value in (late | sensing).items()}
    record = run(load_task(name), overrides=overrides, engine="planar")
    return record, record.meta["parameters"]


def test_a_push_tells_delay_and_rho() -> None:
    record, found = found_in("rear-push-rear")
    delay = found["pose_delay"]
    assert delay["value"] == pytest.approx(0.048, abs=1e-4)
    assert delay["high"] - delay["low"] >= 2.0 * 1.96 * DT / math.sqrt(12.0)
    rho = found["rho"]
    # the engine's surface is no ellipsoid, and the tip's centre is behind the contact
    assert rho["value"] == pytest.approx(record.plan.segments[0].drive.rho, rel=0.04)
    assert not rho["contradicts_belief"]


def test_a_press_tells_rho_and_no_tip_offset() -> None:
    record, found = found_in("press-slide")
    rho = found["rho"]["value"]
    assert rho == pytest.approx(record.plan.segments[0].drive.rho, rel=0.04)
    assert "tip_offset" not in found


def test_a_wrong_rho_is_contradicted() -> None:
    wrong = run(
        load_task("rear-push-rear"), overrides={"belief.rho": 0.07}, engine="planar"
    )
    rho = wrong.meta["parameters"]["rho"]
    assert rho["believed"] == 0.07
    assert rho["value"] == pytest.approx(0.0456, rel=0.1)
    assert rho["contradicts_belief"]


def test_a_tip_offset_is_the_tips_error_along_the_normal() -> None:
    error = (0.003, -0.002, 0.0)
    record, found = found_in("rear-push-left", tip_bias=error)
    offset = found["tip_offset"]
    nx, ny = offset["direction"]
    poses = record.arrays["object_pose"][record.arrays["phase"] == 2]
    yaw = poses[:, 2]
    along_x = np.cos(yaw) * nx - np.sin(yaw) * ny
    along_y = np.sin(yaw) * nx + np.cos(yaw) * ny
    true = float(np.mean(error[0] * along_x + error[1] * along_y))
    assert abs(true) > 1e-3
    assert offset["value"] == pytest.approx(true, abs=2e-4)


def test_tips_and_pictures_that_are_equally_wrong_agree() -> None:
    both = {"tip_bias": (0.003, -0.002, 0.0), "position_bias": (0.003, -0.002)}
    _, found = found_in("rear-push-left", **both)
    assert found["tip_offset"]["value"] == pytest.approx(0.0, abs=2e-4)


def test_two_arms_have_an_offset_each() -> None:
    _, found = found_in("parallel-push")
    assert {"tip_offset_left", "tip_offset_right"} <= set(found)
    assert "rho" not in found


def test_a_run_identifies_a_heavier_object_than_believed() -> None:
    task = load_task("rear-push-left")
    believed = 0.8 * task.object.mass
    record = run(task, overrides={"belief.mass": believed}, engine="planar")
    figures = result(record.plan.task, record.plan, record)
    found = lookup(figures, "parameters.mass_times_friction")
    true = task.object.mass * task.support.friction
    assert found["low"] <= true <= found["high"]
    assert found["believed"] == pytest.approx(0.8 * true)
    assert found["contradicts_belief"]


def test_a_press_that_slides_identifies_the_friction_of_its_tip() -> None:
    overrides = {
        "motion.press_force": None,
        "contact.friction": 0.38,
        "belief.contact_friction": 0.8,
        "belief.friction_error": 0.1,
        "belief.mass_error": 0.1,
        "sensing.position_noise": 1e-3,
        "sensing.force_noise": 0.3,
    }
    record = run(load_task("press-slide"), overrides=overrides, engine="planar", seed=1)
    friction = record.meta["parameters"]["tip_friction"]
    assert friction["low"] < 0.38 < friction["high"]
    assert friction["high"] - friction["low"] < 0.07
    assert friction["contradicts_belief"]
    assert record.reason == "goal_reached"
