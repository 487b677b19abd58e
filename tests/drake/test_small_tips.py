"""Small tips: the clearance of their rods, and their indentation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ExternallyAppliedSpatialForce,
)
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.arms.paths.clearance import CLEARANCE, Gap
from pushpressslide.arms.paths.joint_path import joint_path
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.margins import rod_radius
from pushpressslide.core.plan import Plan
from pushpressslide.core.support_frame import TABLE
from pushpressslide.core.task import ObjectModel
from pushpressslide.geometry.shapes import Box
from pushpressslide.jobs.run import simulate
from pushpressslide.selection.solve import plan as make_plan
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.clearance import ROD_ROOM, DrakeClearance
from pushpressslide.sim.contact import solve_contacts
from pushpressslide.sim.plane import add_plane
from pushpressslide.sim.scenes import add_object, object_modulus
from pushpressslide.sim.surfaces import (
    DEEPEST,
    HYDROELASTIC_MODULUS,
    rigid_properties,
    tip_modulus,
)
from pushpressslide.taskfile.load import load_task

RADII = (0.002, 0.00475, 0.008)  # [m]
TASKS = Path(load_task("press-slide").source).parent


def with_tip(name: str, radius: float) -> Plan:
    return make_plan(load_task(name, [f"robots.0.tip_radius={radius}"]))


def contact_gap(plan: Plan) -> Gap:
    """Return the gap with the least to spare along the contact."""
    path, _ = joint_path(DRAKE, plan)
    (segment, *_) = plan.segments
    poses = [plan.object_pose(segment, float(s)) for s in path.arc_length]
    return DrakeClearance(plan, 0).min_distance(path.move, poses, touching=True)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide"])
def test_a_small_tip_has_a_joint_path(name: str, radius: float) -> None:
    gap = contact_gap(with_tip(name, radius))
    left = radius - rod_radius(radius)
    assert gap.clear
    assert gap.allowed in (CLEARANCE, pytest.approx(ROD_ROOM * left))
    assert gap.distance <= left + 1e-6


@pytest.mark.parametrize("radius", [0.012, 0.015, 0.02, 0.03])
def test_beside_a_larger_tip_its_rod_keeps_the_usual_clearance(radius: float) -> None:
    assert ROD_ROOM * (radius - rod_radius(radius)) > CLEARANCE
    assert contact_gap(with_tip("rear-push-rear", radius)).allowed == CLEARANCE


def test_before_the_contact_a_small_tips_rod_keeps_the_usual_clearance() -> None:
    plan = with_tip("rear-push-rear", RADII[0])
    path, _ = joint_path(DRAKE, plan)
    model = DrakeClearance(plan, 0)
    first = [plan.task.start]
    assert model.min_distance(path.move[:1], first, touching=False).allowed == CLEARANCE
    assert model.min_distance(path.move[:1], first, touching=True).allowed < CLEARANCE


def sunk(radius: float, force: float, height: float) -> float:
    """Depth [m] to which a smooth sphere sinks into a box on the table, after it was
    put on top and pressed with a force that grows to ``force`` [N].
    """
    body = ObjectModel(Box((0.2, 0.2, height)), 1.0, (0.0, 0.0))
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.004)
    solve_contacts(plant)
    modulus = tip_modulus(body.shape, radius, force)
    box = add_object(plant, body, 1.0, modulus)
    plane = add_plane(plant, TABLE, 0.5)
    plane.stand(plant, box, body.shape, 1.0)
    tip = plant.AddRigidBody("tip", SpatialInertia.SolidSphereWithMass(0.5, radius))
    properties = rigid_properties(0.01, 0.3 * radius)
    X = RigidTransform()
    plant.RegisterCollisionGeometry(tip, X, Sphere(radius), "tip", properties)
    plant.Finalize()
    plane.let_bases_stand(plant, scene_graph)
    port = plant.get_applied_spatial_force_input_port()
    builder.ExportInput(port, "press")
    diagram = builder.Build()
    simulator = Simulator(diagram)
    root = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(root)
    plant.SetFreeBodyPose(context, box, RigidTransform([0.0, 0.0, 0.5 * height]))
    plant.SetFreeBodyPose(context, tip, RigidTransform([0.0, 0.0, height + radius]))
    press = ExternallyAppliedSpatialForce()
    press.body_index = tip.index()
    for share in np.linspace(0.0, 1.0, 101):
        pressed = np.array([0.0, 0.0, 0.5 * GRAVITY - share * force])
        press.F_Bq_W = SpatialForce(np.zeros(3), pressed)
        diagram.GetInputPort("press").FixValue(root, [press])
        simulator.AdvanceTo(0.5 * share)
    simulator.AdvanceTo(0.7)
    z = plant.EvalBodyPoseInWorld(context, tip).translation()[2]
    return height + radius - float(z)


@pytest.mark.parametrize(
    ("radius", "force", "height"),
    [
        (0.002, 10.0, 0.1),
        (0.002, 60.0, 0.05),
        (0.00475, 40.0, 0.15),
        (0.008, 80.0, 0.3),
    ],
)
def test_under_the_largest_force_a_tip_sinks_in_by_a_third_of_its_radius(
    radius: float, force: float, height: float
) -> None:
    assert tip_modulus(Box((0.2, 0.2, height)), radius, force) > HYDROELASTIC_MODULUS
    assert sunk(radius, force, height) == pytest.approx(DEEPEST * radius, rel=0.12)


@pytest.mark.parametrize("file", sorted(TASKS.glob("*.yaml")), ids=lambda f: f.stem)
def test_the_object_of_a_shipped_task_has_the_usual_modulus(file: Path) -> None:
    assert object_modulus(load_task(file)) == HYDROELASTIC_MODULUS


@pytest.mark.long
@pytest.mark.parametrize("model", ["panda", "iiwa7", "hand"])
@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide"])
def test_an_arm_reaches_the_goal_with_the_smallest_tip(name: str, model: str) -> None:
    settings = (f"robots.0.model={model}", f"robots.0.tip_radius={RADII[0]}")
    task = load_task(name, settings)
    _, record, _ = simulate(task)
    assert record.reason == "goal_reached"
    moving = record.arrays["phase"] == 2
    height = record.arrays["tip_position"][moving][:, 0, 2]
    force = record.arrays["measured_force"][moving][:, 0]
    weight = task.object.mass * GRAVITY
    shear = np.hypot(force[:, 0], force[:, 1])
    share = shear / (task.support.friction * (weight - force[:, 2]))
    assert np.percentile(share, 90.0) == pytest.approx(1.0, abs=0.02)
    if name == "press-slide":
        sinks = task.object.shape.height + RADII[0] - height
        assert 0.0 < np.percentile(sinks, 99.0) < DEEPEST * RADII[0]
