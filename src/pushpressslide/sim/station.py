"""The station: a scene as one Diagram with the inputs and outputs of a robot's
controller.

Its input ports ``joint_torque_<i>`` take joint torques (n,) [N m]. The plant's state
and the tips' force sensors are read directly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.control.knocker import NAME
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.true_task import true_plan
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.mechanics.ground import is_uneven
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.force_sensor import ForceSensor
from pushpressslide.sim.scenes import DrakeScene, build_scene, rest_height
from pushpressslide.sim.uneven_ground import UnevenGround, refuse_ground


class LiveView(Protocol):
    """A live view of a scene during simulation, which has no effect on it."""

    def connect(self, builder: DiagramBuilder, scene: DrakeScene) -> None:
        """Show the bodies of ``scene``, whose builder is not built yet."""

    def pace(self, simulator: Simulator) -> None:
        """Slow the simulation down to real time."""


class Station:
    """A built scene with its simulator, and direct access to its ports."""

    def __init__(
        self,
        plan: Plan,
        *,
        models: str = "generated",
        time_step: float | None = None,
        view: LiveView | None = None,
        convex: bool = False,
        seed: int = 0,
    ) -> None:
        """Build the true scene of ``plan``'s task with the object at its TRUE start.

        ``view`` shows the scene while it is simulated, ``convex`` is as in
        ``solve_contacts``. ``seed`` draws the true world. Raises TaskError for a
        ``truth`` that Drake does not have.
        """
        refuse_ground(plan.task)
        plan = true_plan(plan, seed)
        self.scene = build_scene(
            plan, models=models, time_step=time_step, convex=convex
        )
        self.plant = self.scene.plant
        self._export_ports()
        if view is not None:
            view.connect(self.scene.builder, self.scene)
        self.diagram = self.scene.builder.Build()
        self.diagram.set_name("station")
        self.simulator = Simulator(self.diagram)
        if view is not None:
            view.pace(self.simulator)
        self.context = self.simulator.get_mutable_context()
        self.plant_context = self.plant.GetMyMutableContextFromRoot(self.context)
        task = plan.task
        X_WG = rigid_transform(
            plan.true_start, rest_height(task.object), task.support.frame
        )
        self.plant.SetFreeBodyPose(self.plant_context, self.scene.object, X_WG)
        arms = range(len(self.scene.robots))
        torques = [self.diagram.GetInputPort(f"joint_torque_{i}") for i in arms]
        self._sensors = [ForceSensor(self.plant, robot) for robot in self.scene.robots]
        self._velocities = [
            np.array([joint.velocity_start() for joint in robot.joints(self.plant)])
            for robot in self.scene.robots
        ]
        self._ground = None
        if is_uneven(task.truth):
            self._ground = UnevenGround(task, seed, self.scene, self.context)
        self._reactions = self.plant.get_reaction_forces_output_port()
        self._accelerations = self.plant.get_generalized_acceleration_output_port()
        self._inputs = [
            port.FixValue(self.context, np.zeros(port.size())) for port in torques
        ]
        # the vectors in these ports
        self._torques = [
            value.GetMutableData().get_mutable_value() for value in self._inputs
        ]

    def _export_ports(self) -> None:
        """Name the diagram's ports."""
        builder = self.scene.builder
        plant = self.plant
        for i, robot in enumerate(self.scene.robots):
            instance = robot.model_instance
            torque = plant.get_actuation_input_port(instance)
            builder.ExportInput(torque, f"joint_torque_{i}")

    def disturb(self, x: Sequence[float], pose: Pose2, time: float) -> None:
        """Apply the disturbances for one control period, and the support's friction
        under the object. ``x`` is the plant's state, ``pose`` the object's X_WG.
        """
        if self._ground is not None:
            self._ground.update(x, pose, time)
        disturbances = self.scene.disturbances
        if disturbances is not None:
            port = self.diagram.GetInputPort(NAME)
            disturbances.step(port, self.context, x, pose, time)

    def put(self, bodies: Mapping[str, tuple[float, ...]]) -> None:
        """Set the poses of bodies by name: "object", or movable obstacles.

        Each pose (7,) is a quaternion (w, x, y, z) and a position [m].
        """
        every = {"object": self.scene.object, **self.scene.bodies}
        for name, positions in bodies.items():
            context = self.plant_context
            first = every[name].floating_positions_start()
            q = self.plant.GetPositions(context)
            q[first : first + 7] = positions
            self.plant.SetPositions(context, q)

    def take_over(self, other: Station) -> None:
        """Continue from the state and torques of another station with the same scene."""
        self.context.SetTime(other.context.get_time())
        self.plant.SetPositionsAndVelocities(self.plant_context, other.state_vector())
        for i, torque in enumerate(other._torques):
            self.set_torque(i, torque.CopyToVector())
        self.simulator.Initialize()

    def state_vector(self) -> Array:
        """A copy of the plant's state: all positions, then all velocities."""
        x: Array = self.plant.GetPositionsAndVelocities(self.plant_context)
        return x

    def contact_force(self, i: int, arm: ArmDynamics) -> Vector3:
        """Measured force [N] of the tip of arm ``i`` ON the body it touches, in world
        axes. ``arm`` is the arm's current state.
        """
        reactions = self._reactions.Eval(self.plant_context)
        vdot = self._accelerations.Eval(self.plant_context)
        sensor = self._sensors[i]
        acceleration = arm.J[3:] @ vdot[self._velocities[i]] + arm.drift[3:]
        reaction = reactions[sensor.joint]
        return sensor.force(reaction, arm.rotation, acceleration)

    def set_torque(self, i: int, torque: Array) -> None:
        """Write the joint torques [N m] of arm ``i`` until the next call."""
        # a third of the time of fixing the port again; the call tells Drake of the change
        self._inputs[i].GetMutableData()
        self._torques[i].SetFromVector(torque)
