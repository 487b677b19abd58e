"""Support of an object along its path near the edge of a table.

Source: docs/mechanics.md, section 1.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.footprint import edge_depths
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.pressing import resting_cop
from pushpressslide.planning.free_space import lengths_from
from pushpressslide.planning.swept import swept

if TYPE_CHECKING:
    from shapely import Polygon

ROUND_OFF = 1e-6  # [m]


def edge_refusal(
    scene: Scene, clearance: float, segments: Sequence[Segment]
) -> Refusal | None:
    """Refusal of planned segments on which the object would tip over the edge of
    ``support.region``, or None.

    The object does not tip as long as the centre of pressure is inside the convex hull
    of the supported part of the base, with a margin. Three points are checked: the
    centre of mass, which carries the load when the arms let go, and the centres of
    pressure under the press and under the drag. If the object starts with less than the
    margin, its initial distance is allowed there; the required distance then grows to
    the full margin over ``margins.ARM.leaving`` [m].
    """
    from shapely import Polygon

    if scene.support.region is None:
        return None
    region = Polygon(scene.support.region)
    first = None
    for segment in segments:
        poses = swept(scene.body, [segment], clearance)
        first = first or poses[0]
        refusal = _segment_refusal(scene, segment, poses, first, region)
        if refusal is not None:
            return refusal
    return None


def _segment_refusal(
    scene: Scene,
    segment: Segment,
    poses: Sequence[Pose2],
    first: Pose2,
    region: Polygon,
) -> Refusal | None:
    """Refusal of one of the segments if it tips the object, or None.

    The segments start at the pose ``first``.
    """
    shape = scene.body.shape
    margin = margins.EDGE_MARGIN * shape.half_width
    start = np.array([first.apply(scene.body.center_of_mass)])
    there = min(float(edge_depths(shape, [first], start, region)[0]), margin)
    far = lengths_from(shape, first, poses)
    share = np.minimum(far / margins.ARM.leaving, 1.0)
    allowed = there + (margin - there) * share - ROUND_OFF
    for points in _loads(scene, segment, poses):
        depths = edge_depths(shape, poses, points, region)
        worst = int((depths - allowed).argmin())
        depth = float(depths[worst])
        least = float(allowed[worst])
        if depth < least:
            X = poses[worst]
            inside = "{figure:mm.0f} inside" if depth > 0.0 else "beyond"
            text = (
                "the object tips over the edge of support.region at "
                f"({X.x:.3f}, {X.y:.3f}): the centre of pressure is {inside} it, "
                "allowed from {allowed:mm.0f}"
            )
            return Refusal("edge", text, depth, least, "m")
    return None


def _loads(
    scene: Scene, segment: Segment, poses: Sequence[Pose2]
) -> tuple[Array, Array, Array]:
    """Load points (n, 2) [m] at n poses X_WG: without a press, with a press at rest,
    and with drag.

    A drag mu_s N at a height h moves the load ahead by mu_s h. While the object turns,
    the net force is smaller.
    """
    X_GB = scene.body.X_GB
    bodies = [X.compose(X_GB) for X in poses]
    presses = [contact for contact in segment.contacts if contact.kind == "top"]
    cop = resting_cop(scene, presses)
    alone = np.array([X.position for X in bodies])
    pressed = np.array([X.apply(cop) for X in bodies])
    steps = np.diff(pressed, axis=0, append=2.0 * pressed[-1:] - pressed[-2:-1])
    turns = np.diff(np.unwrap([X.yaw for X in bodies]))
    rho = segment.drive.rho or scene.body.shape.inner_radius
    turned = rho * np.append(turns, turns[-1:])
    whole = np.maximum(np.sqrt((steps**2).sum(1) + turned**2), 1e-12)
    height = max(contact.height for contact in segment.contacts)
    ahead = scene.support.friction * height * steps / whole[:, None]
    return alone, pressed, pressed + ahead
