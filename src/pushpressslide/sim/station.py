"""The station: a scene as one Diagram with a port for everything that a robot's
controller reads or writes.

Inputs   joint_torque_<i>    (n,) [N m]
Outputs  joint_state_<i>     (2 n,) positions, velocities
         contact_force_<i>   (3,) [N] of tip i ON what it touches, in world axes; from a
                             force sensor in the tip's mount, less the tip's weight
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder, LeafSystem

from pushpressslide.core.arrays import Array
from pushpressslide.core.knock import Knock
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.knock import NAME
from pushpressslide.sim.robot_models import RobotInstance
from pushpressslide.sim.scenes import build_scene, rest_height

if TYPE_CHECKING:
    from pushpressslide.sim.view.live import LiveView


class ContactForceSensor(LeafSystem):
    """Computes the force of a tip on what it touches from the reaction in its mount."""

    def __init__(self, plant: MultibodyPlant, robot: RobotInstance) -> None:
        """Read joint and body indices off the finalized plant."""
        super().__init__()
        joint = plant.GetJointByName(robot.tip_joint_name, robot.model_instance)
        # reaction forces are listed by ordinal: the joint's place among all joints
        self._joint = plant.GetJointIndices().index(joint.index())
        self._tip = int(robot.tip_body.index())
        self._weight = (
            robot.tip_body.default_mass() * plant.gravity_field().gravity_vector()
        )
        self._R_TJ = (
            joint.frame_on_child().GetFixedPoseInBodyFrame().rotation().matrix()
        )
        self._reactions = self.DeclareAbstractInputPort(
            "reaction_forces", Value[list[SpatialForce]]([])
        )
        self._poses = self.DeclareAbstractInputPort(
            "body_poses", Value[list[RigidTransform]]([])
        )
        self.DeclareVectorOutputPort("force", 3, self._calc)

    def _calc(self, context: Context, output: Any) -> None:
        reaction = self._reactions.Eval(context)[self._joint].translational()
        R_WT = self._poses.Eval(context)[self._tip].rotation().matrix()
        # at slow speeds, mount on tip + weight + contact on tip = 0; the tip's inertia
        # is neglected
        output.SetFromVector(R_WT @ (self._R_TJ @ reaction) + self._weight)


def add_force_sensor(
    builder: DiagramBuilder, plant: MultibodyPlant, robot: RobotInstance
) -> ContactForceSensor:
    """Add and connect the force sensor of a robot's tip."""
    sensor = builder.AddSystem(ContactForceSensor(plant, robot))
    reactions = plant.get_reaction_forces_output_port()
    builder.Connect(reactions, sensor.GetInputPort("reaction_forces"))
    poses = plant.get_body_poses_output_port()
    builder.Connect(poses, sensor.GetInputPort("body_poses"))
    return sensor


class Station:
    """A built scene with its simulator, and direct access to its ports."""

    def __init__(
        self,
        plan: Plan,
        *,
        models: str = "generated",
        time_step: float | None = None,
        view: LiveView | None = None,
        knock: Knock | None = None,
    ) -> None:
        """Build the scene of ``plan``'s task with the object at its TRUE start.

        ``view`` shows the scene while it is simulated; ``knock`` disturbs it.
        """
        self.scene = build_scene(plan, models=models, time_step=time_step, knock=knock)
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
            task.true_start, rest_height(task.object), task.support.frame
        )
        self.plant.SetFreeBodyPose(self.plant_context, self.scene.object, X_WG)
        arms = range(len(self.scene.robots))
        self._torques = [self.diagram.GetInputPort(f"joint_torque_{i}") for i in arms]
        self._forces = [self.diagram.GetOutputPort(f"contact_force_{i}") for i in arms]
        for port in self._torques:
            port.FixValue(self.context, np.zeros(port.size()))

    def _export_ports(self) -> None:
        """Add a force sensor to each robot, and name the diagram's ports."""
        builder = self.scene.builder
        plant = self.plant
        for i, robot in enumerate(self.scene.robots):
            instance = robot.model_instance
            torque = plant.get_actuation_input_port(instance)
            builder.ExportInput(torque, f"joint_torque_{i}")
            state = plant.get_state_output_port(instance)
            builder.ExportOutput(state, f"joint_state_{i}")
            sensor = add_force_sensor(builder, plant, robot)
            builder.ExportOutput(sensor.GetOutputPort("force"), f"contact_force_{i}")

    def disturb(self, x: Array, pose: Pose2, time: float) -> None:
        """Let what knocks the object do so for a control period; ``x`` is the plant's
        state, ``pose`` the object's X_WG.
        """
        knocker = self.scene.knocker
        if knocker is not None:
            port = self.diagram.GetInputPort(NAME)
            knocker.step(port, self.context, x, pose, time)

    def put(self, bodies: Mapping[str, Array]) -> None:
        """Put bodies, "object" or movable obstacles by name, where they are: quaternion
        (w, x, y, z) and position [m] (7,) each.
        """
        every = {"object": self.scene.object, **self.scene.bodies}
        for name, positions in bodies.items():
            context = self.plant_context
            first = every[name].floating_positions_start()
            q = self.plant.GetPositions(context)
            q[first : first + 7] = positions
            self.plant.SetPositions(context, q)

    def state_vector(self) -> Array:
        """Return a copy of the plant's discrete state: all positions, then all
        velocities.
        """
        return self.plant_context.get_discrete_state_vector().CopyToVector()

    def contact_force(self, i: int) -> tuple[float, float, float]:
        """Return the measured force [N] of tip ``i`` ON what it touches, world axes."""
        f = self._forces[i].Eval(self.context)
        return (float(f[0]), float(f[1]), float(f[2]))

    def set_torque(self, i: int, torque: Array) -> None:
        """Write the joint torques [N m] of arm ``i`` until the next call."""
        self._torques[i].FixValue(self.context, torque)
