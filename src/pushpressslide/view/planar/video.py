"""Animation of a run on the planar engine, seen from above, with paths, forces and
caption, without Drake.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import Record
from pushpressslide.view import film
from pushpressslide.view.canvas import Canvas, Pixel, rgba
from pushpressslide.view.planar.replay import (
    CONE,
    CONE_LENGTH,
    EDGE,
    FORCE,
    FORCE_SCALE,
    GOAL,
    OBJECT,
    OBJECT_EDGE,
    PATH,
    PRESS,
    REFERENCE,
    TRACE,
    Placed,
    legend,
    scene_ticks,
    task_goals,
)
from pushpressslide.view.timeline import run_timeline

TIP = "#3b3f45"
GRID = "#eceff2"
BODY = "#b9bec6"
LEAST_FORCE = 0.1  # [N]
MARGIN = 0.06  # [m] about all that is shown
CORNERS = 40  # of a circle
TOP = 20.0  # [pixels] above the scene
LOW = 44.0  # [pixels] below it, for the caption


def write_video(
    plan: Plan,
    record: Record,
    out: Path,
    goals: Sequence[Placed] = (),
    parts: Sequence[Record] = (),
    frames_per_second: float | None = None,
    size: tuple[int, int] = film.SIZE,
) -> Path:
    """Write the run as an animation in real time, and return its path.

    The suffix of ``out`` determines the format and the usual rate: .mp4, .webp or .gif.
    A folder gets run.mp4, or run.webp without av. ``size`` is (width, height) [pixels];
    ``goals`` and ``parts`` are as in ``write_replay``. Raises SimulationError for
    another format.
    """
    out = film.film_path(out)
    rate = frames_per_second or film.film_rate(out)
    ticks = film.film_ticks(record.arrays["time"], rate)
    told = run_timeline(plan, record, np.array(ticks))
    title = f"{plan.task.name}: {', '.join(record.modes)}"
    drawing = _Film(plan, record, goals, parts, size)
    legend_drawing = film.legend(
        film.LegendEntry(color, text)
        for color, text, _ in legend(plan)
        if color != REFERENCE
    )

    def picture(frame: int) -> Any:
        canvas = Canvas(np.full((size[1], size[0], 3), 255, dtype=np.uint8))
        drawing.draw(canvas, ticks[frame])
        canvas.paste(legend_drawing)
        film.caption(canvas, title, told, frame)
        return canvas.image()

    return film.write_film(len(ticks), picture, out, rate)


def write_pictures(
    plan: Plan,
    record: Record,
    out: Path,
    goals: Sequence[Placed] = (),
    parts: Sequence[Record] = (),
) -> list[Path]:
    """Write pictures of start, contact and end of a run into ``out`` and return their
    paths.
    """
    width, height = film.STILL_SIZE
    drawing = _Film(plan, record, goals, parts, film.STILL_SIZE)

    def picture(_: str, tick: int) -> Any:
        canvas = Canvas(np.full((height, width, 3), 255, dtype=np.uint8))
        drawing.draw(canvas, tick)
        return canvas.image()

    return film.write_stills(record.arrays["phase"], picture, out)


class _Film:
    """A run in the plane at any tick, with all stages drawn to the same scale."""

    def __init__(
        self,
        plan: Plan,
        record: Record,
        goals: Sequence[Placed],
        parts: Sequence[Record],
        size: tuple[int, int],
    ) -> None:
        self._record = record
        aims = goals or task_goals(plan.task)
        stages = [(part.plan, part) for part in parts] or [(plan, record)]
        self._drawings = [_Drawing(own, part, aims) for own, part in stages]
        shown = np.concatenate([drawing.shown() for drawing in self._drawings])
        for drawing in self._drawings:
            drawing.fit(shown, size)

    def draw(self, canvas: Canvas, tick: int) -> None:
        """Draw the scene at a tick."""
        scene, own = scene_ticks(self._record, np.array([tick]))
        self._drawings[scene[0]].draw(canvas, int(own[0]))


class _Drawing:
    """One stage in the plane, at any of its ticks."""

    def __init__(self, plan: Plan, record: Record, goals: Sequence[Placed]) -> None:
        task = plan.task
        self._task = task
        self._record = record
        self._parts = plan.by_placement
        self._goals = goals
        axles = record.arrays["vehicle_frame"]
        poses = record.arrays["object_pose"]
        self._trace = [self._tracked(p, v) for p, v in zip(poses, axles, strict=True)]
        self._path = [
            (float(x), float(y)) for x, y in record.arrays["plan_path"][:, :2]
        ]
        self._mirror = -1.0 if not task.support.frame.faces_up else 1.0

    def _tracked(self, pose: Array, axle: Array) -> Point:
        X_WV = _pose(pose).compose(self._task.X_GB).compose(_pose(axle))
        return X_WV.position

    def shown(self) -> Array:
        """All points (N, 2) [m] that must be in the picture."""
        poses = self._record.arrays["object_pose"]
        shape = self._task.object.shape
        placed = [(shape, _pose(row)) for row in poses[::20]]
        placed += [*self._goals, *((o.shape, o.pose) for o in self._task.obstacles)]
        points = [X.apply(corner) for own, X in placed for corner in own.outline()]
        return np.array([*points, *self._path])

    def fit(self, points: Array, size: tuple[int, int]) -> None:
        """Choose the scale [pixels/m] and the middle [m] so that ``points`` fill the
        picture.
        """
        low = points.min(axis=0) - MARGIN
        high = points.max(axis=0) + MARGIN
        span = high - low
        width, height = size
        self._size = size
        self._zoom = min(width / span[0], (height - TOP - LOW) / span[1])
        self._middle = 0.5 * (low + high)

    def pixel_of(self, point: Point) -> Pixel:
        """Pixel of a point [m]."""
        width, height = self._size
        right = self._mirror * self._zoom * (point[0] - self._middle[0])
        up = self._zoom * (point[1] - self._middle[1])
        return 0.5 * width + right, 0.5 * (height + TOP - LOW) - up

    def draw(self, canvas: Canvas, tick: int) -> None:
        """Draw the scene at a tick."""
        self._draw_grid(canvas)
        region = self._task.support.region
        if region is not None:
            canvas.line(
                [self.pixel_of(p) for p in (*region, region[0])], rgba(EDGE), 1.5
            )
        for obstacle in self._task.obstacles:
            corners = [obstacle.pose.apply(c) for c in obstacle.shape.outline()]
            self._area(canvas, corners, BODY, 1.0, EDGE)
        for shape, X_WG in self._goals:
            corners = [X_WG.apply(c) for c in shape.outline()]
            self._area(canvas, corners, GOAL, 0.12, GOAL)
        canvas.dashes([self.pixel_of(p) for p in self._path], rgba(PATH), 2.0)
        points = [self.pixel_of(p) for p in self._trace[: tick + 1 : 5]]
        canvas.line(points, rgba(TRACE), 3.0)
        X_WG = _pose(self._record.arrays["object_pose"][tick])
        corners = [X_WG.apply(c) for c in self._task.object.shape.outline()]
        self._area(canvas, corners, OBJECT, 0.55, OBJECT_EDGE)
        axle = self.pixel_of(self._trace[tick])
        canvas.dot(axle, 6.0, rgba("#ffffff"), rgba(TRACE))
        for arm in range(len(self._task.robots)):
            self._draw_tip(canvas, arm, tick, X_WG.compose(self._task.X_GB))

    def _draw_grid(self, canvas: Canvas) -> None:
        """Draw grid lines every 0.1 m over the whole picture."""
        width, height = self._size
        reach = int(10.0 * max(width, height) / self._zoom) + 1
        x, y = (round(10.0 * float(v)) for v in self._middle)
        for k in range(-reach, reach + 1):
            across, _ = self.pixel_of(((x + k) / 10.0, 0.0))
            canvas.line(((across, 0.0), (across, float(height))), rgba(GRID), 1.0)
            _, down = self.pixel_of((0.0, (y + k) / 10.0))
            canvas.line(((0.0, down), (float(width), down)), rgba(GRID), 1.0)

    def _area(
        self,
        canvas: Canvas,
        corners: Sequence[Point],
        fill: str,
        opacity: float,
        edge: str,
    ) -> None:
        points = [self.pixel_of(corner) for corner in corners]
        canvas.polygon(points, rgba(fill, opacity), rgba(edge), 2.0)

    def _draw_tip(self, canvas: Canvas, arm: int, tick: int, X_WB: Pose2) -> None:
        """Draw a tip, its force and its friction cone or disc."""
        x, y, _ = (float(v) for v in self._record.arrays["tip_position"][tick, arm])
        if not math.isfinite(x):
            return
        force = np.nan_to_num(self._record.arrays["measured_force"][tick, arm])
        fx, fy, fz = (float(v) for v in force)
        radius = self._task.robots[arm].tip_radius
        number = int(self._record.arrays["placement"][tick])
        touched = self._parts[number].contacts
        contact = next((c for c in touched if c.arm == arm), None)
        friction = self._task.contact_friction
        tail = (x, y)
        color = TIP
        if contact is not None and contact.kind == "top":
            color = PRESS
            reach = friction * max(0.0, -fz) * FORCE_SCALE
            self._area(canvas, _circle((x, y), reach), CONE, 0.25, CONE)
        canvas.dot(self.pixel_of((x, y)), self._zoom * radius, rgba(color))
        if contact is not None and contact.kind == "side":
            nx, ny, _ = contact.direction(X_WB)
            tail = (x + radius * nx, y + radius * ny)
            if math.hypot(fx, fy) > LEAST_FORCE:
                self._area(canvas, _cone(tail, (nx, ny), friction), CONE, 0.25, CONE)
        if math.hypot(fx, fy) > LEAST_FORCE:
            head = (tail[0] + FORCE_SCALE * fx, tail[1] + FORCE_SCALE * fy)
            canvas.arrow(self.pixel_of(tail), self.pixel_of(head), rgba(FORCE), 4.0)


def _pose(row: Array) -> Pose2:
    x, y, yaw = (float(v) for v in row)
    return Pose2(x, y, yaw)


def _circle(center: Point, radius: float) -> list[Point]:
    angles = [2.0 * math.pi * i / CORNERS for i in range(CORNERS)]
    x, y = center
    return [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]


def _cone(apex: Point, normal: Point, friction: float) -> list[Point]:
    """Corners [m] of a section of a friction cone."""
    (x, y), (nx, ny) = apex, normal
    ends = [
        (
            x + CONE_LENGTH * (nx - side * friction * ny),
            y + CONE_LENGTH * (ny + side * friction * nx),
        )
        for side in (-1.0, 1.0)
    ]
    return [apex, *ends]
