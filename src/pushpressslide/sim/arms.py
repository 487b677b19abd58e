"""The joint paths of all arms of a plan, so that two arms keep clear of each other."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.sim.clearance import LOOK
from pushpressslide.sim.joint_path import joint_path
from pushpressslide.sim.robot_models import add_robot

Array = NDArray[np.float64]
ArmPath = tuple[JointPath, ToolAttitude]

APART = 0.005  # [m] least distance of the arms' capsules, which hold the real outline with 1 cm to spare
SAMPLES = 60  # of an approach at which the distance is looked at


def joint_paths(plan: Plan, *, force: bool = False) -> tuple[ArmPath, ...]:
    """Return each arm's joint path and how its tool is held; of two arms that would meet on their way to the
    object one waits for the other.

    ``force`` takes the best there is. Raises InfeasibleTaskError, with the figure that decides, where an arm
    has no path, or two arms come too near to each other.
    """
    paths = tuple(joint_path(plan, arm, force=force) for arm in range(len(plan.task.robots)))
    return paths if len(paths) < 2 else _apart(plan, paths, force)


class GraspPaths:
    """The joint paths of one grasp after the other, each from where the arms let go in the one before."""

    def __init__(self, force: bool = False) -> None:
        """Begin; ``force`` takes the best there is."""
        self._force = force
        self.plans: list[Plan] = []
        self.paths: list[tuple[ArmPath, ...]] = []

    def add(self, grasp: Plan) -> None:
        """Add the plan of one more grasp; raises InfeasibleTaskError as ``joint_paths``."""
        self.paths.append(joint_paths(grasp, force=self._force))
        self.plans.append(grasp)


def all_joint_paths(plan: Plan) -> list[tuple[ArmPath, ...]]:
    """Return the joint paths of every grasp of a plan; raises InfeasibleTaskError as ``joint_paths``."""
    out = GraspPaths()
    for grasp in plan.grasps:
        out.add(grasp)
    return out.paths


def _apart(plan: Plan, paths: tuple[ArmPath, ...], force: bool) -> tuple[ArmPath, ...]:
    pair = _Pair(plan)
    left, right = paths[0][0], paths[1][0]
    least = pair.least(left.move, right.move)
    if least < APART and not force:
        _refuse(plan, "along the contacts", least)
    best = -math.inf
    for delays in ((0.0, 0.0), (0.0, float(left.approach_time[-1])), (float(right.approach_time[-1]), 0.0)):
        waiting = tuple(_after(path, delay) for (path, _), delay in zip(paths, delays, strict=True))
        times = np.linspace(0.0, max(float(path.approach_time[-1]) for path in waiting), SAMPLES)
        ways = [_sampled(path, times) for path in waiting]
        clear = pair.least(ways[0], ways[1])
        best = max(best, clear)
        if clear >= APART or (force and delays[0] > 0.0):
            kept = zip(waiting, paths, strict=True)
            return tuple(
                (replace(path, clearance=min(path.clearance, least, clear)), attitude)
                for path, (_, attitude) in kept
            )
    _refuse(plan, "on the way to the object", best)
    raise AssertionError("refused")


def _refuse(plan: Plan, where: str, least: float) -> None:
    raise InfeasibleTaskError(
        f"{plan.task.source or plan.task.name}: robots: {where} the arms come as near as "
        f"{least * 1e3:.1f} mm to each other, allowed from {APART * 1e3:.0f} mm"
    )


def _after(path: JointPath, delay: float) -> JointPath:
    """The path of an arm that waits ``delay`` [s] at its start."""
    if delay == 0.0:
        return path
    times = np.concatenate([[0.0], path.approach_time + delay])
    return replace(path, approach_time=times, approach=np.concatenate([path.approach[:1], path.approach]))


def _sampled(path: JointPath, times: Array) -> Array:
    """Postures (m, n) of the approach at ``times`` (m,)."""
    return np.column_stack([np.interp(times, path.approach_time, column) for column in path.approach.T])


class _Pair:
    """Two arms with collision capsules, and nothing else."""

    def __init__(self, plan: Plan) -> None:
        builder = DiagramBuilder()
        self._plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        self._arms = [
            add_robot(self._plant, robot, i, collision=True) for i, robot in enumerate(plan.task.robots[:2])
        ]
        self._plant.Finalize()
        manager = scene_graph.collision_filter_manager()
        for arm in self._arms:
            shapes = GeometrySet()
            for index in self._plant.GetBodyIndices(arm.model_instance):
                shapes.Add(self._plant.GetCollisionGeometriesForBody(self._plant.get_body(index)))
            manager.Apply(CollisionFilterDeclaration().ExcludeWithin(shapes))
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._plant_context = self._plant.GetMyMutableContextFromRoot(self._context)
        self._query = self._plant.get_geometry_query_input_port()

    def least(self, left: Array, right: Array) -> float:
        """Return the least distance [m] of the arms, at most LOOK, over postures (k, n) of each."""
        least = LOOK
        for q_left, q_right in zip(left, right, strict=True):
            for arm, q in zip(self._arms, (q_left, q_right), strict=True):
                self._plant.SetPositions(self._plant_context, arm.model_instance, q)
            query = self._query.Eval(self._plant_context)
            found = query.ComputeSignedDistancePairwiseClosestPoints(LOOK)
            least = min([least, *(pair.distance for pair in found)])
        return float(least)
