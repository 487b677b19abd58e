"""The scene's physics against integrals: drag of every shape, friction of every pair,
inertia, repeatability.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator

from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import (
    Box,
    Compound,
    Cylinder,
    ObjectModel,
    Obstacle,
    Part,
    Prism,
    Robot,
    Support,
    Task,
)
from pushpressslide.core.wrench import Twist
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shapes import Shape
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.surface_friction import OBJECT_FRICTION, partner_friction
from pushpressslide.rom.drives import TwistDrive
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.scenes import build_scene, rest_height, solid_inertia

GRAVITY = 9.81
MASS = 1.2
FRICTION = 0.3
START = Pose2(0.503, 0.017, 0.2)  # not on the lattice of the support's grid
SHAPES = {
    "cube": Box((0.15, 0.15, 0.15)),
    "bar": Box((0.30, 0.10, 0.08)),
    "triangle": Prism(((-0.07, -0.08), (0.11, -0.02), (-0.05, 0.10)), 0.10),
    "cylinder": Cylinder(0.08, 0.12),
    "L": Prism(
        (
            (0.0, 0.0),
            (0.16, 0.0),
            (0.16, 0.06),
            (0.06, 0.06),
            (0.06, 0.16),
            (0.0, 0.16),
        ),
        0.06,
    ),
    "T": Compound(
        (
            Part(Box((0.12, 0.03, 0.04)), Pose2(0.0, 0.06)),
            Part(Box((0.03, 0.09, 0.04)), Pose2()),
        )
    ),
    "key": Compound(
        (
            Part(Cylinder(0.05, 0.04), Pose2()),
            Part(Box((0.12, 0.02, 0.04)), Pose2(0.09, 0.0, 0.4)),
        )
    ),
}


def still_plan(
    shape, obstacles=(), contact_friction=0.6, com=None, time_step=0.002
) -> Plan:
    """Return a plan that goes nowhere: it is only there to build a scene from, with no
    arm in it.
    """
    body = ObjectModel(shape, MASS, com if com is not None else shape.centroid)
    task = Task(
        "scene",
        body,
        START,
        START,
        (Robot("hand", (0.0, 0.0, 0.0)),),
        Support("table", FRICTION),
        contact_friction,
        obstacles=obstacles,
    )
    task = replace(task, robots=(), motion=replace(task.motion, time_step=time_step))
    path = ArcPath(START, ((0.0, 0.0),))
    profile = SpeedProfile(0.0, 0.05, 0.1)
    drive = TwistDrive(DraggedSurface(1.0, 0.1), 0.1)
    return Plan(task, (Segment("rear_push", (), drive, path, profile, START),))


class Dragged:
    """An object in its scene, held at a wanted planar twist by a velocity servo in the
    plane of the base.
    """

    def __init__(self, plan: Plan) -> None:
        scene = build_scene(plan)
        self.plant = scene.plant
        self.body = scene.object
        self.task = plan.task
        diagram = scene.builder.Build()
        self.simulator = Simulator(diagram)
        self.context = scene.plant.GetMyMutableContextFromRoot(
            self.simulator.get_mutable_context()
        )
        pose = rigid_transform(plan.task.true_start, rest_height(plan.task.object))
        scene.plant.SetFreeBodyPose(self.context, self.body, pose)
        self.port = scene.plant.get_applied_spatial_force_input_port()
        self.apply((0.0, 0.0, 0.0))

    def apply(self, wrench) -> None:
        """Apply (fx, fy, tau), world axes, at the CoM's projection on the support."""
        com = self.task.object.center_of_mass
        pushed = ExternallyAppliedSpatialForce()
        pushed.body_index = self.body.index()
        pushed.p_BoBq_B = np.array(
            [com[0], com[1], -0.5 * self.task.object.shape.height]
        )
        pushed.F_Bq_W = SpatialForce(
            tau=np.array([0, 0, wrench[2]]), f=np.array([wrench[0], wrench[1], 0])
        )
        self.port.FixValue(self.context, [pushed])

    def base_velocity(self):
        """Return the planar velocity, world axes, of the CoM's projection on the
        support.
        """
        X = self.plant.EvalBodyPoseInWorld(self.context, self.body)
        V = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.body)
        com = self.task.object.center_of_mass
        arm = X.rotation() @ np.array(
            [com[0], com[1], -0.5 * self.task.object.shape.height]
        )
        v = V.translational() + np.cross(V.rotational(), arm)
        return np.array([v[0], v[1], V.rotational()[2]])

    def yaw(self) -> float:
        R = self.plant.EvalBodyPoseInWorld(self.context, self.body).rotation().matrix()
        return math.atan2(R[1, 0], R[0, 0])

    def drag(self, twist_B, duration=0.5):
        """Return the mean wrench (fx, fy, tau) in B, about the CoM, that keeps up
        ``twist_B``.
        """
        dt = self.task.motion.time_step
        total = np.zeros(3)
        count = 0
        gain = np.array([200.0, 200.0, 0.6])
        integral = np.zeros(3)
        steps = round(duration / dt)
        for k in range(steps):
            c = math.cos(self.yaw())
            s = math.sin(self.yaw())
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            error = turn @ np.array(twist_B) - self.base_velocity()
            integral += 20.0 * dt * error
            wrench = gain * (error + integral)
            self.apply(wrench)
            self.simulator.AdvanceTo((k + 1) * dt)
            if k >= steps // 2:
                total = total + turn.T @ wrench
                count = count + 1
        return total / count


MOTIONS = {"x": (0.02, 0.0, 0.0), "y": (0.0, 0.02, 0.0), "yaw": (0.0, 0.0, 0.3)}


def drag_error(shape: Shape, motion: str) -> float:
    """Return the error of the measured drag over the integral of the pressure."""
    plan = still_plan(shape)
    body = plan.task.object
    twist = MOTIONS[motion]
    measured = Dragged(plan).drag(twist)
    samples = support_pressure(body.shape, MASS * GRAVITY, body.center_of_mass)
    exact = exact_wrench(samples, FRICTION, Twist(*twist))
    wanted = np.array([exact.fx, exact.fy, exact.tau])
    rho = np.abs(exact_wrench(samples, FRICTION, Twist(0.0, 0.0, 1.0)).tau) / (
        FRICTION * MASS * GRAVITY
    )
    scale = np.array([1.0, 1.0, 1.0 / rho])  # all in newtons
    return float(
        np.linalg.norm(scale * (measured - wanted)) / np.linalg.norm(scale * wanted)
    )


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("name", SHAPES)
def test_the_drag_of_every_shape_is_the_integral_of_its_pressure(
    name: str, motion: str
) -> None:
    assert drag_error(SHAPES[name], motion) < 0.03


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("name", ["chamfered", "ring", "stool", "mug", "bowl"])
def test_the_drag_of_a_body_on_its_own_base_is_the_integral_of_its_pressure(
    name: str, motion: str, standing: Callable[[str], MeshBody]
) -> None:
    assert drag_error(standing(name), motion) < 0.03


@pytest.mark.parametrize("movable", [False, True])
def test_what_stands_in_a_notch_is_not_touched(movable: bool) -> None:
    """A post inside the hull of an L, 5 mm off both inner sides."""
    pose = START.compose(Pose2(0.085, 0.085))
    post = Obstacle("post", Box((0.04, 0.04, 0.1)), pose, movable=movable)
    plan = still_plan(SHAPES["L"], (post,))
    dragged = Dragged(plan)
    dragged.simulator.AdvanceTo(0.4)
    X = dragged.plant.EvalBodyPoseInWorld(dragged.context, dragged.body)
    assert X.translation()[:2] == pytest.approx(START.position, abs=1e-5)
    assert dragged.yaw() == pytest.approx(START.yaw, abs=1e-4)


@pytest.mark.parametrize("movable", [False, True])
def test_an_obstacle_is_as_concave_in_the_simulation_as_in_the_task(
    movable: bool,
) -> None:
    """A post in the notch of an obstacle, 5 mm off both inner sides, is not touched."""
    pose = START.compose(Pose2(-0.085, -0.085))
    corner = Obstacle("corner", SHAPES["L"], pose, movable=movable)
    dragged = Dragged(still_plan(Box((0.04, 0.04, 0.1)), (corner,)))
    dragged.simulator.AdvanceTo(0.4)
    X = dragged.plant.EvalBodyPoseInWorld(dragged.context, dragged.body)
    assert X.translation()[:2] == pytest.approx(START.position, abs=1e-5)
    assert dragged.yaw() == pytest.approx(START.yaw, abs=1e-4)


def tilted_scene(plan: Plan, slope: float, bearing: float = 0.3):
    """Return the simulator of a scene whose gravity is that of a slope of ``slope`` =
    tan(angle).
    """
    scene = build_scene(plan)
    angle = math.atan(slope)
    along = GRAVITY * math.sin(angle)
    scene.plant.mutable_gravity_field().set_gravity_vector(
        [
            along * math.cos(bearing),
            along * math.sin(bearing),
            -GRAVITY * math.cos(angle),
        ]
    )
    simulator = Simulator(scene.builder.Build())
    context = scene.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    pose = rigid_transform(plan.task.true_start, rest_height(plan.task.object))
    scene.plant.SetFreeBodyPose(context, scene.object, pose)
    return scene, simulator, context


def sliding_acceleration(scene, simulator, context, body) -> float:
    """Return the acceleration [m/s^2] in the plane between 0.1 and 0.3 s."""
    speeds = []
    for t in (0.1, 0.3):
        simulator.AdvanceTo(t)
        speeds.append(
            np.linalg.norm(
                scene.plant.EvalBodySpatialVelocityInWorld(
                    context, body
                ).translational()[:2]
            )
        )
    return float(speeds[1] - speeds[0]) / 0.2


@pytest.mark.parametrize("name", ["cube", "cylinder", "L"])
@pytest.mark.parametrize(("inside", "stays"), [(0.012, True), (-0.004, False)])
def test_an_object_falls_off_a_table_that_ends_under_its_centre_of_mass(
    name: str, inside: float, stays: bool
) -> None:
    plan = still_plan(SHAPES[name])
    task = plan.task
    x, y = task.object.center_of_mass
    corners = ((x - 1.0, y - 1.0), (x + inside, y - 1.0))
    corners = (*corners, (x + inside, y + 1.0), (x - 1.0, y + 1.0))
    region = tuple(START.apply(corner) for corner in corners)
    task = replace(task, support=replace(task.support, region=region))
    scene, simulator, context = tilted_scene(replace(plan, task=task), 0.0)
    simulator.AdvanceTo(1.0)
    X = scene.plant.EvalBodyPoseInWorld(context, scene.object)
    lowered = rest_height(task.object) - X.translation()[2]
    assert (lowered < 1e-3) == stays


@pytest.mark.parametrize("slope", [0.28, 0.4])
def test_object_and_support_have_the_friction_of_their_pair(slope: float) -> None:
    scene, simulator, context = tilted_scene(still_plan(SHAPES["cube"]), slope)
    expected = max(0.0, GRAVITY * (slope - FRICTION) * math.cos(math.atan(slope)))
    assert sliding_acceleration(
        scene, simulator, context, scene.object
    ) == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize(("friction", "slope"), [(0.2, 0.3), (0.45, 0.6), (0.45, 0.4)])
def test_movable_obstacle_and_support_have_the_friction_of_their_pair(
    friction: float, slope: float
) -> None:
    post = Obstacle(
        "post", Box((0.1, 0.1, 0.06)), Pose2(0.52, 0.4, 0.0), True, 0.8, friction
    )
    scene, simulator, context = tilted_scene(still_plan(SHAPES["cube"], (post,)), slope)
    expected = max(0.0, GRAVITY * (slope - friction) * math.cos(math.atan(slope)))
    measured = sliding_acceleration(scene, simulator, context, scene.bodies["post"])
    assert measured == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("name", ["triangle", "cylinder", "L"])
def test_a_movable_obstacle_of_any_shape_has_the_friction_of_its_pair(
    name: str,
) -> None:
    post = Obstacle("post", SHAPES[name], Pose2(0.52, 0.5, 0.0), True, 0.8, 0.2)
    scene, simulator, context = tilted_scene(still_plan(SHAPES["cube"], (post,)), 0.3)
    expected = GRAVITY * 0.1 * math.cos(math.atan(0.3))
    measured = sliding_acceleration(scene, simulator, context, scene.bodies["post"])
    assert measured == pytest.approx(expected, abs=0.05)


def test_with_a_rough_obstacle_object_and_support_keep_the_friction_of_their_pair() -> (
    None
):
    post = Obstacle(
        "post", Box((0.1, 0.1, 0.06)), Pose2(0.52, 0.4, 0.0), True, 0.8, 0.45
    )
    scene, simulator, context = tilted_scene(still_plan(SHAPES["cube"], (post,)), 0.4)
    expected = GRAVITY * (0.4 - FRICTION) * math.cos(math.atan(0.4))
    assert sliding_acceleration(
        scene, simulator, context, scene.object
    ) == pytest.approx(expected, abs=0.03)


def test_tip_and_object_have_the_friction_of_their_pair() -> None:
    """A tip that holds its place beside a face while the object slides past feels mu
    times its normal force.
    """
    for pair in (0.3, 0.8):
        assert measured_tip_friction(pair) == pytest.approx(pair, rel=0.05)


def measured_tip_friction(pair: float) -> float:
    """Press a free tip on the left face of an object that is dragged along it; return
    |f_t| / f_n.
    """
    plan = still_plan(SHAPES["cube"], contact_friction=pair)
    radius = 0.02
    height = 0.05
    robot = Robot("hand", (0.0, 0.0, 0.0), tip_radius=radius)
    task = replace(plan.task, start=Pose2(0.5, 0.0, 0.0), robots=(robot,))
    (segment,) = plan.segments
    segment = replace(segment, path=ArcPath(task.start, ((0.0, 0.0),)))
    scene = build_scene(replace(plan, task=task, segments=(segment,)))
    simulator = Simulator(scene.builder.Build())
    context = scene.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    scene.plant.SetFreeBodyPose(
        context, scene.object, rigid_transform(task.start, rest_height(task.object))
    )
    hand = scene.robots[0]
    q0 = scene.plant.GetPositions(context, hand.model_instance)
    scene.plant.SetPositions(context, hand.model_instance, np.zeros(len(q0)))
    tip = scene.plant.CalcRelativeTransform(
        context, scene.plant.world_frame(), hand.tip_frame
    ).translation()
    target = np.array([0.5, 0.075 + radius + 1e-4, height])
    q0 = np.zeros(len(q0))
    q0[:3] += target - tip
    scene.plant.SetPositions(context, hand.model_instance, q0)
    applied = scene.plant.get_applied_spatial_force_input_port()
    actuation = scene.plant.get_actuation_input_port(hand.model_instance)
    ratios = []
    dt = task.motion.time_step
    press = 3.0
    weight = (
        sum(body.default_mass() for body in bodies_of(scene.plant, hand.model_instance))
        * GRAVITY
    )
    for k in range(250):
        q = scene.plant.GetPositions(context, hand.model_instance)
        v = scene.plant.GetVelocities(context, hand.model_instance)
        u = 4000.0 * (q0 - q) - 120.0 * v
        u[1], u[2] = -press - 60.0 * v[1], u[2] + weight
        actuation.FixValue(context, u)
        V = scene.plant.EvalBodySpatialVelocityInWorld(context, scene.object)
        X = scene.plant.EvalBodyPoseInWorld(context, scene.object)
        force = ExternallyAppliedSpatialForce()
        force.body_index, force.p_BoBq_B = (
            scene.object.index(),
            np.array([0.0, 0.0, height - 0.075]),
        )
        slide = 400.0 * (0.03 - V.translational()[0])
        side = -2e4 * X.translation()[1] - 300.0 * V.translational()[1]
        turn = -50.0 * X.rotation().matrix()[1, 0] - 2.0 * V.rotational()[2]
        force.F_Bq_W = SpatialForce(
            tau=np.array([0.0, 0.0, turn]), f=np.array([slide, side, 0.0])
        )
        applied.FixValue(context, [force])
        simulator.AdvanceTo((k + 1) * dt)
        if k > 150:
            results = scene.plant.get_contact_results_output_port().Eval(context)
            for i in range(results.num_hydroelastic_contacts()):
                info = results.hydroelastic_contact_info(i)
                ids = (info.contact_surface().id_M(), info.contact_surface().id_N())
                if hand.tip_geometry in ids:
                    f = info.F_Ac_W().translational()
                    ratios.append(math.hypot(f[0], f[2]) / abs(f[1]))
    return float(np.mean(ratios))


def bodies_of(plant, instance):
    return [plant.get_body(i) for i in plant.GetBodyIndices(instance)]


@pytest.mark.parametrize("pair", [0.05, 0.3, 0.6, 1.0, 1.5, 1.95])
def test_partner_surfaces_combine_to_the_friction_of_the_pair(pair: float) -> None:
    b = partner_friction(pair)
    assert 2.0 * OBJECT_FRICTION * b / (OBJECT_FRICTION + b) == pytest.approx(pair)


@pytest.mark.parametrize("pair", [0.0, 2.0, -1.0])
def test_a_pair_that_no_surface_gives_is_refused(pair: float) -> None:
    with pytest.raises(ValueError, match="pair friction"):
        partner_friction(pair)


def test_two_identical_runs_are_identical_to_the_last_bit() -> None:
    records = []
    for _ in range(2):
        dragged = Dragged(still_plan(SHAPES["triangle"]))
        wrench = dragged.drag((0.02, 0.01, 0.2), duration=0.2)
        state = dragged.context.get_discrete_state_vector().CopyToVector()
        records.append(np.concatenate([wrench, state]))
    assert np.array_equal(records[0], records[1])


@pytest.mark.parametrize("com", [(0.0, 0.0), (0.02, -0.03)])
def test_the_inertia_of_a_box_is_drakes_own_about_its_moved_centre_of_mass(com) -> None:
    own = solid_inertia(ObjectModel(Box((0.3, 0.1, 0.08)), MASS, com))
    drake = SpatialInertia.SolidBoxWithMass(MASS, 0.3, 0.1, 0.08)
    assert own.get_mass() == MASS
    np.testing.assert_allclose(own.get_com(), [*com, 0.0], atol=1e-15)
    about_com = own.Shift(own.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    np.testing.assert_allclose(
        about_com, drake.CalcRotationalInertia().CopyToFullMatrix3(), atol=1e-12
    )


def test_the_inertia_of_a_cylinder_is_drakes_own() -> None:
    own = solid_inertia(ObjectModel(Cylinder(0.08, 0.12), MASS, (0.0, 0.0)))
    drake = SpatialInertia.SolidCylinderWithMass(
        MASS, 0.08, 0.12, np.array([0.0, 0.0, 1.0])
    )
    np.testing.assert_allclose(
        own.CopyToFullMatrix6(), drake.CopyToFullMatrix6(), atol=1e-12
    )


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.01, -0.02)])
@pytest.mark.parametrize("name", ["triangle", "L", "T", "key"])
def test_the_inertia_of_a_prism_is_the_sum_over_its_cells(name, shift) -> None:
    shape = SHAPES[name]
    middle = shape.centroid
    com = (middle[0] + shift[0], middle[1] + shift[1])
    own = solid_inertia(ObjectModel(shape, MASS, com))
    # uniform, about the centroid
    samples = support_pressure(shape, MASS, middle, resolution=20)
    x, y = samples.points.T
    cell = 0.5 * samples.radii**2  # second moment of a cell about its own axis
    h2 = shape.height**2 / 12.0
    ixx = samples.loads @ (y**2 + cell + h2)
    iyy = samples.loads @ (x**2 + cell + h2)
    izz = samples.loads @ (x**2 + y**2 + 2.0 * cell)
    ixy = -samples.loads @ (x * y)
    wanted = np.array([[ixx, ixy, 0.0], [ixy, iyy, 0.0], [0.0, 0.0, izz]])
    about_com = own.Shift(own.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    np.testing.assert_allclose(about_com, wanted, rtol=1e-3, atol=2e-3 * izz)
    np.testing.assert_allclose(own.get_com(), [*com, 0.0], atol=1e-12)
