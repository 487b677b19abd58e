"""Replanning during the motion.

A path from the measured state takes microseconds to plan, so the controller need not
chase errors of an old path.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pushpressslide.control.pressed_body import PressedBody
from pushpressslide.core import margins
from pushpressslide.core.control import TipState
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Contact, MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import ObjectModel
from pushpressslide.geometry.sides import Side
from pushpressslide.identification.online import AxleEstimate
from pushpressslide.identification.parameter_estimates import (
    NOTHING,
    ParameterEstimates,
)
from pushpressslide.mechanics.faces import side_of
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.planning.swept import swept
from pushpressslide.planning.workspace import poses_along, workspace_refusal
from pushpressslide.selection.clearance import obstacle_refusal
from pushpressslide.selection.edge import edge_refusal
from pushpressslide.selection.opening_path import opening_refusal
from pushpressslide.selection.tool_use import tool_refusal


@dataclass(frozen=True, slots=True)
class Replan:
    """Better segments from the present state, which start at the present speed."""

    segments: tuple[Segment, ...]
    progress: float  # [m] on the first one's path
    clock: float  # [s] on its profile


class Replanner:
    """Replans segments of one plan, with the same collision checks as selection."""

    def __init__(self, queries: Sequence[MotionQuery]) -> None:
        """Store the queries by leg."""
        self.queries = queries

    def believing(
        self, rho: float | None, body: PressedBody | None = None
    ) -> Replanner:
        """Replanner with the identified ``rho`` [m] and ``body`` in its scenes. None: as
        they are. A rho that the scenes do not prescribe is left out.
        """
        scenes = [query.scene for query in self.queries]
        rho = None if scenes[0].rho is None else rho
        if rho is None and body is None:
            return self
        if rho is not None:
            scenes = [replace(scene, rho=rho) for scene in scenes]
        if body is not None:
            scenes = [body.within(scene) for scene in scenes]
        pairs = zip(self.queries, scenes, strict=True)
        return Replanner([replace(query, scene=scene) for query, scene in pairs])

    def replan(
        self, segments: Sequence[Segment], measured: Measured
    ) -> tuple[Segment, ...]:
        """The ``segments`` replanned from the measured object pose and contacts.

        Empty if the new path is longer than ``measured`` allows, or is not free.
        """
        first = segments[0]
        query = self.queries[first.leg]
        fresh = MODES[first.mode].replan(query, segments, measured)
        return fresh if _free(query, fresh) else ()

    def retry(self, segment: Segment, measured: Measured) -> tuple[Segment, ...]:
        """Segments of another attempt at the goal. Empty if the mode has no retry, or
        if its segments are not free.
        """
        query = self.queries[segment.leg]
        mode = MODES[segment.mode]
        made = mode.retry(query, segment, measured)
        fresh = tuple(replace(one_segment, leg=segment.leg) for one_segment in made)
        return fresh if _free(query, fresh) else ()

    def improve(
        self,
        segments: Sequence[Segment],
        X_WB: Pose2,
        contact_points: Sequence[Point],
        guidance: Guidance,
        since_last: float,
        estimates: ParameterEstimates = NOTHING,
        spread: tuple[float, float] = (0.0, 0.0),
    ) -> Replan | None:
        """Better segments from here, or None if no replan is needed.

        Segments are replanned when a contact has slid or the tracking point is off the
        path, unless the new path would be a detour. They are also replanned when the
        virtual axle or the centre of mass is identified away from its planned position.
        ``since_last`` [s] is the time since the last replan, ``spread`` [m], [rad] the
        standard deviations of the pose.
        """
        followed = segments[0]
        left = followed.path.length - guidance.progress
        _, across, heading = guidance.error
        arm = margins.ARM
        place, yaw = spread
        off_path = (
            abs(across) > arm.off_path + place or abs(heading) > arm.off_heading + yaw
        )
        slid = slide(followed.contacts, contact_points) > arm.slid
        moved = axle_error(followed, estimates.axle)
        if not (off_path or slid or moved > arm.off_axle or estimates.elsewhere):
            return None
        if left < arm.least_left or since_last < arm.replan_pause:
            return None
        longest = margins.longest(
            margins.DETOUR, left, self.queries[0].scene.body.radius
        )
        if moved > arm.off_axle:  # the path of another point has another length
            longest += 2.0 * moved
        rest = (rest_of(followed, guidance.progress), *segments[1:])
        replanner = self.believing(estimates.rho)
        planned = followed.contacts
        measured = Measured.touching(X_WB, planned, contact_points, longest, estimates)
        fresh = replanner.replan(rest, measured)
        if not fresh:
            return None
        return _at_speed(fresh, followed.profile)


def _free(query: MotionQuery, segments: Sequence[Segment]) -> bool:
    """Whether segments stay in the workspace and keep clear of obstacles.

    The first segment belongs to the leg of ``query``. Segments must also keep off
    openings and edges at which the object would tip, and must be straight if the object
    serves as a tool.
    """
    if not segments:
        return True
    scene = query.scene
    for segment in segments:
        poses = poses_along(segment)
        if workspace_refusal(scene.body, query.limits, poses) is not None:
            return False
    clearance = query.motion.clearance
    path = swept(scene.body, segments, clearance)
    if scene.obstacles and obstacle_refusal(query, path) is not None:
        return False
    if edge_refusal(scene, clearance, segments) is not None:
        return False
    if scene.support.opening is None and query.tool is None:
        return True
    first = segments[0]
    same_leg = [segment for segment in segments if segment.leg == first.leg]
    poses = swept(scene.body, same_leg, clearance)
    # a fault at the object's present pose is no reason to keep the plan
    here = poses[:1]
    tips = opening_refusal(query, first, poses)
    if tips is not None and opening_refusal(query, first, here) is None:
        return False
    skew = tool_refusal(query, poses)
    return skew is None or tool_refusal(query, here) is not None


def axle_error(segment: Segment, identified: AxleEstimate | None) -> float:
    """Distance [m] between the identified virtual axle and the planned one."""
    if identified is None:
        return 0.0
    X = segment.X_BV
    planned = X.x * math.cos(X.yaw) + X.y * math.sin(X.yaw)
    return abs(identified.axle - planned)


def _at_speed(segments: Sequence[Segment], profile: SpeedProfile) -> Replan:
    """Segments that start at the speed of ``profile``.

    The first path is extended backwards by the length that ``profile`` needs to reach
    this speed from rest.
    """
    ramp = 0.5 * profile.speed * profile.speed / profile.acceleration
    first, *others = segments
    led = first.follows(led_in(first.path, ramp))
    return Replan((led, *others), ramp, profile.speed / profile.acceleration)


def sides_of(body: ObjectModel, contacts: Sequence[Contact]) -> tuple[Side | None, ...]:
    """Side of ``body`` that each contact is on. None for a contact on top."""
    return tuple(
        side_of(body, contact) if contact.kind == "side" else None
        for contact in contacts
    )


def touched_points(
    contacts: Sequence[Contact],
    sides: Sequence[Side | None],
    X_WB: Pose2,
    tips: Sequence[TipState],
) -> tuple[Point, ...]:
    """Points [m] in B at which the tips of ``contacts`` touch the object, by the arms'
    kinematics.

    ``sides`` come from ``sides_of``. The points are projected onto the line of the
    face, the circle of a round side, or the top, so that a tip's measured depth does
    not count as a slide.
    """
    pairs = zip(contacts, sides, strict=True)
    return tuple([touched_point(side, X_WB, tips[c.arm]) for c, side in pairs])


def touched_point(side: Side | None, X_WB: Pose2, tip: TipState) -> Point:
    """Point [m] in B at which a ``tip`` touches a ``side`` of the object. If ``side``
    is None, the tip is on top.
    """
    x, y, _ = tip.position
    point = X_WB.unapply((x, y))
    return point if side is None else side.foot(point)


def surely_touched(
    contacts: Sequence[Contact], contact_points: Sequence[Point], place: float
) -> tuple[Point, ...]:
    """The ``contact_points`` [m] in B of ``contacts``, where they are surely elsewhere
    than planned. ``place`` [m] is the standard deviation of the object's place.
    """
    if place == 0.0:
        return tuple(contact_points)
    near = margins.ARM.slid + margins.DOUBT * place
    pairs = zip(contacts, contact_points, strict=True)
    return tuple(
        point if math.dist(point, contact.point) > near else contact.point
        for contact, point in pairs
    )


def slide(contacts: Sequence[Contact], contact_points: Sequence[Point]) -> float:
    """Largest slide [m] of a contact from its planned place."""
    pairs = zip(contact_points, contacts, strict=True)
    return max(math.dist(point, contact.point) for point, contact in pairs)


def side_slide(contacts: Sequence[Contact], contact_points: Sequence[Point]) -> float:
    """Largest slide [m] of a contact on a side face from its planned place."""
    pairs = zip(contact_points, contacts, strict=True)
    return max(
        (math.dist(p, contact.point) for p, contact in pairs if contact.kind == "side"),
        default=0.0,
    )


def press_creep(contacts: Sequence[Contact], contact_points: Sequence[Point]) -> float:
    """Slide of a single press, as a fraction of its planned distance from the CoM. 0
    for other contacts, and for a press at the CoM.
    """
    contact = contacts[0]
    distance = math.hypot(*contact.point)
    if len(contacts) > 1 or contact.kind == "side" or distance == 0.0:
        return 0.0
    return math.dist(contact.point, contact_points[0]) / distance


def rest_of(segment: Segment, progress: float) -> Segment:
    """Segment along arcs, without the first ``progress`` [m] of its path.

    A segment along any other kind of path is returned unchanged.
    """
    path = segment.path
    if not isinstance(path, ArcPath):
        return segment
    return replace(segment, path=path.rest(min(max(progress, 0.0), path.length)))


def led_in(path: MotionPath, length: float) -> MotionPath:
    """``path`` extended backwards from its start by ``length`` [m]."""
    if isinstance(path, ArcPath):
        return ArcPath(
            advance(path.start, 0.0, -length), ((0.0, length), *path.sections)
        )
    return path.led_in(length)
