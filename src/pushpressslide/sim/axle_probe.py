"""Open-loop probing of a pressed object: a force of constant direction in the body, and
what it turns about.

Nothing steers: a free tip presses on top and drags, and a servo sets only the size of
its force, so that the object slides at an even pace. Its twist then says where the
virtual axle is (docs/mechanics.md, section 4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    DiscreteContactApproximation,
)
from pydrake.multibody.tree import default_model_instance
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Robot, Task
from pushpressslide.sim.convert import planar_pose_from_positions, rigid_transform
from pushpressslide.sim.robot_models import add_robot
from pushpressslide.sim.scenes import (
    object_friction,
    rest_height,
    solid_inertia,
    tile_size,
)
from pushpressslide.sim.station import ContactForceSensor
from pushpressslide.sim.surfaces import (
    compliant_properties,
    object_shape,
    partner_friction,
    rigid_properties,
    support_grid,
)

START = Pose2(0.013, 0.017, 0.2)  # X_WG; not on the lattice of the support's grid
GAP = 1e-4  # [m] of the tip above the object at the start
PRESS_RAMP = 0.3  # [s] in which the load comes on
DRAG_START = 0.4
DRAG_RAMP = 0.3  # [s] when the drag begins, and in which it reaches its speed
SETTLED = 1.8
END = 3.0  # [s] the figures are of what happens between
DRAG_DAMPING = 500.0  # [N s/m] of the servo along the force
LIFT_DAMPING = 20.0  # [N s/m] of the tip's motion up and down
YAW_DAMPING = 1.0  # [N m s/rad] with which the hand's yaw follows the object's
YAW_STIFFNESS = 50.0  # [N m/rad] with which it is held, where it is held
ROOM = 0.2  # [m] of support around the object
LEAST_TURN_RATE = 2e-3  # [rad/s] below which no axle can be told


@dataclass(frozen=True, slots=True)
class Probe:
    """One push: where and how hard the tip presses, and which way it drags."""

    contact: Point  # [m] in B
    load: float  # [N]
    force_angle: float  # [rad] of the drag, from the line CoM to contact, constant in B
    speed: float = 0.05  # [m/s] that the servo wants of the tip along the drag
    tile: float = 0.025  # [m] edge of the support's grid
    # keep the hand's yaw; else it turns with the object and no spin friction is left
    hold_yaw: bool = False


@dataclass(frozen=True, slots=True)
class AxleMeasurement:
    """What a probe measured: medians over the settled part of the run."""

    # [m] on the line CoM to contact: 0 at the CoM, positive towards the contact
    axle: float
    axle_band: tuple[float, float]  # [m] 5th and 95th percentile over time
    turn_rate: float  # [rad/s]
    speed: float  # [m/s] of the CoM
    force_angle: float  # [rad] of the measured contact force
    force: float  # [N] along the support
    load: float  # [N]
    friction_use: float  # largest share of the tip's friction
    slip: float  # [m] that the tip wandered on the object


def probe_axle(task: Task, probe: Probe, time_step: float = 0.004) -> AxleMeasurement:
    """Push the object of ``task`` as ``probe`` says and return where it turned about.

    Of the task only the object, the support and the frictions count; the robot is a
    free ``hand``. Raises SimulationError where the object did not turn.
    """
    rows = _Rig(task, probe, time_step).run()
    vx = rows[:, 0]
    vy = rows[:, 1]
    w = rows[:, 2]
    size = math.hypot(*probe.contact)
    ex = probe.contact[0] / size
    ey = probe.contact[1] / size
    turn_rate = float(np.median(w))
    if abs(turn_rate) < LEAST_TURN_RATE:
        raise SimulationError(
            f"the object turned at {turn_rate:.2g} rad/s; too slow to tell about what"
        )
    axle = -(ex * vy - ey * vx) / w
    along = ex * rows[:, 3] + ey * rows[:, 4]
    across = ex * rows[:, 4] - ey * rows[:, 3]
    shear = np.hypot(along, across)
    load = rows[:, 5]
    low, high = np.percentile(axle, [5.0, 95.0])
    return AxleMeasurement(
        float(np.median(axle)),
        (float(low), float(high)),
        turn_rate,
        float(np.median(np.hypot(vx, vy))),
        float(np.arctan2(np.median(across), np.median(along))),
        float(np.median(shear)),
        float(np.median(load)),
        float(np.max(shear / load)) / task.contact_friction,
        float(
            np.hypot(rows[:, 6] - probe.contact[0], rows[:, 7] - probe.contact[1]).max()
        ),
    )


class _Rig:
    """The object, a fine support, and a free tip on top of it: the scene of a run but
    for its tiles.
    """

    def __init__(self, task: Task, probe: Probe, time_step: float) -> None:
        body = task.object
        own = object_friction(task)
        hand = Robot("hand", (0.0, 0.0, 0.0), tip_radius=task.robots[0].tip_radius)
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, time_step)
        plant.set_contact_model(ContactModel.kHydroelastic)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kLagged)
        thing = plant.AddRigidBody(
            "object", default_model_instance(), solid_inertia(body)
        )
        soft = compliant_properties(
            own, min(0.25 * body.shape.height, tile_size(body.shape))
        )
        plant.RegisterCollisionGeometry(
            thing, RigidTransform(), object_shape(body.shape), "object", soft
        )
        half = body.shape.farthest((0.0, 0.0)) + ROOM
        grid = support_grid(
            (START.x - half, START.x + half, START.y - half, START.y + half), probe.tile
        )
        rough = rigid_properties(partner_friction(task.support.friction, own))
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), grid, "support", rough
        )
        grip = rigid_properties(
            partner_friction(task.contact_friction, own), 0.3 * hand.tip_radius
        )
        robot = add_robot(plant, hand, 0, tip_properties=grip)
        plant.Finalize()
        sensor = builder.AddSystem(ContactForceSensor(plant, robot))
        builder.Connect(
            plant.get_reaction_forces_output_port(),
            sensor.GetInputPort("reaction_forces"),
        )
        builder.Connect(
            plant.get_body_poses_output_port(), sensor.GetInputPort("body_poses")
        )
        instance = robot.model_instance
        builder.ExportInput(plant.get_actuation_input_port(instance), "torque")
        builder.ExportOutput(sensor.GetOutputPort("force"), "force")
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        self.context = self.simulator.get_mutable_context()
        self.state = plant.GetMyMutableContextFromRoot(self.context)
        self.torque, self.force = (
            diagram.GetInputPort("torque"),
            diagram.GetOutputPort("force"),
        )
        plant.SetFreeBodyPose(
            self.state, thing, rigid_transform(START, rest_height(body))
        )
        self.contact_G = body.X_GB.apply(probe.contact)
        x, y = START.apply(self.contact_G)
        plant.SetPositions(self.state, instance, np.zeros(4))
        tip = robot.tip_frame.CalcPoseInWorld(self.state).translation()
        above = body.shape.height + hand.tip_radius + GAP
        self.home = np.array([x - tip[0], y - tip[1], above - tip[2], 0.0])
        plant.SetPositions(self.state, instance, self.home)
        self.center = body.center_of_mass
        self.probe = probe
        self.dt = time_step
        v0 = plant.num_positions()
        joints = [
            plant.GetJointByName(fact.name, instance) for fact in robot.facts.moving
        ]
        self.hand_q = np.array([joint.position_start() for joint in joints])
        self.hand_v = v0 + np.array([joint.velocity_start() for joint in joints])
        self.object_q = thing.floating_positions_start()
        self.object_v = v0 + thing.floating_velocities_start_in_v()
        v = self.hand_v - v0
        self.weight = -plant.CalcGravityGeneralizedForces(self.state)[v]
        # [kg] along the support
        self.inertia = float(plant.CalcMassMatrix(self.state)[v[0], v[0]])

    def run(self) -> Array:
        """Return rows of the settled part: the CoM's velocity and turn rate, the
        contact force along the support, the load, and the tip's place; all in B.
        """
        rows = []
        cx, cy = self.center
        start = START.apply(self.contact_G)
        self.simulator.Initialize()
        for i in range(round(END / self.dt)):
            x = self.state.get_discrete_state_vector().CopyToVector()
            pose = planar_pose_from_positions(x[self.object_q : self.object_q + 7])
            w, vx, vy = (float(x[self.object_v + k]) for k in (2, 3, 4))
            if i * self.dt >= SETTLED:
                fx, fy, fz = self.force.Eval(self.context)
                way = x[self.hand_q] - self.home
                tx, ty = pose.unapply((start[0] + way[0], start[1] + way[1]))
                ux, uy = pose.unrotate((vx, vy))
                force = pose.unrotate((fx, fy))
                rows.append(
                    (ux - w * cy, uy + w * cx, w, *force, -fz, tx - cx, ty - cy)
                )
            self.torque.FixValue(
                self.context, self._torque(i * self.dt, x, pose.yaw, w)
            )
            self.simulator.AdvanceTo((i + 1) * self.dt)
        return np.array(rows)

    def _torque(self, t: float, x: Array, yaw: float, w: float) -> Array:
        """Return the forces [N] and the torque [N m] of the hand's joints at time
        ``t``.
        """
        probe = self.probe
        vx, vy, vz, turn = x[self.hand_v]
        out = self.weight.copy()
        out[2] -= probe.load * min(t / PRESS_RAMP, 1.0) + LIFT_DAMPING * vz
        if probe.hold_yaw:
            out[3] -= (
                YAW_STIFFNESS * (x[self.hand_q[3]] - self.home[3]) + YAW_DAMPING * turn
            )
        else:
            out[3] += YAW_DAMPING * (w - turn)
        if t > DRAG_START:
            axis = math.atan2(probe.contact[1], probe.contact[0])
            c = math.cos(yaw + axis + probe.force_angle)
            s = math.sin(yaw + axis + probe.force_angle)
            wanted = probe.speed * min((t - DRAG_START) / DRAG_RAMP, 1.0)
            drag = DRAG_DAMPING * (wanted - (c * vx + s * vy))
            # the tip goes round with the object: what turns the hand's own mass is not
            # felt by the object
            out[0] += drag * c - self.inertia * w * vy
            out[1] += drag * s + self.inertia * w * vx
        return out
