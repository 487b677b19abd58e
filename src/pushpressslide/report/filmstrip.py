"""The motions of a plan, one by one, as a strip of pictures."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

from pushpressslide.core.plan import Plan, Segment, same_places
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import arm_title
from pushpressslide.report import plane, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACROSS = 3  # pictures in a row
SIZE = 3.6  # [inch] of each
BETWEEN = 3  # footprints between the ends of a motion


def motions(plan: Plan) -> list[tuple[Segment, ...]]:
    """Segments of a plan by leg, without replans."""
    return [
        tuple(part) for _, part in groupby(plan.segments, lambda segment: segment.leg)
    ]


def filmstrip(plan: Plan) -> Figure:
    """One picture for each motion of a plan: its start and end, path and contacts."""
    plan = replace(plan, later=())
    every = motions(plan)
    across = min(ACROSS, len(every))
    rows = math.ceil(len(every) / across)
    made, axes = style.figure(
        rows, SIZE * rows, across=across, width=SIZE * across, share_x=False
    )
    corners = _corners(plan)
    start = plan.task.start
    before: tuple[Segment, ...] | None = None
    for i, (ax, motion) in enumerate(zip(axes, every, strict=False)):
        _picture(ax, plan, motion, start)
        plane.frame(ax, plan.task.scene, corners)
        style.title(ax, f"{i + 1}. {_what(plan, motion, before)}")
        start = motion[-1].goal
        before = motion
    for ax in axes[len(every) :]:
        ax.set_axis_off()
    return made


def _what(
    plan: Plan, motion: tuple[Segment, ...], before: tuple[Segment, ...] | None
) -> str:
    """Caption of a motion: mode and arms, and on a second line the time and whether the
    arms keep their contacts.
    """
    first = motion[0]
    robots = len(plan.task.robots)
    arms = ""
    if robots > 1 and len(first.contacts) == 1:
        arms = f", {arm_title(first.contacts[0].arm, robots)}"
    seconds = sum(segment.profile.duration for segment in motion)
    kept = ""
    if before is not None and same_places(first.contacts, before[-1].contacts):
        kept = ", contacts kept"
    return f"{first.mode}{arms}\n{seconds:.1f} s{kept}"


def _picture(ax: Axes, plan: Plan, motion: tuple[Segment, ...], start: Pose2) -> None:
    shape = plan.task.object.shape
    goal = motion[-1].goal
    poses = _between(plan, motion)
    plane.surroundings(ax, plan.task.scene)
    plane.footprints(ax, shape, poses, style.SKY, "")
    plane.footprint(ax, shape, start, style.BLACK, "", fill=True)
    plane.footprint(ax, shape, goal, style.GREEN, "", fill=True)
    plane.planned_paths(ax, [segment.path for segment in motion])
    alone = replace(plan, segments=motion)
    plane.contacts(ax, [(alone, start.compose(plan.task.X_GB))])


def _between(plan: Plan, motion: tuple[Segment, ...]) -> list[Pose2]:
    """Evenly spaced poses X_WG along a motion."""
    shares = [(k + 1) / (BETWEEN + 1) for k in range(BETWEEN)]
    return [
        plan.object_pose(segment, share * segment.path.length)
        for segment in motion
        for share in shares[:: len(motion)]
    ]


def _corners(plan: Plan) -> list[Point]:
    """Corners of the footprints [m] on all motions."""
    poses = [plan.task.start, *(segment.goal for segment in plan.segments)]
    for motion in motions(plan):
        poses += _between(plan, motion)
    shape = plan.task.object.shape
    return [corner for pose in poses for corner in plane.outline(shape, pose)]
