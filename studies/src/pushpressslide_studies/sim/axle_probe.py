"""Open-loop probe of a pressed object's virtual axle.

A free tip presses on top and drags the object with a force of constant direction in the
body frame. There is no steering: a servo only sets the size of the force, so that the
object slides at constant speed. The object's twist then determines the position of the
virtual axle (docs/mechanics.md, section 4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.support_frame import TABLE
from pushpressslide.core.task import Robot, Task
from pushpressslide.mechanics.surface_friction import SurfaceFrictions
from pushpressslide.sim.contact import solve_contacts
from pushpressslide.sim.convert import planar_pose_from_positions, rigid_transform
from pushpressslide.sim.force_sensor import ForceSensor
from pushpressslide.sim.plane import add_plane
from pushpressslide.sim.robot_models import add_robot
from pushpressslide.sim.scenes import (
    add_object,
    object_modulus,
    rest_height,
    tip_properties,
)

START = Pose2(0.013, 0.017, 0.2)  # X_WG
GAP = 1e-4  # [m] from the tip to the object at the start
PRESS_RAMP = 0.3  # [s] of the load
DRAG_START = 0.4  # [s]
DRAG_RAMP = 0.3  # [s] of the wanted speed
SETTLED = 1.8  # [s] when the measurement begins
END = 3.0  # [s]
DRAG_DAMPING = 500.0  # [N s/m] of the servo along the force
LIFT_DAMPING = 20.0  # [N s/m] of the tip's vertical motion
# [1/s] at which the hand's turn rate comes to the object's: a tip that lags holds the
# object back by its friction, with more than the drag's moment where the body is light
YAW_RATE = 100.0
YAW_DAMPING = 1.0  # [N m s/rad] of the hand's yaw, if it is held
YAW_STIFFNESS = 50.0  # [N m/rad] of the hand's yaw, if it is held
LEAST_TURN_RATE = 2e-3  # [rad/s] slower turns do not define an axle


@dataclass(frozen=True, slots=True)
class Probe:
    """One drag: contact, load, and direction of the force."""

    contact: Point  # [m] in B
    load: float  # [N]
    force_angle: float  # [rad] of the drag, from the line CoM to contact, constant in B
    speed: float = 0.05  # [m/s] wanted speed of the tip along the drag
    cells: float = 12.0  # across the base where it is narrow: more than in a run
    # hold the hand's yaw; else it turns with the object, which removes spin friction
    hold_yaw: bool = False


@dataclass(frozen=True, slots=True)
class AxleMeasurement:
    """Result of a probe: medians over the steady part of the run."""

    # [m] on the line CoM to contact: 0 at the CoM, positive towards the contact
    axle: float
    axle_band: tuple[float, float]  # [m] 5th and 95th percentile over time
    turn_rate: float  # [rad/s]
    speed: float  # [m/s] of the CoM
    force_angle: float  # [rad] of the measured contact force
    force: float  # [N] along the support
    load: float  # [N]
    friction_use: float  # largest utilisation of the tip's friction
    slip: float  # [m] largest displacement of the tip on the object


def probe_axle(task: Task, probe: Probe, time_step: float = 0.004) -> AxleMeasurement:
    """Drag the object of ``task`` as in ``probe`` and return the measured centre of
    rotation.

    Of the task, only the object and the two frictions are used; the robot is a free
    ``hand``. Raises SimulationError if the object did not turn.
    """
    rows = _Rig(task, probe, time_step).run()
    vx = rows[:, 0]
    vy = rows[:, 1]
    w = rows[:, 2]
    x, y = probe.contact
    size = math.hypot(x, y)
    ex = x / size
    ey = y / size
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
    slip = np.hypot(rows[:, 6] - x, rows[:, 7] - y)
    return AxleMeasurement(
        float(np.median(axle)),
        (float(low), float(high)),
        turn_rate,
        float(np.median(np.hypot(vx, vy))),
        float(np.arctan2(np.median(across), np.median(along))),
        float(np.median(shear)),
        float(np.median(load)),
        float(np.max(shear / load)) / task.contact_friction,
        float(slip.max()),
    )


class _Rig:
    """The object on its support, with a free tip on top.

    The scene is that of a run, except for the cells of the object's base.
    """

    def __init__(self, task: Task, probe: Probe, time_step: float) -> None:
        self.probe = probe
        self.dt = time_step
        body = task.object
        self.center = body.center_of_mass
        self.contact_G = body.X_GB.apply(probe.contact)
        hand = Robot("hand", (0.0, 0.0, 0.0), tip_radius=task.robots[0].tip_radius)
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
        self._plant = plant
        solve_contacts(plant)
        frictions = SurfaceFrictions.of_task(task)
        shape = body.shape
        self._object = add_object(plant, body, frictions.object, object_modulus(task))
        plane = add_plane(plant, TABLE, frictions.support)
        plane.stand(plant, self._object, shape, frictions.object, probe.cells)
        tip = tip_properties(hand, frictions)
        self._hand = add_robot(plant, hand, 0, tip_properties=tip)
        plant.Finalize()
        plane.let_bases_stand(plant, scene_graph)
        self.sensor = ForceSensor(plant, self._hand)
        torque = plant.get_actuation_input_port(self._hand.model_instance)
        builder.ExportInput(torque, "torque")
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        self.context = self.simulator.get_mutable_context()
        self.state = plant.GetMyMutableContextFromRoot(self.context)
        self.torque = diagram.GetInputPort("torque")
        X_WG = rigid_transform(START, rest_height(body))
        plant.SetFreeBodyPose(self.state, self._object, X_WG)
        self.home = self._place_hand(body.shape.height + hand.tip_radius + GAP)
        self._read_layout()

    def _place_hand(self, height: float) -> Array:
        """Put the tip's centre at ``height`` [m] over the contact. Return the joint
        positions (4,).
        """
        instance = self._hand.model_instance
        x, y = START.apply(self.contact_G)
        self._plant.SetPositions(self.state, instance, np.zeros(4))
        tip = self._hand.tip_frame.CalcPoseInWorld(self.state).translation()
        home = np.array([x - tip[0], y - tip[1], height - tip[2], 0.0])
        self._plant.SetPositions(self.state, instance, home)
        return home

    def _read_layout(self) -> None:
        """Read the indices of positions and velocities in the plant's state, and the
        hand's weight and inertia.
        """
        plant = self._plant
        self.reactions = plant.get_reaction_forces_output_port()
        self.accelerations = plant.get_body_spatial_accelerations_output_port()
        v0 = plant.num_positions()
        joints = self._hand.joints(plant)
        v = np.array([joint.velocity_start() for joint in joints])
        self.hand_q = np.array([joint.position_start() for joint in joints])
        self.hand_v = v0 + v
        self.object_q = self._object.floating_positions_start()
        self.object_v = v0 + self._object.floating_velocities_start_in_v()
        self.weight = -plant.CalcGravityGeneralizedForces(self.state)[v]
        # [kg] along the support
        mass = plant.CalcMassMatrix(self.state)
        self.inertia = float(mass[v[0], v[0]])
        self.yaw_inertia = float(mass[v[3], v[3]])  # [kg m^2]

    def run(self) -> Array:
        """Rows (N, 8) of the steady part, in B: the CoM's velocity and turn rate, the
        contact force along the support, the load, and the tip's position.
        """
        rows = []
        cx, cy = self.center
        start = START.apply(self.contact_G)
        self.simulator.Initialize()
        for i in range(round(END / self.dt)):
            x = self.state.get_discrete_state_vector().CopyToVector()
            pose = planar_pose_from_positions(
                x[self.object_q : self.object_q + 7].tolist()
            )
            w, vx, vy = (float(x[self.object_v + k]) for k in (2, 3, 4))
            if i * self.dt >= SETTLED:
                fx, fy, fz = self._force()
                moved = x[self.hand_q] - self.home
                tx, ty = pose.unapply((start[0] + moved[0], start[1] + moved[1]))
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

    def _force(self) -> Vector3:
        """Force [N] of the tip ON the object, in world axes."""
        tip = self._hand.tip_body
        reaction = self.reactions.Eval(self.state)[self.sensor.joint]
        moved = self.accelerations.Eval(self.state)[tip.index()].translational()
        R_WT = self._plant.EvalBodyPoseInWorld(self.state, tip).rotation().matrix()
        return self.sensor.force(reaction, R_WT, moved)

    def _torque(self, t: float, x: Array, yaw: float, w: float) -> Array:
        """Forces [N] and torque [N m] of the hand's joints at time ``t`` [s]."""
        probe = self.probe
        vx, vy, vz, turn = x[self.hand_v]
        out = self.weight.copy()
        out[2] -= probe.load * min(t / PRESS_RAMP, 1.0) + LIFT_DAMPING * vz
        if probe.hold_yaw:
            out[3] -= (
                YAW_STIFFNESS * (x[self.hand_q[3]] - self.home[3]) + YAW_DAMPING * turn
            )
        else:
            out[3] += YAW_RATE * self.yaw_inertia * (w - turn)
        if t > DRAG_START:
            axis = math.atan2(probe.contact[1], probe.contact[0])
            c = math.cos(yaw + axis + probe.force_angle)
            s = math.sin(yaw + axis + probe.force_angle)
            wanted = probe.speed * min((t - DRAG_START) / DRAG_RAMP, 1.0)
            drag = DRAG_DAMPING * (wanted - (c * vx + s * vy))
            # the tip turns with the object: the force that turns the hand's own mass
            # does not act on the object
            out[0] += drag * c - self.inertia * w * vy
            out[1] += drag * s + self.inertia * w * vx
        return out
