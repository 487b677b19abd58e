"""A recorded run in its scene, without physics, for replays and pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.geometry import (
    GeometryInstance,
    IllustrationProperties,
    PerceptionProperties,
    Rgba,
    SceneGraph,
    SourceId,
)
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from pushpressslide.core.arrays import Array
from pushpressslide.core.bodies import goal_places
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Shape
from pushpressslide.sim.convert import (
    planar_pose,
    rigid_transform,
    transform_from_positions,
)
from pushpressslide.sim.scenes import build_scene, rest_height
from pushpressslide.sim.surfaces import Bounds, drawn_shape
from pushpressslide.view.drake.lines import (
    GRID_HEIGHT,
    GRID_WIDTH,
    PATH_HEIGHT,
    RIBBON_WIDTH,
    grid_lines,
    leads_somewhere,
    ribbon,
    ribbons,
)

# [m] the goal is drawn lower, so that its top does not coincide with the object's
GOAL_SINK = 1e-3
GOAL_COLOR = Rgba(0.0, 0.62, 0.45, 0.28)
PATH_COLOR = Rgba(0.13, 0.13, 0.13, 1.0)
GRID_COLOR = Rgba(0.70, 0.68, 0.64, 1.0)

Placed = tuple[Shape, Pose2]
"""A shape at a pose X_WG."""


class Playback:
    """The scene of a run, with goal and planned path, at any recorded tick."""

    def __init__(
        self,
        plan: Plan,
        record: Record,
        models: str = "generated",
        goals: Sequence[Placed] = (),
    ) -> None:
        """Build the scene.

        ``goals`` replace the task's own if given. Raises SimulationError for a record
        without joint positions.
        """
        for i in range(len(plan.task.robots)):
            if f"joint_position_{i}" not in record.arrays:
                raise SimulationError(
                    f"the record of engine {record.engine!r} has no joint_position_{i} "
                    "to show"
                )
        self.task = plan.task
        self.plan = plan
        self.record = record
        self.scene = build_scene(plan, models=models)
        task = plan.task
        own = tuple((shape, X_WG) for _, shape, X_WG in goal_places(task))
        self.goals = tuple(goals) or own
        self.placements = plan.by_placement
        self._draw_plan()

    def _draw_plan(self) -> None:
        """Draw shapes at their goals, and one line for each segment of the path."""
        task = self.task
        graph = self.scene.scene_graph
        frame = task.support.frame
        source = graph.RegisterSource("plan")
        opening = task.support.opening
        depth = GOAL_SINK
        if opening is not None and task.scene.enters(task.goal):
            depth = opening.depth
        for i, (shape, X_WG) in enumerate(self.goals):
            X = rigid_transform(X_WG, 0.5 * shape.height - depth, frame)
            goal = GeometryInstance(X, drawn_shape(shape), f"goal_{i}")
            _anchor(graph, source, goal, GOAL_COLOR)
        grid = grid_lines(task.support, self.reached())
        if grid:
            X = rigid_transform(Pose2(), GRID_HEIGHT, frame)
            lines = GeometryInstance(X, ribbons(grid, GRID_WIDTH), "grid")
            _anchor(graph, source, lines, GRID_COLOR)
        X = rigid_transform(Pose2(), PATH_HEIGHT, frame)
        path = self.record.arrays["plan_path"][:, :2]
        segments = self.record.arrays["plan_stretch"]
        for i in np.unique(segments):
            points = path[segments == i]
            if leads_somewhere(points):
                line = ribbon(points, RIBBON_WIDTH)
                drawn = GeometryInstance(X, line, f"path_{i:.0f}")
                _anchor(graph, source, drawn, PATH_COLOR)

    def reached(self) -> Bounds:
        """Bounds x_min, x_max, y_min, y_max [m] of the area that the object covers
        during the run and at its goal.
        """
        poses = self.record.arrays["object_pose"]
        goal = self.task.goal
        x = np.append(poses[:, 0], goal.x)
        y = np.append(poses[:, 1], goal.y)
        size = self.task.object.shape.farthest((0.0, 0.0))
        return (
            float(x.min()) - size,
            float(x.max()) + size,
            float(y.min()) - size,
            float(y.max()) + size,
        )

    def set(self, context: Context, tick: int) -> None:
        """Set all bodies to their state at ``tick``. ``context`` belongs to the diagram
        of this scene.
        """
        plant = self.scene.plant
        self.set_plant(plant.GetMyMutableContextFromRoot(context), tick)

    def set_plant(self, inner: Context, tick: int) -> None:
        """Set all bodies to their state at ``tick``. ``inner`` belongs to the plant."""
        arrays = self.record.arrays
        plant = self.scene.plant
        for i, robot in enumerate(self.scene.robots):
            q = arrays[f"joint_position_{i}"][tick]
            plant.SetPositions(inner, robot.model_instance, q)
        plant.SetFreeBodyPose(inner, self.scene.object, self.object_pose(tick))
        for name, body in self.scene.bodies.items():
            values = arrays.get(f"body_{name}")
            if values is not None:
                X = transform_from_positions(values[tick])
                plant.SetFreeBodyPose(inner, body, X)

    def object_pose(self, tick: int) -> RigidTransform:
        """Spatial pose of the object's frame G (at half height) at ``tick``."""
        positions = self.record.arrays.get("object_pose_3d")
        if positions is not None:
            return transform_from_positions(positions[tick])
        x, y, yaw = (float(v) for v in self.record.arrays["object_pose"][tick])
        return rigid_transform(
            Pose2(x, y, yaw), rest_height(self.task.object), self.task.support.frame
        )

    def vehicle_pose(self, tick: int) -> Pose2:
        """X_WV at ``tick``: tracking point and heading of the current segment."""
        X_BV = Pose2(*(float(v) for v in self.record.arrays["vehicle_frame"][tick]))
        X_WG = planar_pose(self.object_pose(tick), self.task.support.frame)
        return X_WG.compose(self.task.X_GB).compose(X_BV)

    def ticks_at(self, times: Array) -> list[int]:
        """First recorded tick not before each of ``times`` [s]."""
        recorded = self.record.arrays["time"]
        ticks = np.clip(np.searchsorted(recorded, times), 0, len(recorded) - 1)
        return [int(i) for i in ticks]


def _anchor(
    graph: SceneGraph, source: SourceId, instance: GeometryInstance, color: Rgba
) -> None:
    """Fix a geometry to the world, in Meshcat and in rendered pictures."""
    drawn = IllustrationProperties()
    seen = PerceptionProperties()
    for properties in (drawn, seen):
        properties.AddProperty("phong", "diffuse", color)
    instance.set_illustration_properties(drawn)
    instance.set_perception_properties(seen)
    graph.RegisterAnchoredGeometry(source, instance)
