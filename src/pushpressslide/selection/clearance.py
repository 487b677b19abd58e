"""Checks of a planned path: whether it is clear of obstacles, openings and table edges,
and straight with a tool.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.footprint import all_placed, edge_depths, gaps, overlaps
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, literal
from pushpressslide.core.scene import Obstacle, Scene
from pushpressslide.geometry.shapes import Shape
from pushpressslide.planning.carried import carried_ways
from pushpressslide.planning.free_space import lengths_from
from pushpressslide.planning.swept import SWEEP_STEP, swept
from pushpressslide.selection.edge import edge_refusal
from pushpressslide.selection.opening_path import opening_refusal
from pushpressslide.selection.tool_use import tool_refusal

if TYPE_CHECKING:
    from shapely import Polygon

# overlap with an obstacle above which the object is in it, not beside it, as a share of
# the squared clearance
ENTERED = 0.1
ROUND_OFF = 1e-6  # [m]


def path_refusal(query: MotionQuery, segments: Sequence[Segment]) -> Refusal | None:
    """Refusal of the object's path, or None.

    A path is refused if the object comes too near to an obstacle or to an arm's base,
    tips into an opening or over an edge, or does not push straight as a tool.
    """
    scene = query.scene
    support = scene.support
    near = _near_bases(scene, query.motion.clearance, segments)
    if not (
        query.scene.obstacles or support.opening or support.region or query.tool or near
    ):
        return None
    poses = swept(scene.body, segments, query.motion.clearance)
    return (
        obstacle_refusal(query, poses)
        or (base_refusal(query, poses) if near else None)
        or tips_refusal(scene, query.yielding, segments, poses)
        or edge_refusal(scene, query.motion.clearance, segments)
        or opening_refusal(query, segments[0], poses)
        or tool_refusal(query, poses)
    )


def base_discs(scene: Scene) -> list[Polygon]:
    """Discs that the lowest links of the arms occupy, up to the object's height."""
    from shapely import Point

    radius = margins.ARM.base
    return [
        Point(x, y).buffer(radius)
        for robot, (x, y, height) in zip(scene.robots, scene.bases, strict=True)
        if robot.model != "hand" and height < scene.body.shape.height + radius
    ]


def base_refusal(query: MotionQuery, poses: Sequence[Pose2]) -> Refusal | None:
    """Refusal of ``poses`` X_WG along a path that comes too near to an arm's base, or
    None.

    A base is not checked if its disc already contains the start or the end of the
    motion.
    """
    discs = base_discs(query.scene)
    if not discs:
        return None
    shape = query.body.shape
    ends = (query.start, query.goal)
    at_ends = gaps(shape, ends, discs).min(0)
    discs = [disc for disc, gap in zip(discs, at_ends, strict=True) if gap > 0.0]
    if not discs:
        return None
    clearance = query.motion.clearance
    distances = gaps(shape, poses, discs)
    allowed = allowed_gaps(shape, poses, ends, discs, clearance)
    worst, i = divmod(int((allowed - distances).argmax()), len(discs))
    if distances[worst, i] >= allowed[worst, i]:
        return None
    text = (
        "the object comes within {figure:mm.0f} of an arm's base at "
        f"{_position_text(poses[worst])}, allowed from {{allowed:mm.0f}}"
    )
    least = float(distances[worst, i])
    return Refusal("obstacle", text, least, float(allowed[worst, i]), "m")


def _near_bases(scene: Scene, clearance: float, segments: Sequence[Segment]) -> bool:
    """Whether the object may come near to an arm's base on its path."""
    margin = scene.body.radius + clearance + margins.ARM.base
    for segment in segments:
        length = segment.path.length
        X_WV = segment.path.pose(0.5 * length)
        far = margin + math.hypot(*segment.X_BV.position) + 0.5 * length
        if any(math.dist(X_WV.position, base[:2]) < far for base in scene.bases):
            return True
    return False


def obstacle_refusal(query: MotionQuery, poses: Sequence[Pose2]) -> Refusal | None:
    """Refusal of ``poses`` X_WG along a path that comes too near to an obstacle, or
    None.

    A movable obstacle counts at its initial pose, so that it is not pushed along.
    Obstacles that the object is meant to push, as a tool or along its path, may touch
    the object but must stay clear of the other obstacles.
    """
    tool = query.tool
    pushed = None
    others = []
    for obstacle in query.scene.obstacles:
        if tool is not None and obstacle.name == tool.body:
            pushed = obstacle
        elif obstacle not in query.yielding:
            others.append(obstacle)
    ends = (query.start, query.goal)
    clearance = query.motion.clearance
    shape = query.body.shape
    refusal = _too_near("the object", shape, poses, ends, others, clearance)
    refusal = refusal or _carried_refusal(query, poses)
    if refusal is not None or pushed is None or tool is None:
        return refusal
    ends = (pushed.pose, tool.goal)
    distance = math.dist(pushed.pose.position, tool.goal.position)
    steps = max(1, math.ceil(distance / (SWEEP_STEP * clearance)))
    poses = [_between(*ends, i / steps) for i in range(steps + 1)]
    name = repr(pushed.name)
    return _too_near(name, pushed.shape, poses, ends, others, clearance)


def tips_refusal(
    scene: Scene,
    yielding: Sequence[Obstacle],
    segments: Sequence[Segment],
    poses: Sequence[Pose2],
) -> Refusal | None:
    """Refusal of ``poses`` X_WG at which a tip would touch a tall obstacle, or None.

    The ``yielding`` obstacles are pushed along.
    """
    import shapely

    contacts = {contact for segment in segments for contact in segment.contacts}
    paths = carried_ways(scene.body.shape, yielding, poses)
    for contact in contacts:
        radius = scene.robots[contact.arm].tip_radius
        place, height = contact.tip_place(radius)
        x, y = scene.body.X_GB.apply(place)
        tall = [o for o in scene.obstacles if o.shape.height > height - radius]
        if not tall:
            continue
        tips = shapely.points([X.apply((x, y)) for X in poses])
        for obstacle in tall:
            path = paths.get(obstacle.name)
            there = all_placed(obstacle.shape, path or [obstacle.pose])
            distances = shapely.distance(tips, there)
            nearest = int(distances.argmin())
            gap = float(distances[nearest]) - radius
            if gap < 0.0:
                name = literal(repr(obstacle.name))
                text = f"the tip runs into obstacle {name} at {_position_text(poses[nearest])}"
                return Refusal("obstacle", text, gap, 0.0, "m")
    return None


def _carried_refusal(query: MotionQuery, poses: Sequence[Pose2]) -> Refusal | None:
    """Refusal of a path on which a pushed obstacle runs into another obstacle or over
    the edge of the table, or None.
    """
    from shapely import Polygon

    scene = query.scene
    paths = carried_ways(scene.body.shape, query.yielding, poses)
    for name, path in paths.items():
        body = next(o for o in scene.obstacles if o.name == name)
        others = [o for o in scene.obstacles if o is not body]
        ends = (body.pose, body.pose)
        what = f"{name!r}, pushed along,"
        clearance = query.motion.clearance
        refusal = _too_near(what, body.shape, path, ends, others, clearance)
        region = scene.support.region
        if refusal is None and region is not None:
            places = np.array([X.apply(body.shape.centroid) for X in path])
            depths = edge_depths(body.shape, path, places, Polygon(region))
            worst = int(depths.argmin())
            if depths[worst] <= 0.0:
                text = (
                    f"{literal(what)} falls over the edge of support.region at "
                    f"{_position_text(path[worst])}"
                )
                refusal = Refusal("edge", text)
        if refusal is not None:
            return refusal
    return None


def _between(a: Pose2, b: Pose2, u: float) -> Pose2:
    turn = math.remainder(b.yaw - a.yaw, 0.5 * math.pi)  # whichever side is pushed
    return Pose2(a.x + u * (b.x - a.x), a.y + u * (b.y - a.y), a.yaw + u * turn)


def _too_near(
    what: str,
    shape: Shape,
    poses: Sequence[Pose2],
    ends: tuple[Pose2, Pose2],
    obstacles: Sequence[Obstacle],
    clearance: float,
) -> Refusal | None:
    """Refusal of a path on which ``what`` comes nearer to an obstacle than
    ``clearance`` [m], or None.

    If the gap at an end of the path is already smaller, it is the limit near this end.
    """
    if not obstacles:
        return None
    others = [obstacle.footprint for obstacle in obstacles]
    distances = gaps(shape, poses, others)
    allowed = allowed_gaps(shape, poses, ends, others, clearance)
    for i, obstacle in enumerate(obstacles):
        lacking = allowed[:, i] - distances[:, i]
        if distances[:, i].min() == 0.0 and allowed[:, i].min() <= 0.0:
            # it touches at an end, so it may in between
            shared = overlaps(shape, poses, others[i])
            deepest = int(shared.argmax())
            if shared[deepest] > ENTERED * clearance**2:
                name = literal(repr(obstacle.name))
                text = f"{literal(what)} runs into obstacle {name} at {_position_text(poses[deepest])}"
                return Refusal("obstacle", text)
        worst = int(lacking.argmax())
        if lacking[worst] > 0.0:
            text = (
                f"{literal(what)} comes within {{figure:mm.0f}} of obstacle "
                f"{literal(repr(obstacle.name))} at {_position_text(poses[worst])}, allowed from "
                "{allowed:mm.0f}"
            )
            least = float(distances[worst, i])
            return Refusal("obstacle", text, least, float(allowed[worst, i]), "m")
    return None


def _position_text(pose: Pose2) -> str:
    return f"({pose.x:.3f}, {pose.y:.3f})"


def allowed_gaps(
    shape: Shape,
    poses: Sequence[Pose2],
    ends: Sequence[Pose2],
    others: Sequence[Polygon],
    clearance: float,
) -> Array:
    """Smallest allowed gaps (n, k) [m] between a footprint at n ``poses`` X_WG and k
    polygons.

    The allowed gap is ``clearance`` [m]. If the gap at one of the path's ``ends`` is
    smaller, the allowed gap starts with this value and grows to the clearance within
    ``margins.ARM.leaving`` [m].
    """
    at_ends = np.minimum(gaps(shape, ends, others), clearance)
    allowed = np.full((len(poses), len(others)), clearance)
    if (at_ends == clearance).all():
        return allowed - ROUND_OFF
    for end, there in zip(ends, at_ends, strict=True):
        far = lengths_from(shape, end, poses)
        share = np.minimum(far / margins.ARM.leaving, 1.0)[:, None]
        allowed = np.minimum(allowed, there + (clearance - there) * share)
    return allowed - ROUND_OFF
