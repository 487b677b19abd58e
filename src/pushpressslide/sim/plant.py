"""Drake's hydroelastic simulation as a plant: reads the station's ports, turns commands
into joint torques, and keeps what only this plant records.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from pushpressslide.arms.model import at_rest
from pushpressslide.arms.paths.approach import led_in
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.placements import PlacementPaths
from pushpressslide.arms.torque_arm import ArmRow, TorqueArm
from pushpressslide.control.approach import SETTLE
from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.control.plant import PlantRow
from pushpressslide.core.control import Commands, Measurement, TipState
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Task
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.sim.arm_model import DrakeArmModel
from pushpressslide.sim.convert import planar_pose_from_positions, planar_twist
from pushpressslide.sim.station import Station

TOUCH_AND_RELEASE = 4.0  # [s] typical time of both, for the progress
FALLEN = "the object has fallen over the edge of support.region"
FAR = 2.0  # [m] from start and goal: the simulation has diverged


class DrakePlant:
    """A station with its arms, driven by joint torques."""

    name = "drake"

    def __init__(
        self,
        plan: Plan,
        station: Station,
        paths: Sequence[tuple[ArmPath, ...]],
        models: str,
        begin: WorldState | None = None,
        spare: Callable[[], Station] | None = None,
        joint_stiffness: float = 0.0,
    ) -> None:
        """Put the arms of ``station`` where the first of ``paths`` begins, or arms and
        bodies as ``begin`` has them.

        There is one set of joint paths for each placement. ``spare`` makes a station
        that takes over where the solver of ``station`` does not converge;
        ``joint_stiffness`` [N m/rad] is as of ``control.execution.Execution``.
        """
        task = plan.task
        query = plan.query
        plant = station.plant
        self._ends = (query.start, task.goal)
        self._edged = task.support.region is not None
        self._frame = task.support.frame
        self._period = query.motion.control_period
        self._station = station
        self._spare = spare
        self._paths = paths
        self._prepared = PlacementPaths(DRAKE)  # of what is ahead
        self._prepared.paths = list(paths[1:])
        self._arms = [
            TorqueArm(
                DrakeArmModel(robot, models=models), robot.tip_radius, joint_stiffness
            )
            for robot in task.robots
        ]
        self._instances = [robot.model_instance for robot in station.scene.robots]
        self._joints = [_joints_of(plant, instance) for instance in self._instances]
        self._follow(task, paths[0], begin)
        if begin is not None:
            station.put(begin.spatial)
        moved = station.scene.object
        self._body = moved.floating_positions_start()
        velocity = moved.floating_velocities_start_in_v()
        self._body_velocity = plant.num_positions() + velocity
        self._body_rows = {"object_pose_3d": self._body} | {
            f"body_{name}": body.floating_positions_start()
            for name, body in station.scene.bodies.items()
        }
        self._facts = self._run_facts(models)
        approaches = sum(map(_longest_approach, paths))
        self.overhead = TOUCH_AND_RELEASE * len(plan.placements) + approaches
        self._ticks = 0
        self._executing = 0.0  # [s] of wall time in this tick
        self._failure: str | None = None
        station.simulator.Initialize()

    def _follow(
        self, task: Task, taken: tuple[ArmPath, ...], begin: WorldState | None
    ) -> None:
        """Put the arms where their joint paths begin; arms that are elsewhere are led
        there first.
        """
        paths = [path for path, _ in taken]
        if begin is not None:
            facts = [arm.model.facts for arm in self._arms]
            paths = led_in(paths, facts, [np.array(q) for q in begin.joints])
        plant = self._station.plant
        context = self._station.plant_context
        for i, (path, (_, attitude)) in enumerate(zip(paths, taken, strict=True)):
            self._arms[i].follow(task, path, attitude)
            plant.SetPositions(context, self._instances[i], path.approach[0])
        if begin is not None:
            for instance, speed in zip(self._instances, begin.speeds, strict=True):
                plant.SetVelocities(context, instance, np.array(speed))

    def _run_facts(self, models: str) -> dict[str, Any]:
        every = [path for placement in self._paths for path, _ in placement]
        return {
            "time_step": self._station.plant.time_step(),
            "control_period": self._period,
            "joint_margin_planned": min(path.joint_margin for path in every),
            "condition_planned": max(path.condition for path in every),
            "clearance_planned": min(path.clearance for path in every),
            "approach_time": _longest_approach(self._paths[0]) + SETTLE,
            "models": models,
            "start_tips": [
                arm.model.state_at(at_rest(arm.path.approach[-1])).position
                for arm in self._arms
            ],
        }

    @property
    def meta(self) -> Mapping[str, Any]:
        """Time step, and margins of the joint paths."""
        return self._facts

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._ticks * self._period

    @property
    def joint_paths(self) -> tuple[JointPath, ...]:
        """The joint path of each arm in this placement."""
        return tuple(arm.path for arm in self._arms)

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        """The makers' limits of each arm's joints."""
        return tuple(arm.limits for arm in self._arms)

    def readings(self) -> tuple[ArmReading, ...]:
        """Return each arm's joints at the last measurement, and what was asked before."""
        return tuple(arm.reading for arm in self._arms)

    def measure(self) -> Measurement:
        """Return the object's pose, and each tip's state and contact force."""
        station = self._station
        frame = self._frame
        x = station.state_vector()
        began = perf_counter()
        for arm, joints in zip(self._arms, self._joints, strict=True):
            arm.sense(x[joints])
        self._executing = perf_counter() - began
        states = [arm.state for arm in self._arms]
        forces = station.contact_forces(states)
        tips = (
            TipState(
                frame.coordinates(state.position),
                frame.components(state.velocity),
                frame.components(force),
            )
            for state, force in zip(states, forces, strict=True)
        )
        self._x = x.tolist()
        pose = planar_pose_from_positions(self._x[self._body : self._body + 7], frame)
        self._truth = Measurement(self.time, pose, tuple(tips))
        return self._truth

    def apply(self, commands: Commands) -> None:
        """Write the joint torques that execute the commands."""
        began = perf_counter()
        for arm, command in zip(self._arms, commands, strict=True):
            arm.execute(command)
        for i, arm in enumerate(self._arms):
            self._station.set_torque(i, arm.torque)
        self._executing += perf_counter() - began

    def advance(self) -> None:
        """Simulate one control period."""
        self._station.disturb(self._x, self._truth.object_pose, self.time)
        self._ticks += 1
        complaint = self._complaint()
        if complaint is not None and self._spare is not None:
            other = self._station
            self._station = self._spare()
            self._station.take_over(other)
            self._spare = None
            self._facts["convex_from"] = other.context.get_time()
            complaint = self._complaint()
        self._failure = complaint

    def _complaint(self) -> str | None:
        """Simulate to the end of the control period; return what the simulator complains
        of.
        """
        try:
            self._station.simulator.AdvanceTo(self._ticks * self._period)
        except RuntimeError as error:
            if _raised_in_python(error):
                raise
            return str(error).splitlines()[0]
        return None

    def row(self) -> PlantRow:
        """Return what is recorded of the tick that the last measurement began."""
        arms = [arm.row() for arm in self._arms]
        start = self._body_velocity
        twist = planar_twist(self._x[start : start + 6], self._frame)
        forces = tuple(tip.force for tip in self._truth.tips)
        extras = partial(self._extras, self._x, self._truth.tips, arms)
        return PlantRow(twist, forces, self._executing, extras)

    def _extras(
        self, x: Sequence[float], tips: Sequence[TipState], arms: Sequence[ArmRow]
    ) -> dict[str, Any]:
        """Return the rows of the arrays that this plant alone has, from the plant's
        state ``x`` and what tips and arms did.
        """
        rows: dict[str, Any] = {}
        for i, arm in enumerate(arms):
            rows |= arm.arrays(i)
        rows["contact_point"] = [
            arm.contact_point(tip) for arm, tip in zip(self._arms, tips, strict=True)
        ]
        for name, start in self._body_rows.items():
            rows[name] = x[start : start + 7]
        return rows

    def diverged(self) -> str | None:
        """Return why the simulation cannot go on, or None.

        The object was far away or had fallen at the last measurement, or the simulator
        complained.
        """
        pose = self._truth.object_pose
        off = min(math.dist(pose.position, end.position) for end in self._ends)
        if not math.isfinite(sum(self._x)) or off > FAR:
            return f"the object is at ({pose.x:.2f}, {pose.y:.2f})"
        if self._edged:
            place = self._x[self._body + 4 : self._body + 7]
            if self._frame.coordinates((place[0], place[1], place[2]))[2] < 0.0:
                return f"{FALLEN} at ({pose.x:.2f}, {pose.y:.2f})"
        return self._failure

    def prepare(self) -> PlacementPaths:
        """Return a preparation of joint paths from where the arms were at the last
        measurement, of motions within the support's bounds.
        """
        postures = tuple(arm.state.q for arm in self._arms)
        self._prepared = PlacementPaths(
            DRAKE, postures=postures, within=self._station.scene.bounds
        )
        return self._prepared

    def hand_over(self, placement: Plan, lasting: frozenset[int]) -> None:
        """Take the next joint paths, with a motion before them that leads each arm from
        where it was at the last measurement to where its path begins.
        """
        taken = self._prepared.paths.pop(0)
        paths = led_in(
            [path for path, _ in taken],
            [arm.model.facts for arm in self._arms],
            [arm.state.q for arm in self._arms],
        )
        for arm, path, (_, attitude) in zip(self._arms, paths, taken, strict=True):
            arm.follow(placement.task, path, attitude)


def _joints_of(plant: MultibodyPlant, instance: ModelInstanceIndex) -> NDArray[np.intp]:
    """Where the positions, then the velocities, of an arm's joints are in the plant's
    state.
    """
    joints = [plant.get_joint(j) for j in plant.GetJointIndices(instance)]
    moving = [joint for joint in joints if joint.num_positions() == 1]
    positions = [joint.position_start() for joint in moving]
    first = plant.num_positions()
    return np.array([*positions, *(first + joint.velocity_start() for joint in moving)])


def _raised_in_python(error: BaseException) -> bool:
    """Return whether Python code below the handler raised ``error``, not the simulator.

    The simulator calls systems that are written in Python.
    """
    here = error.__traceback__
    return here is not None and here.tb_next is not None


def _longest_approach(paths: tuple[ArmPath, ...]) -> float:
    return max(float(path.approach_time[-1]) for path, _ in paths)
