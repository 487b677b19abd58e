"""A recorded run set up again in its own scene, without physics: what replay and frames
look at.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common import MemoryFile
from pydrake.geometry import (
    GeometryInstance,
    IllustrationProperties,
    InMemoryMesh,
    Mesh,
    PerceptionProperties,
    Rgba,
    SceneGraph,
    Shape,
    SourceId,
)
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.sim.convert import (
    planar_pose,
    rigid_transform,
    transform_from_positions,
)
from pushpressslide.sim.scenes import Scene, build_scene, rest_height
from pushpressslide.sim.surfaces import object_shape

Array = NDArray[np.float64]

RIBBON_WIDTH = 0.006  # [m] of lines on the support
PATH_HEIGHT = 0.0010  # [m] above the support
LEAST_PATH = 1e-3  # [m] of a line that is drawn
# [m] by which the goal is drawn lower, so that its top is not that of the object
GOAL_SINK = 1e-3
GOAL_COLOR = Rgba(0.0, 0.62, 0.45, 0.28)
PATH_COLOR = Rgba(0.13, 0.13, 0.13, 1.0)
ARM_HEIGHT = 0.75  # [m] of an arm above its base, for the camera
ASPECT = 4.0 / 3.0
FILL = 0.85  # width over height of a picture; share of it that the scene may fill


@dataclass(frozen=True, eq=False)
class View:
    """Where a camera stands and what it looks at, in the world [m]."""

    position: Any  # (3,); pydrake's stubs refuse every typed ndarray
    target: Any  # (3,)


class Playback:
    """The scene of a run, with goal and planned path drawn in, that can be put at any
    recorded tick.
    """

    def __init__(
        self, task: Task, plan: Plan, record: Record, models: str = "generated"
    ) -> None:
        """Build the scene; raises SimulationError for a record without joint positions."""
        for i in range(len(task.robots)):
            if f"joint_position_{i}" not in record.arrays:
                raise SimulationError(
                    f"the record of engine {record.engine!r} has no joint_position_{i} "
                    "to show"
                )
        self.task = task
        self.plan = plan
        self.record = record
        self.scene: Scene = build_scene(plan, models=models)
        self._draw_plan()

    def _draw_plan(self) -> None:
        graph = self.scene.scene_graph
        task = self.task
        source = graph.RegisterSource("plan")
        opening = task.support.opening
        depth = opening.depth if opening is not None and task.enters else GOAL_SINK
        height = 0.5 * task.object.shape.height - depth
        _anchor(
            graph,
            source,
            "goal",
            object_shape(task.object.shape),
            rigid_transform(task.goal, height, task.support.frame),
            GOAL_COLOR,
        )
        path = self.record.arrays["plan_path"][:, :2]
        of = self.record.arrays["plan_stretch"]
        for i in np.unique(of):
            if leads_somewhere(path[of == i]):
                mesh = ribbon(path[of == i], RIBBON_WIDTH)
                X = rigid_transform(Pose2(), PATH_HEIGHT, task.support.frame)
                _anchor(graph, source, f"path_{i:.0f}", mesh, X, PATH_COLOR)

    def set(self, context: Context, tick: int) -> None:
        """Put everything where it was at ``tick``; ``context`` is that of the diagram
        with this scene.
        """
        plant = self.scene.plant
        inner = plant.GetMyMutableContextFromRoot(context)
        for i, robot in enumerate(self.scene.robots):
            plant.SetPositions(
                inner,
                robot.model_instance,
                self.record.arrays[f"joint_position_{i}"][tick],
            )
        plant.SetFreeBodyPose(inner, self.scene.object, self.object_pose(tick))
        for name, body in self.scene.bodies.items():
            values = self.record.arrays.get(f"body_{name}")
            if values is not None:
                plant.SetFreeBodyPose(
                    inner, body, transform_from_positions(values[tick])
                )

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
        """Return X_WV at ``tick``: the tracking point of the stretch that is followed,
        and its heading.
        """
        X_BV = Pose2(*(float(v) for v in self.record.arrays["vehicle_frame"][tick]))
        X_WG = planar_pose(self.object_pose(tick), self.task.support.frame)
        return X_WG.compose(self.task.object.X_GB).compose(X_BV)

    def ticks_at(self, times: Array) -> list[int]:
        """Return the recorded tick nearest after each of ``times`` [s]."""
        last = len(self.record.arrays["time"]) - 1
        return [
            int(i)
            for i in np.clip(
                np.searchsorted(self.record.arrays["time"], times), 0, last
            )
        ]

    def view(self, field: float) -> View:
        """Return a camera of vertical ``field`` [rad] that sees object, path, goal and
        arms.
        """
        return camera_view(
            self.task, self.plan, self.record.arrays["object_pose"][::20], field
        )


def camera_view(task: Task, plan: Plan, pose: Array, field: float) -> View:
    """Return where a camera of vertical ``field`` [rad] sees all: in front, on the
    tips' side.

    ``pose`` (N, 3): where the object will be, X_WG [m, rad].
    """
    shape = task.object.shape
    if isinstance(shape, Cylinder):
        corners: tuple[Point, ...] = tuple(
            (a * shape.radius, b * shape.radius) for a in (-1, 1) for b in (-1, 1)
        )
    else:
        corners = shape.footprint
    places = [*(Pose2(*row) for row in pose.tolist()), task.goal]
    frame = task.support.frame
    points = [
        frame.point((*X_WG.apply(c), z))
        for X_WG in places
        for c in corners
        for z in (0.0, shape.height)
    ]
    for robot in task.robots:
        if robot.model != "hand":
            x, y, z = robot.base
            points += [(x, y, z), (x, y, z + ARM_HEIGHT)]
    left = 0.0  # how far the pushes point to +y: the tips are on the other side
    for contact in (c for grasp in plan.by_placement for c in grasp.contacts):
        n = contact.normal
        left += float(np.mean(np.sin(pose[:, 2]) * n[0] + np.cos(pose[:, 2]) * n[1]))
    out = np.array(frame.direction((0.0, 0.0, 1.0)))
    if out[2] < 0.5:  # a wall: from behind the arms, to one side
        side = np.cross([0.0, 0.0, 1.0], out)
        return fit_view(
            np.array(points), 0.62 * out + 0.78 * side + [0.0, 0.0, 0.45], field
        )
    return fit_view(
        np.array(points), np.array([0.62, -0.78 if left >= 0.0 else 0.78, 0.62]), field
    )


def fit_view(points: Array, direction: Array, field: float) -> View:
    """Return the camera that looks from ``direction`` (3,) and just holds ``points``
    (N, 3), upright.

    ``field`` [rad] is the vertical field of view; the picture is taken to be ``ASPECT``
    wide at least.
    """
    z = -direction / np.linalg.norm(direction)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    reach = math.tan(0.5 * field) * FILL
    distance = float(np.linalg.norm(points - target, axis=1).max()) / reach
    # shift and distance decide each other; a few rounds settle both
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
    """Return whether a path (K, 2) [m] is more than a turn on the spot, so that there
    is a line to draw.
    """
    return bool(np.ptp(points, axis=0).max() > LEAST_PATH)


def ribbon(points: Array, width: float) -> Mesh:
    """Return a flat strip of ``width`` [m] along ``points`` (K, 2) in the plane z = 0,
    facing up; K >= 2.
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
    graph: SceneGraph,
    source: SourceId,
    name: str,
    shape: Shape,
    X: RigidTransform,
    color: Rgba,
) -> None:
    instance = GeometryInstance(X, shape, name)
    drawn = IllustrationProperties()
    seen = PerceptionProperties()
    for properties in (drawn, seen):
        properties.AddProperty("phong", "diffuse", color)
    instance.set_illustration_properties(drawn)
    instance.set_perception_properties(seen)
    graph.RegisterAnchoredGeometry(source, instance)
