"""Support of an object that is pressed against a wall and led into an opening."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pushpressslide.core.footprint import depth_beside
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.rom.drives import HeldDrive


def opening_refusal(
    query: MotionQuery, segment: Segment, poses: Sequence[Pose2]
) -> Refusal | None:
    """Refusal of ``poses`` X_WG along a path on which the object would tip into the
    opening, or None.

    The object does not tip as long as the centre of pressure under drag and weight lies
    within the convex hull of the part of the base outside the opening (docs/modes.md).
    The path starts with ``segment``.
    """
    opening = query.scene.support.opening
    shape = query.body.shape
    if opening is None:
        return None
    width, height = opening.size
    margin = 2.0 * query.motion.clearance  # within which an outline counts as going in
    wide = replace(opening, size=(width + margin, height + margin))
    enters = query.scene.enters(query.goal)
    drive = segment.drive
    cop = drive.center
    lever = drive.lever if isinstance(drive, HeldDrive) else 0.0
    for X_WG in poses:
        if enters and wide.holds(X_WG, shape):
            return None
        X_WB = X_WG.compose(query.X_GB)
        wx, wy = X_WB.unrotate(query.scene.weight_along)
        depth = depth_beside(
            shape, X_WG, opening, X_WB.apply((cop[0] - lever * wx, cop[1] - lever * wy))
        )
        if depth < 0.0:
            text = (
                f"the object tips into support.opening at ({X_WG.x:.3f}, "
                f"{X_WG.y:.3f}): the centre of pressure is {{figure:mm.0f}} beyond what "
                "of the base is on the wall; an object that is longer than the opening "
                "is high can be turned into it"
            )
            return Refusal("opening", text, -depth, 0.0, "m")
    return None
