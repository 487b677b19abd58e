"""Views of a replay: the direction and the contents of each picture, and the body that
it follows.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import arm_title
from pushpressslide.core.support_frame import TABLE
from pushpressslide.sim.convert import planar_pose
from pushpressslide.view.drake.camera import (
    BEST_SLOPE,
    SIDE_SLOPE,
    Directions,
    View,
    fit_view,
    top_direction,
)
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.sight import seen_share
from pushpressslide.view.drake.subject import Subject, subject

ASIDE = math.radians(65.0)  # angle of the tip camera from straight behind the push
TIP_ROOM = 0.13  # [m] about a tip that is held by the view of it
FOLLOW_ROOM = 1.8  # radii of the object around it that stay in the picture

Row = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class PageView:
    """A view of the page. The camera is placed so that the view's points fit in the
    window.
    """

    name: str
    direction: Row  # (3,) towards the camera, in the world
    points: tuple[Row, ...]  # (N, 3) [m] in the world, or about what is followed
    follow: tuple[Row, ...] = ()  # (F, 3) [m] in the world by frame; empty: it stays
    turn: Row = ()  # (F,) [rad] of the camera about the world's z by frame; empty: none
    through: bool = False  # whether the arms are seen through

    def plain(self) -> dict[str, Any]:
        """The view as data for JSON."""
        return asdict(self)


def directions(playback: Playback, subject: Subject) -> Directions:
    """Evaluated directions from which a run can be seen."""
    frame = playback.task.support.frame
    return Directions(frame, subject.moments, subject.pushes, subject.near)


def contact_view(playback: Playback, field: float, aspect: float) -> View:
    """Camera that sees the contacts best. ``field`` [rad] is the vertical field of
    view, ``aspect`` the ratio of the picture's width to its height.
    """
    seen = subject(playback)
    return fit_view(seen.near, directions(playback, seen).best(), field, aspect)


def page_views(playback: Playback, ticks: NDArray[np.intp]) -> tuple[PageView, ...]:
    """Views of a replay page with frames at ``ticks`` (F,). The view that sees the
    contacts comes first.
    """
    seen = subject(playback)
    frame = playback.task.support.frame
    judged = directions(playback, seen)
    best = _row(judged.best())
    side = judged.best(SIDE_SLOPE)
    near = _rows(seen.near)
    whole = _rows(seen.whole)
    return (
        PageView("Contact", best, near),
        PageView("All", best, whole),
        PageView("Top", _row(top_direction(frame)), near, through=True),
        PageView("Side", _row(side), near),
        *_tip_views(playback, ticks, seen, best),
        _object_view(playback, ticks, best),
    )


def _tip_views(
    playback: Playback, ticks: NDArray[np.intp], subject: Subject, direction: Row
) -> tuple[PageView, ...]:
    """One view for each arm with a contact, which follows its tip. On a table, a view
    from behind a pushing tip turns with the object.
    """
    frame = playback.task.support.frame
    touched = {c.arm: c for part in playback.placements for c in part.contacts}
    places = playback.record.arrays["tip_position"][ticks]
    count = len(playback.task.robots)
    margin = _cube(TIP_ROOM)
    views = []
    for arm, contact in sorted(touched.items()):
        rows = places[:, arm].tolist()
        points = _rows(np.array([frame.point((x, y, z)) for x, y, z in rows]))
        name = "Tip"
        if count > 1:
            name = f"{arm_title(arm).split()[0].capitalize()} tip"
        if contact.kind == "top" or frame != TABLE:
            views.append(PageView(name, direction, margin, points))
            continue
        behind = _behind(subject, contact.normal)
        yaws = playback.record.arrays["object_pose"][ticks, 2]
        views.append(PageView(name, _row(behind), margin, points, _row(yaws)))
    return tuple(views)


def _behind(subject: Subject, normal: Point) -> Array:
    """Best direction (3,), in the object's axes, in which to look at a push along
    ``normal``.

    It is from behind the tip, to the left or to the right.
    """
    heading = math.atan2(normal[1], normal[0])
    costs = []
    offered = []
    for side in (ASIDE, -ASIDE):
        hidden = 0.0
        for moment, yaw in zip(subject.moments, subject.yaws, strict=True):
            towards = _sloped(heading + math.pi + side + yaw)
            hidden += 1.0 - float(seen_share(moment, towards))
        costs.append(hidden)
        offered.append(_sloped(heading + math.pi + side))
    return offered[int(np.argmin(costs))]


def _sloped(azimuth: float) -> Array:
    flat = math.cos(BEST_SLOPE)
    x = flat * math.cos(azimuth)
    y = flat * math.sin(azimuth)
    return np.array([x, y, math.sin(BEST_SLOPE)])


def _object_view(
    playback: Playback, ticks: NDArray[np.intp], direction: Row
) -> PageView:
    """A view that follows the object."""
    frame = playback.task.support.frame
    shape = playback.task.object.shape
    poses = [planar_pose(playback.object_pose(int(tick)), frame) for tick in ticks]
    height = 0.5 * shape.height
    points = np.array([frame.point((pose.x, pose.y, height)) for pose in poses])
    margin = _cube(FOLLOW_ROOM * shape.farthest((0.0, 0.0)) / math.sqrt(2.0))
    return PageView("Follow", direction, margin, _rows(points))


def _cube(half: float) -> tuple[Row, ...]:
    """Corners [m] of a cube about the origin."""
    ends = (-half, half)
    return tuple((x, y, z) for x in ends for y in ends for z in ends)


def _row(values: Array) -> Row:
    return tuple(round(float(v), 4) for v in values)


def _rows(values: Array) -> tuple[Row, ...]:
    return tuple(_row(row) for row in values)
