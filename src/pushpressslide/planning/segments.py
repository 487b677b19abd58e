"""Segments of a plan, made from a drive and a path, and the estimated time of a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pushpressslide.core.drive import Drive
from pushpressslide.core.motion import Motion
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Contact, MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import ObjectModel
from pushpressslide.planning.overhead import overhead


def segment(
    query: MotionQuery,
    mode: str,
    contacts: Sequence[Contact],
    drive: Drive,
    path: MotionPath,
    *,
    speed: float | None = None,
    cone_margin: float | None = None,
) -> Segment:
    """Segment to the goal of ``query``, at the speed [m/s] of its motion."""
    motion = query.motion
    profile = SpeedProfile(path.length, speed or motion.speed, motion.acceleration)
    return Segment(mode, tuple(contacts), drive, path, profile, query.goal, cone_margin)


def describe_points(points: Iterable[Point]) -> str:
    """Points [m] in words: "(0.100, 0.000) and (0.200, 0.000)"."""
    return " and ".join(f"({x:z.3f}, {y:z.3f})" for x, y in points)


def run_time(
    motion: Motion, segments: Sequence[Segment], pressed: bool = False
) -> float:
    """Estimated time [s] of a run, including approach and release."""
    moving = sum(segment.profile.duration for segment in segments)
    return moving + overhead(motion, pressed)


def remaining_ends(
    body: ObjectModel, segment: Segment, X_WB: Pose2, X_BV: Pose2
) -> tuple[Pose2, Pose2]:
    """Poses of V at the object's present pose ``X_WB`` and at a segment's goal."""
    goal = segment.goal.compose(body.X_GB).compose(X_BV)
    return X_WB.compose(X_BV), goal
