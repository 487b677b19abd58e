"""Parameters that a run identifies, with their intervals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.control.identified import Coordinate, Identified
from pushpressslide.core.pose import Pose2
from pushpressslide.identification.center import TOUCHED
from pushpressslide.identification.drag import (
    LEAST_WINDOWS,
    MOMENT,
    Drag,
    DragIdentifier,
    DragState,
)
from pushpressslide.identification.parameter import Parameter
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
        state = identifier.step(state, DT * tick, pose, force, lever)
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
        state = identifier.step(state, DT * tick, Pose2(), (4.0, 0.0), (-0.06, 0.0))
    assert state.levels == ()


def test_the_surer_value_stays_beside_what_was_believed_at_first() -> None:
    scene = load_task("rear-push-left").scene
    sure = Identified(Drag(3.0, 0.1), Coordinate(0.01, 0.002, (0.0, 1.0)))
    unsure = Identified(Drag(9.0, 0.2), Coordinate(0.09, 0.003, (1.0, 0.0)))
    assert sure.better(unsure) == sure
    assert unsure.better(sure) == sure
    assert Identified().better(sure) == sure
    assert sure.better(Identified()) == sure
    found = sure.figures(scene)["parameters"]
    product = scene.body.mass * scene.support.friction
    drag = found["mass_times_friction"]
    assert drag["value"] == pytest.approx(3.0 / scene.max_friction() * product)
    assert drag["believed"] == product
    center = found["center_of_mass"]
    assert center["high"] - center["value"] == pytest.approx(1.96 * 0.002)
    assert center["direction"] == [0.0, 1.0]
    assert Identified().figures(scene) == {}


@pytest.mark.parametrize(("believed", "contradicted"), [(1.19, False), (1.21, True)])
def test_a_belief_outside_the_interval_is_contradicted(
    believed: float, contradicted: bool
) -> None:
    assert Parameter(1.0, 0.1, believed).contradicts_belief == contradicted


def test_page_and_text_say_what_contradicts_the_belief() -> None:
    scene = load_task("rear-push-left").scene
    sure = Identified(Drag(3.0 * scene.max_friction(), 0.1), None).figures(scene)
    (line,) = parameter_lines(sure)
    assert line.endswith("contradicts belief")
    assert "contradicts belief" in parameters_part(sure)
    assert parameters_part({"parameters": None}) == ""
    center = Identified(None, Coordinate(0.0101, TOUCHED, (0.0, 1.0))).figures(scene)
    assert "10.1 mm" in parameters_part(center)


def test_a_run_identifies_a_heavier_object_than_believed() -> None:
    from pushpressslide.jobs.run import run

    task = load_task("rear-push-left")
    believed = 0.8 * task.object.mass
    record = run(task, overrides={"belief.mass": believed}, engine="planar")
    figures = result(record.plan.task, record.plan, record)
    found = lookup(figures, "parameters.mass_times_friction")
    true = task.object.mass * task.support.friction
    assert found["low"] <= true <= found["high"]
    assert found["believed"] == pytest.approx(0.8 * true)
    assert found["contradicts_belief"]
