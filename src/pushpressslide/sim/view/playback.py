"""A recorded run in its scene, without physics, for replay and frames."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    GeometryInstance,
    IllustrationProperties,
    InMemoryMesh,
    Mesh,
    PerceptionProperties,
    Rgba,
    SceneGraph,
    SourceId,
)
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Shape, Task
from pushpressslide.sim.convert import (
    planar_pose,
    rigid_transform,
    transform_from_positions,
)
from pushpressslide.sim.scenes import build_scene, rest_height
from pushpressslide.sim.surfaces import drawn_shape

RIBBON_WIDTH = 0.006  # [m] of lines on the support
PATH_HEIGHT = 0.0010  # [m] above the support
LEAST_PATH = 1e-3  # [m] shorter lines are not drawn
# [m] the goal is drawn lower, so that its top does not coincide with the object's
GOAL_SINK = 1e-3
GOAL_COLOR = Rgba(0.0, 0.62, 0.45, 0.28)
PATH_COLOR = Rgba(0.13, 0.13, 0.13, 1.0)
ARM_HEIGHT = 0.75  # [m] of an arm above its base, for the camera
ASPECT = 4.0 / 3.0  # width over height of a picture
FILL = 0.85  # largest share of a picture that the scene fills
STEEP = 0.5  # of a support's normal: a smaller vertical component is seen as a wall


Placed = tuple[Shape, Pose2]
"""A shape at a pose X_WG."""


@dataclass(frozen=True, eq=False)
class View:
    """Position and target of a camera, in the world [m]."""

    position: Any  # (3,); pydrake's stubs refuse every typed ndarray
    target: Any  # (3,)


class Playback:
    """The scene of a run with its goal and planned path, at any recorded tick."""

    def __init__(
        self,
        plan: Plan,
        record: Record,
        models: str = "generated",
        goals: Sequence[Placed] = (),
    ) -> None:
        """Build the scene.

        ``goals`` are drawn in place of the object's own, if there are any. Raises
        SimulationError for a record without joint positions.
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
        self._draw_plan(goals or [(task.object.shape, task.goal)])

    def _draw_plan(self, goals: Sequence[Placed]) -> None:
        """Draw shapes at their goals, and one line for each segment of the path."""
        task = self.task
        graph = self.scene.scene_graph
        frame = task.support.frame
        source = graph.RegisterSource("plan")
        opening = task.support.opening
        depth = GOAL_SINK
        if opening is not None and task.enters:
            depth = opening.depth
        for i, (shape, X_WG) in enumerate(goals):
            X = rigid_transform(X_WG, 0.5 * shape.height - depth, frame)
            goal = GeometryInstance(X, drawn_shape(shape), f"goal_{i}")
            _anchor(graph, source, goal, GOAL_COLOR)
        X = rigid_transform(Pose2(), PATH_HEIGHT, frame)
        path = self.record.arrays["plan_path"][:, :2]
        segments = self.record.arrays["plan_stretch"]
        for i in np.unique(segments):
            points = path[segments == i]
            if leads_somewhere(points):
                line = ribbon(points, RIBBON_WIDTH)
                drawn = GeometryInstance(X, line, f"path_{i:.0f}")
                _anchor(graph, source, drawn, PATH_COLOR)

    def set(self, context: Context, tick: int) -> None:
        """Put everything where it was at ``tick``; ``context`` belongs to the diagram
        of this scene.
        """
        arrays = self.record.arrays
        plant = self.scene.plant
        inner = plant.GetMyMutableContextFromRoot(context)
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
        """Return the spatial pose of the object's frame G (at half height) at ``tick``."""
        positions = self.record.arrays.get("object_pose_3d")
        if positions is not None:
            return transform_from_positions(positions[tick])
        x, y, yaw = (float(v) for v in self.record.arrays["object_pose"][tick])
        return rigid_transform(
            Pose2(x, y, yaw), rest_height(self.task.object), self.task.support.frame
        )

    def vehicle_pose(self, tick: int) -> Pose2:
        """Return X_WV at ``tick``: tracking point and heading of the current segment."""
        X_BV = Pose2(*(float(v) for v in self.record.arrays["vehicle_frame"][tick]))
        X_WG = planar_pose(self.object_pose(tick), self.task.support.frame)
        return X_WG.compose(self.task.X_GB).compose(X_BV)

    def ticks_at(self, times: Array) -> list[int]:
        """Return the first recorded tick not before each of ``times`` [s]."""
        recorded = self.record.arrays["time"]
        ticks = np.clip(np.searchsorted(recorded, times), 0, len(recorded) - 1)
        return [int(i) for i in ticks]

    def view(self, field: float) -> View:
        """Return the view of a camera with a vertical field of view ``field`` [rad]."""
        poses = self.record.arrays["object_pose"][::20]
        return camera_view(self.plan, poses, field, self._other_places())

    def _other_places(self) -> list[Vector3]:
        """Return where the other bodies that can move are at first and last [m]."""
        arrays = self.record.arrays
        rows = [arrays.get(f"body_{name}") for name in self.scene.bodies]
        ends = [row[i, 4:] for row in rows if row is not None for i in (0, -1)]
        return [(float(x), float(y), float(z)) for x, y, z in ends]


def camera_view(
    plan: Plan, poses: Array, field: float, others: Sequence[Vector3] = ()
) -> View:
    """Return the view of a camera that holds object, goal and arms, from the front and
    the side of the tips.

    ``poses`` (N, 3) [m, rad] are those of the object, X_WG; ``field`` [rad] is the
    vertical field of view; ``others`` [m] are to be seen too, in the world.
    """
    normal = np.array(plan.task.support.frame.normal)
    points = _seen_points(plan.task, poses)
    if others:
        points = np.concatenate([points, np.array(others)])
    if normal[2] < STEEP:  # from behind the arms, to one side
        side = np.cross([0.0, 0.0, 1.0], normal)
        return fit_view(points, 0.62 * normal + 0.78 * side + [0.0, 0.0, 0.45], field)
    left = 0.0  # how far the pushes point to +y: the tips are on the other side
    yaws = poses[:, 2]
    for placement in plan.by_placement:
        for contact in placement.contacts:
            x, y = contact.normal
            left += float(np.mean(np.sin(yaws) * x + np.cos(yaws) * y))
    side_y = -0.78 if left >= 0.0 else 0.78
    return fit_view(points, np.array([0.62, side_y, 0.62]), field)


def _seen_points(task: Task, poses: Array) -> Array:
    """Return the points (N, 3) [m] that a picture must hold: the object's corners and
    the arms.
    """
    shape = task.object.shape
    x_min, x_max, y_min, y_max = shape.bounds(Pose2())
    rectangle = ((x_min, y_min), (x_min, y_max), (x_max, y_min), (x_max, y_max))
    corners = shape.corners or rectangle
    frame = task.support.frame
    points = [
        frame.point((*X_WG.apply(corner), z))
        for X_WG in (*(Pose2(*row) for row in poses.tolist()), task.goal)
        for corner in corners
        for z in (0.0, shape.height)
    ]
    for robot in task.robots:
        if robot.model != "hand":
            x, y, z = robot.base
            points += [(x, y, z), (x, y, z + ARM_HEIGHT)]
    return np.array(points)


def fit_view(points: Array, direction: Array, field: float) -> View:
    """Return the nearest view from ``direction`` (3,) that holds ``points`` (N, 3).

    ``field`` [rad] is the vertical field of view; the picture is upright and at least
    ASPECT wide.
    """
    z = -direction / np.linalg.norm(direction)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    reach = math.tan(0.5 * field) * FILL
    distance = float(np.linalg.norm(points - target, axis=1).max()) / reach
    # shift and distance depend on each other; a few iterations settle both
    for _ in range(12):
        ahead = (points - target) @ z + distance
        across, down = ((points - target) @ axis / ahead for axis in (x, y))
        middle = (
            0.5 * (across.max() + across.min()) * x
            + 0.5 * (down.max() + down.min()) * y
        )
        target = target + distance * middle
        needed = max(float(np.ptp(across)) / ASPECT, float(np.ptp(down))) / (
            2.0 * reach
        )
        distance *= needed**0.7
    position = target - distance * z
    return View(position, target)


def leads_somewhere(points: Array) -> bool:
    """Return whether a path (K, 2) [m] is more than a turn on the spot, and can be
    drawn as a line.
    """
    return bool(np.ptp(points, axis=0).max() > LEAST_PATH)


def ribbon(points: Array, width: float) -> Mesh:
    """Return a flat strip of ``width`` [m] along ``points`` (K, 2), K >= 2.

    It lies in the plane z = 0 and faces up.
    """
    along = np.gradient(points, axis=0)
    size = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    side = 0.5 * width * np.stack([-along[:, 1], along[:, 0]], axis=1) / size
    lines = [
        f"v {x:.6f} {y:.6f} 0"
        for pair in zip(points - side, points + side, strict=True)
        for x, y in pair
    ]
    lines.append("vn 0 0 1")
    for i in range(len(points) - 1):
        a = 2 * i + 1
        b = 2 * i + 3
        c = 2 * i + 4
        d = 2 * i + 2  # right, right ahead, left ahead, left
        lines += [f"f {a}//1 {b}//1 {c}//1", f"f {a}//1 {c}//1 {d}//1"]
    return Mesh(
        InMemoryMesh(
            mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", "ribbon.obj")
        )
    )


def _anchor(
    graph: SceneGraph, source: SourceId, instance: GeometryInstance, color: Rgba
) -> None:
    """Show an instance in the world, in Meshcat and in rendered pictures."""
    drawn = IllustrationProperties()
    seen = PerceptionProperties()
    for properties in (drawn, seen):
        properties.AddProperty("phong", "diffuse", color)
    instance.set_illustration_properties(drawn)
    instance.set_perception_properties(seen)
    graph.RegisterAnchoredGeometry(source, instance)
