"""Drake's hydroelastic simulation as a cell: torque-driven arms, and quantities that
only a simulator knows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from pushpressslide.arms.arm_cell import arm_cell, lost_object
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.joint_arms import joint_arms
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.placements import ArmPlacements
from pushpressslide.control.cell import Cell, TrueState
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.spatial_pose import tilt_of
from pushpressslide.core.state import WorldState
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.arm_model import DrakeArmModel
from pushpressslide.sim.convert import planar_pose_from_positions, planar_twist
from pushpressslide.sim.station import Station


def drake_cell(
    plan: Plan,
    station: Station,
    paths: Sequence[tuple[ArmPath, ...]],
    models: str = "generated",
    options: RunOptions | None = None,
    spare: Callable[[], Station] | None = None,
) -> Cell:
    """Cell with the arms of ``station`` at the start of the first of ``paths``, or with
    arms and bodies in the state in which a run with these ``options`` begins.

    There is one set of joint paths for each placement. ``spare`` makes a station that
    takes over if the solver of ``station`` does not converge.
    """
    options = options or RunOptions()
    physics = DrakePhysics(plan, station, spare)
    drives = [DrakeDrives(physics, i) for i in range(len(station.scene.robots))]
    make_model = partial(DrakeArmModel, models=models)
    arms = joint_arms(plan, make_model, drives, options)
    placements = ArmPlacements(DRAKE, arms, paths, station.scene.bounds)
    physics.facts["models"] = models
    return arm_cell("drake", physics, arms, placements, paths, plan, options.begin)


class DrakePhysics:
    """A station as clock, tracker and source of the true state."""

    simulated = True

    def __init__(
        self,
        plan: Plan,
        station: Station,
        spare: Callable[[], Station] | None = None,
    ) -> None:
        """Start the simulation of a station. ``spare`` makes another one, as in
        ``drake_cell``.
        """
        task = plan.task
        query = plan.query
        plant = station.plant
        self.station = station
        self.frame = task.support.frame
        self._ends = (query.start, task.goal)
        self._edged = task.support.region is not None
        self._period = query.motion.control_period
        self._spare = spare
        moved = station.scene.object
        self._body = moved.floating_positions_start()
        velocity = moved.floating_velocities_start_in_v()
        self._body_velocity = plant.num_positions() + velocity
        self._body_rows = {"object_pose_3d": self._body} | {
            f"body_{name}": body.floating_positions_start()
            for name, body in station.scene.bodies.items()
        }
        self.facts: dict[str, Any] = {
            "time_step": plant.time_step(),
            "control_period": self._period,
        }
        disturbances = station.scene.disturbances
        if disturbances is not None and disturbances.pushes:
            self.facts["pushed"] = disturbances.pushes.times
        self._ticks = 0
        self._failure: str | None = None

    def put(self, arms: Sequence[JointArm], start: WorldState | None) -> None:
        """Put ``arms`` at the start of their joint paths, or arms and bodies as in
        ``start``, and start the simulation.
        """
        station = self.station
        plant = station.plant
        context = station.plant_context
        instances = [robot.model_instance for robot in station.scene.robots]
        for instance, arm in zip(instances, arms, strict=True):
            plant.SetPositions(context, instance, arm.start)
        if start is not None:
            for instance, speed in zip(instances, start.speeds, strict=True):
                plant.SetVelocities(context, instance, np.array(speed))
            station.put(start.spatial)
        station.simulator.Initialize()
        self._arms = arms
        self._look()
        self._before = self.now

    def _look(self) -> None:
        """Read the plant's state."""
        self.state = self.station.state_vector()  # (nq + nv,)
        x = self.state.tolist()
        pose = planar_pose_from_positions(x[self._body : self._body + 7], self.frame)
        self.now = _Instant(x, pose)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._ticks * self._period

    def read(self) -> StampedPose:
        """The object's pose."""
        return StampedPose(self.time, self.now.X_WG)

    def advance(self) -> None:
        """Simulate one control period."""
        self._before = self.now
        self.station.disturb(self.now.x, self.now.X_WG, self.time)
        self._ticks += 1
        complaint = self._complaint()
        if complaint is not None and self._spare is not None:
            other = self.station
            self.station = self._spare()
            self.station.take_over(other)
            self._spare = None
            self.facts["convex_from"] = other.context.get_time()
            complaint = self._complaint()
        self._failure = complaint
        self._look()

    def _complaint(self) -> str | None:
        """Simulate to the end of the control period. Return the simulator's failure, or
        None.
        """
        try:
            self.station.simulator.AdvanceTo(self._ticks * self._period)
        except RuntimeError as error:
            if _raised_in_python(error):
                raise
            return str(error).splitlines()[0]
        return None

    def failure(self) -> str | None:
        """Reason why the simulation cannot continue, or None.

        At the start of the last tick the object was far away, had fallen or tipped
        over, or the simulator has reported a failure.
        """
        x, pose = self._before
        height = None
        if self._edged:
            px, py, pz = x[self._body + 4 : self._body + 7]
            height = self.frame.coordinates((px, py, pz))[2]
        w, qx, qy, qz = x[self._body : self._body + 4]
        tilt = tilt_of((w, qx, qy, qz), self.frame)
        lost = lost_object(sum(x), pose, self._ends, height, tilt)
        return lost or self._failure

    def observe(self) -> TrueState:
        """True state of the last completed tick."""
        x, pose = self._before
        start = self._body_velocity
        twist = planar_twist(x[start : start + 6], self.frame)
        tips = tuple(arm.true_tip for arm in self._arms)
        return TrueState(pose, tips, twist, extras=partial(self._body_poses, x))

    def _body_poses(self, x: Sequence[float]) -> dict[str, Any]:
        """Rows of the arrays that only this simulation records, for the state ``x``."""
        return {name: x[start : start + 7] for name, start in self._body_rows.items()}


class _Instant(NamedTuple):
    """True poses and velocities at one time."""

    x: list[float]  # state of the plant
    X_WG: Pose2


class DrakeDrives:
    """Encoders, force sensor and motors of an arm in a station."""

    def __init__(self, physics: DrakePhysics, index: int) -> None:
        """Attach to the drives of the arm number ``index``."""
        self._physics = physics
        self._index = index
        robot = physics.station.scene.robots[index]
        self._joints = _joints_of(physics.station.plant, robot.model_instance)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._physics.time

    def joints(self) -> Array:
        """Joint positions [rad] and velocities [rad/s], (2 n,)."""
        return self._physics.state[self._joints]

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        """Force [N] of the tip ON the body it touches, in world axes."""
        return self._physics.station.contact_force(self._index, arm)

    def drive(self, torque: Array) -> None:
        """Apply joint torques (n,) [N m] until the next call."""
        self._physics.station.set_torque(self._index, torque)


def _joints_of(plant: MultibodyPlant, instance: ModelInstanceIndex) -> NDArray[np.intp]:
    """Indices of an arm's joint positions, followed by its joint velocities, in the
    plant's state.
    """
    joints = [plant.get_joint(j) for j in plant.GetJointIndices(instance)]
    moving = [joint for joint in joints if joint.num_positions() == 1]
    positions = [joint.position_start() for joint in moving]
    first = plant.num_positions()
    return np.array([*positions, *(first + joint.velocity_start() for joint in moving)])


def _raised_in_python(error: BaseException) -> bool:
    """Whether ``error`` was raised by Python code below the handler, and not by the
    simulator.

    The simulator calls systems written in Python.
    """
    here = error.__traceback__
    return here is not None and here.tb_next is not None
