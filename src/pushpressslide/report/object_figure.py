"""Picture of an object: its base, its side at the height of a tip, and its top."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.geometry.areas import polygons
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.planning.object_sheet import (
    ObjectSheet,
    base_region,
    object_sheet,
    top_region,
)
from pushpressslide.report import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from shapely.geometry.base import BaseGeometry as Area

POINTS = 33
"""Number of points along a side that is drawn."""
MM = 1e3


def planned_object(plan: Plan) -> Figure | None:
    """Picture of a plan's object if it is a body from a mesh."""
    task = plan.task
    if not isinstance(task.object.shape, MeshBody):
        return None
    return object_figure(task.scene, object_sheet(task.scene, task.motion))


def object_figure(scene: Scene, sheet: ObjectSheet) -> Figure:
    """Figure with base and side from above, the top from above, and the body from its
    front.
    """
    figure = Figure(figsize=(12.0, 4.4), layout="constrained")
    below, above, front = figure.subplots(1, 3)
    _base_and_side(below, scene, sheet)
    _top(above, scene, sheet)
    _front(front, scene, sheet)
    figure.suptitle(scene.body.shape.description)
    return figure


def _base_and_side(axes: Axes, scene: Scene, sheet: ObjectSheet) -> None:
    shape = scene.body.shape
    _outline(axes, shape.outline(), color=style.PALE)
    _fill(axes, base_region(shape), style.SKY, "base")
    section = shape.section(sheet.push_height)
    for side in section.border.sides:
        _line(axes, side.points(POINTS), color=style.GREY, lw=1.5)
    for part in sheet.touched:
        _line(axes, part.side.points(POINTS), color=style.ORANGE, lw=3.5)
    if sheet.touched:
        axes.plot([], [], color=style.ORANGE, lw=3.5, label="a tip can push here")
    _center(axes, scene)
    _finish(axes, f"Base, and side at {MM * sheet.push_height:.0f} mm", "y [mm]")


def _top(axes: Axes, scene: Scene, sheet: ObjectSheet) -> None:
    shape = scene.body.shape
    _outline(axes, shape.outline(), color=style.PALE)
    _fill(axes, top_region(shape), style.GREEN, "level top")
    places = [scene.body.X_GB.apply(place) for place in sheet.press_places]
    if places:
        x, y = zip(*places, strict=True)
        marks = {"ms": 5.0, "label": "a tip can press here"}
        axes.plot(_mm(x), _mm(y), "o", color=style.BLACK, **marks)
    _center(axes, scene)
    title = "Top: no place to press"
    if sheet.press_height is not None:
        title = f"Top, at {MM * sheet.press_height:.0f} mm"
    _finish(axes, title, "y [mm]")


def _front(axes: Axes, scene: Scene, sheet: ObjectSheet) -> None:
    """Draw the body seen along y, with a tip beside it at the height of contact."""
    shape = scene.body.shape
    for low, high, x_min, x_max in _slabs(shape):
        axes.fill(
            _mm((x_min, x_max, x_max, x_min)),
            _mm((low, low, high, high)),
            color=style.PALE,
            lw=0,
        )
    radius = scene.tip_radius
    x_min, _, _, _ = shape.section(sheet.push_height).bounds(Pose2())
    _ball(axes, (x_min - radius, sheet.push_height), radius)
    axes.axhline(0.0, color=style.BLACK, lw=0.8)
    axes.axhline(MM * sheet.push_height, color=style.ORANGE, lw=0.8, ls="--")
    if sheet.press_height is not None:
        axes.axhline(MM * sheet.press_height, color=style.GREEN, lw=0.8, ls="--")
    _finish(axes, "From the front, with a tip", "height [mm]")


def _slabs(shape: Any) -> Iterable[tuple[float, float, float, float]]:
    """Lower and upper height, and smallest and largest x, of a body's parts [m]."""
    if not isinstance(shape, MeshBody):
        x_min, x_max, _, _ = shape.bounds(Pose2())
        yield 0.0, shape.height, x_min, x_max
        return
    for band in shape.bands:
        middle = 0.5 * (band.low + band.high)
        halves = ((band.low, middle, band.foot), (middle, band.high, band.head))
        for low, high, area in halves:
            for polygon in polygons(area):
                x_min, _, x_max, _ = polygon.bounds
                yield low, high, x_min, x_max


def _fill(axes: Axes, area: Area | None, color: str, label: str) -> None:
    """Draw an area, with its holes left white."""
    if area is None:
        return
    for i, polygon in enumerate(polygons(area)):
        axes.fill(
            *map(_mm, polygon.exterior.xy),
            color=color,
            alpha=0.6,
            label=None if i else label,
        )
        for hole in polygon.interiors:
            axes.fill(*map(_mm, hole.xy), color="white")


def _outline(axes: Axes, corners: Sequence[Point], **look: Any) -> None:
    _line(axes, [*corners, corners[0]], **look)


def _line(axes: Axes, points: Iterable[Point], **look: Any) -> None:
    x, y = zip(*points, strict=True)
    axes.plot(_mm(x), _mm(y), **look)


def _ball(axes: Axes, center: Point, radius: float) -> None:
    from matplotlib.patches import Circle

    place = (MM * center[0], MM * center[1])
    axes.add_patch(Circle(place, MM * radius, color=style.BLACK, label="tip"))


def _center(axes: Axes, scene: Scene) -> None:
    x, y = scene.body.center_of_mass
    marks = {"ms": 9.0, "label": "centre of mass"}
    axes.plot(MM * x, MM * y, "x", color=style.PURPLE, **marks)


def _mm(values: Iterable[float]) -> list[float]:
    return [MM * value for value in values]


def _finish(axes: Axes, title: str, ylabel: str) -> None:
    axes.set(xlabel="x [mm]", ylabel=ylabel, title=title)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False)
