"""Walls in Drake: poses there and back, an object that rests in its opening, and the
press-fit.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.systems.analysis import Simulator

from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import Box, ObjectModel, Opening, Support, Task
from pushpressslide.jobs.run import simulate
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.report.metrics import result
from pushpressslide.rom.drives import TwistDrive
from pushpressslide.sim.convert import (
    planar_pose,
    planar_pose_from_positions,
    rigid_transform,
)
from pushpressslide.sim.scenes import build_scene, rest_height
from pushpressslide.taskfile.load import load_task

GRAVITY = 9.81
WALL = SupportFrame.of_wall((0.9, 0.2, 0.7), 2.0)


@settings(max_examples=30)
@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-3.1, 3.1))
def test_a_pose_on_a_wall_comes_back_from_the_world(x, y, yaw) -> None:
    X = rigid_transform(Pose2(x, y, yaw), 0.1, WALL)
    back = planar_pose(X, WALL)
    assert (back.x, back.y, back.yaw) == pytest.approx((x, y, yaw), abs=1e-12)
    q = np.concatenate([X.rotation().ToQuaternion().wxyz(), X.translation()])
    again = planar_pose_from_positions(q, WALL)
    assert (again.x, again.y, again.yaw) == pytest.approx((x, y, yaw), abs=1e-12)


class Pressed:
    """A box on a wall with an opening, pressed at its middle by a force that does not
    turn.
    """

    SHAPE = Box((0.12, 0.3, 0.1))
    MASS = 1.0
    FRICTION = 0.4

    def __init__(self, start: Pose2, opening: Opening | None) -> None:
        support = Support("wall", self.FRICTION, WALL, opening)
        task = Task(
            "pressed",
            ObjectModel(self.SHAPE, self.MASS, (0.0, 0.0)),
            start,
            start,
            (),
            support,
        )
        drive = TwistDrive(DraggedSurface(1.0, 0.1), 0.1)
        profile = SpeedProfile(0.0, 0.05, 0.1)
        segment = Segment("", (), drive, ArcPath(start, ()), profile, start)
        plan = Plan(task, (segment,))
        self.scene = build_scene(plan, time_step=0.002)
        self.diagram = self.scene.builder.Build()
        self.simulator = Simulator(self.diagram)
        plant = self.scene.plant
        self.context = self.simulator.get_mutable_context()
        self.plant_context = plant.GetMyMutableContextFromRoot(self.context)
        pose = rigid_transform(start, rest_height(task.object), WALL)
        plant.SetFreeBodyPose(self.plant_context, self.scene.object, pose)

    def under(self, force, seconds: float) -> tuple[Pose2, float]:
        """Return the pose, and the height of the middle [m], after a time under
        ``force`` [N] along x, y and height.
        """
        pull = ExternallyAppliedSpatialForce()
        pull.body_index, pull.p_BoBq_B = self.scene.object.index(), np.zeros(3)
        pull.F_Bq_W = SpatialForce(np.zeros(3), np.array(WALL.direction(force)))
        plant = self.scene.plant
        plant.get_applied_spatial_force_input_port().FixValue(
            self.plant_context, [pull]
        )
        self.simulator.AdvanceTo(self.context.get_time() + seconds)
        X = plant.EvalBodyPoseInWorld(self.plant_context, self.scene.object)
        return planar_pose(X, WALL), WALL.coordinates(tuple(X.translation()))[2]


def test_the_wall_holds_up_to_its_friction_and_no_more() -> None:
    weight = Pressed.MASS * GRAVITY
    press = 40.0
    # creeps by 0.06 mm/s, as is Drake's way
    held = (0.0, weight - 0.5 * Pressed.FRICTION * press, -press)
    pressed = Pressed(Pose2(0.1, -0.2, 0.3), None)
    before, _ = pressed.under(held, 0.1)  # the press builds up
    pose, height = pressed.under(held, 0.5)
    assert (pose.x, pose.y, pose.yaw) == pytest.approx(
        (before.x, before.y, before.yaw), abs=5e-5
    )
    assert height == pytest.approx(0.05, abs=1e-4)
    slid = (0.0, weight - 1.2 * Pressed.FRICTION * press, -press)
    pose, _ = Pressed(Pose2(0.1, -0.2, 0.3), None).under(slid, 0.5)
    assert pose.y == pytest.approx(
        -0.2 - 0.5 * 0.2 * Pressed.FRICTION * press / Pressed.MASS * 0.25, rel=0.05
    )
    assert pose.x == pytest.approx(0.1, abs=2e-4)


def test_an_object_pressed_into_its_opening_stops_at_the_back_on_the_sill() -> None:
    opening = Opening((0.14, 0.32), (0.1, -0.2), 0.06)
    pressed = Pressed(Pose2(0.1, -0.2, 0.0), opening)
    pose, height = pressed.under((0.0, 0.0, -20.0), 1.5)
    assert height == pytest.approx(0.05 - 0.06, abs=3e-4)
    assert pose.y == pytest.approx(-0.21, abs=3e-4)
    # too wide so: it stays on the face
    turned = Pressed(Pose2(0.1, -0.2, 0.3), opening)
    _, height = turned.under((0.0, Pressed.MASS * GRAVITY, -20.0), 1.0)
    assert height == pytest.approx(0.05, abs=3e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    "overrides",
    [
        pytest.param([], id="15 mm a side"),
        pytest.param(
            ["support.opening.size=[0.82, 0.27]", "goal.y=-0.01"], id="10 mm a side"
        ),
    ],
)
def test_the_press_fit_ends_in_the_opening_and_never_leaves_the_wall(overrides) -> None:
    task = load_task("press-fit", overrides)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"], found["reason"]
    assert found["final_position_error"] < 0.005
    assert math.degrees(found["final_yaw_error"]) < 1.0
    assert found["support_gap_max"] < 0.002
    assert found["seated_depth"] == pytest.approx(0.15, abs=0.002)
    assert found["torque_limit_violation_fraction"] == 0.0
    # the landing on the back too
    assert found["max_normal_force"] < task.limits.normal_force
    assert 0.0 < found["fall_height"] < 0.04
    assert len(plan.placements) == 1  # nothing let go on the way
    entered = np.argmax(record.arrays["tip_position"][:, :, 2].max(axis=1) < 0.255)
    before = record.arrays["phase"][:entered]
    # pressed from the touch to the opening, without a break
    assert not np.any(np.diff(before) < 0.0)
