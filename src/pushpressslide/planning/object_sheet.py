"""The parts of an object that the tips of a scene can use: base, side and top."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from shapely import Polygon

from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.geometry.areas import inner_radius, polygons
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.touchable import Touchable, total_length
from pushpressslide.mechanics.faces import room_ahead
from pushpressslide.mechanics.top import top_places
from pushpressslide.planning.side_contacts import (
    lone_contact_height,
    pushable,
    untouchable,
)

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry as Area

WHOLE = 0.95
"""Share of the outline seen from above that a part must cover to count as the whole
outline.
"""
HOLE = 0.05
"""Share of a base's area above which a hole makes the base a ring."""


@dataclass(frozen=True)
class ObjectSheet:
    """Base, side and top of an object."""

    base_kind: str  # whole, smaller, ring or feet, beside the outline from above
    base_patches: int
    base_share: float  # of the outline's area
    base_area: float  # [m^2]
    base_size: tuple[float, float]  # [m] of the base's bounds in G
    standing: float  # [m] of the centre of mass inside the base
    push_height: float  # [m] of a tip that pushes
    touched: tuple[Touchable, ...]  # parts of the side that the tip can touch there
    touched_share: float  # of the side's length
    lean: float  # [rad] of the most upright side
    no_push: Refusal | None  # None if the tip can push some side
    press_height: float | None  # [m]; None if there is no place to press
    press_places: tuple[Point, ...]  # [m] in B, examples
    press_radius: float  # [m] of the largest disc in the level patch on top


def object_sheet(scene: Scene, motion: Motion) -> ObjectSheet:
    """Base, side and top of the scene's object, for the tips of its robots."""
    body = scene.body
    shape = body.shape
    height = lone_contact_height(scene, motion)
    lean = margins.side_lean(scene.contact_friction)
    section = shape.section(height, lean)
    touched = section.touchable(scene.tip_radius)
    length = sum(side.length for side in section.border.sides)
    xs, ys = zip(*shape.base_corners, strict=True)
    places = tuple(top_places(body, scene.inset))
    kind, patches = _base_kind(shape)
    return ObjectSheet(
        kind,
        patches,
        shape.base_area / float(shape.placed(Pose2()).area),
        shape.base_area,
        (max(xs) - min(xs), max(ys) - min(ys)),
        shape.base_depth(body.center_of_mass),
        height,
        touched,
        total_length(touched) / length,
        section.least_lean(scene.tip_radius),
        _no_push(scene, height),
        shape.top_height if shape.has_top(scene.inset) else None,
        places,
        inner_radius(top_region(shape)),
    )


def _base_kind(shape: Shape) -> tuple[str, int]:
    """Kind of a base, and the number of its patches."""
    area = base_region(shape)
    patches = list(polygons(area))
    if len(patches) > 1:
        return "feet", len(patches)
    if any(Polygon(hole).area > HOLE * area.area for hole in patches[0].interiors):
        return "ring", 1
    whole = shape.placed(Pose2()).area
    return ("whole" if area.area >= WHOLE * whole else "smaller"), 1


def base_region(shape: Shape) -> Area:
    """Region of G in which the object touches the support."""
    return shape.base if isinstance(shape, MeshBody) else shape.placed(Pose2())


def top_region(shape: Shape) -> Area | None:
    """Region of G of the level patch on top, or None."""
    if not isinstance(shape, MeshBody):
        return shape.placed(Pose2())
    return None if shape.top is None else shape.top.area


def _no_push(scene: Scene, height: float) -> Refusal | None:
    """Refusal of a push at a height [m] on any side, or None."""
    sides = pushable(scene, height)
    if not sides:
        return untouchable(scene, height)
    ahead = max(room_ahead(scene.body, side) for side in sides)
    share = 1.0 - margins.PUSH_TIPPING_MARGIN
    highest = math.inf
    if scene.support.friction > 0.0:
        highest = share * ahead / scene.support.friction
    if height <= highest:
        return None
    text = "it tips or rolls over: touched at {figure:mm.0f}, allowed up to {allowed:mm.0f}"
    return Refusal("tipping", text, height, highest, "m")
