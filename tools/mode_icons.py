"""Draw the six contact modes as a row of icons, from plans of shipped tasks.

    python tools/mode_icons.py docs/figures

Grey: the object; circles: pushes, dots: presses; arrows: the forces that begin the
motion, by the mode's own allocator; dashed: the virtual axle or the tracked point; pale:
where the object is a little later.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

import pushpressslide as pps
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.modes import MODES
from pushpressslide.report import style

SHOWN = {  # what a mode does, by the task that shows it
    "rear-push-rear": "one arm pushes",
    "press-slide-car": "one arm presses and drags",
    "parallel-push": "two arms push side by side",
    "orthogonal-push": "two arms push at an angle",
    "bimanual-slide": "two arms press and drag",
    "pivot": "one arm presses, one pushes",
}
AHEAD = 0.35  # of the object's radius, that it has gone on in the pale outline
LONGEST = 0.75  # of the radius, of the largest force's arrow
SPEED = 0.05  # [m/s] with which the motion begins


def drawn() -> Any:
    """Return the row of icons."""
    made, panels = style.figure(
        height=1.9, across=len(SHOWN), width=10.5, share_x=False
    )
    for axes, (name, what) in zip(panels, SHOWN.items(), strict=True):
        icon(axes, pps.plan(pps.load_task(name)))
        axes.text(0.5, -0.02, what, fontsize=8, ha="center", transform=axes.transAxes)
    return made


def icon(axes: Any, plan: Plan) -> None:
    """Draw the beginning of a plan in the body frame, scaled by the object's radius."""
    task = plan.task
    segment = plan.segments[0]
    radius = task.object.radius
    X_BG = task.X_GB.inverse()
    corners = np.array([X_BG.apply(p) for p in task.object.shape.corners]) / radius
    later = _later(segment, radius)
    moved = [later.apply(tuple(p)) for p in corners]
    axes.fill(*np.transpose(moved), color=style.GREY, alpha=0.2, lw=0)
    axes.fill(*np.transpose(corners), color=style.GREY, alpha=0.55, lw=0)
    forces = _forces(task, segment)
    largest = max(math.hypot(*force) for force in forces)
    for contact, force in zip(segment.contacts, forces, strict=True):
        place = np.array(contact.point) / radius
        pressed = contact.kind == "top"
        axes.plot(
            *place,
            "o",
            ms=8,
            mfc=style.BLUE if pressed else "white",
            mec=style.BLUE,
            mew=1.8,
        )
        arrow = LONGEST * np.array(force) / largest
        foot = place if pressed else place - arrow
        axes.annotate(
            "",
            xy=foot + arrow,
            xytext=foot,
            arrowprops={"arrowstyle": "-|>", "color": style.ORANGE, "lw": 1.8},
        )
    _axle(axes, segment.X_BV, radius)
    axes.set_title(segment.mode, fontsize=9, family="monospace")
    axes.set_aspect("equal")
    axes.set_xlim(-2.0, 2.0)
    axes.set_ylim(-1.5, 1.5)
    axes.axis("off")


def _later(segment: Segment, radius: float) -> Pose2:
    """Return the pose in B, in radii, that the object goes on to first."""
    start = segment.body_pose(0.0)
    s = 0.0
    while s < segment.path.length:
        s += 0.002
        seen = start.inverse().compose(segment.body_pose(s))
        if math.hypot(seen.x, seen.y) + radius * abs(seen.yaw) > AHEAD * radius:
            break
    return Pose2(seen.x / radius, seen.y / radius, seen.yaw)


def _forces(task: pps.Task, segment: Segment) -> list[tuple[float, float]]:
    """Return the forces in B that the mode's law and allocator ask for at the start."""
    mode = MODES[segment.mode]
    tracker = mode.tracker(task.query, segment)
    X_WB = segment.body_pose(0.0)
    wrench = tracker.step(segment.path, X_WB, 0.0, SPEED, 1.0).wrench
    allocate = mode.allocator_of(segment, task.scene.contact_friction)
    return list(allocate(wrench.fx, wrench.fy, wrench.tau).forces)


def _axle(axes: Any, X_BV: Pose2, radius: float) -> None:
    """Draw the virtual axle, across the vehicle's heading."""
    place = np.array(X_BV.position) / radius
    across = np.array(X_BV.rotate((0.0, 0.55)))
    ends = np.array([place - across, place + across])
    axes.plot(*ends.T, "--", color=style.GREEN, lw=1.6)
    axes.plot(*place, ".", color=style.GREEN, ms=7)


if __name__ == "__main__":
    (folder,) = sys.argv[1:]
    Path(folder, "modes.png").write_bytes(style.png(drawn()))
