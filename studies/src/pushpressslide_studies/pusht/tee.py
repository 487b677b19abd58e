"""The T of gym-pusht as an object: outline, limit surface, faces, goal.

The unit of length is one pixel. The frame T is that of the package, at the middle of
the bar's long edge. Frame B has the same axes, and its origin at the centre of mass.

In the package no velocity carries over from step to step, so the mass matrix (mass 1,
moment of inertia 3000 px^2) takes the place of the limit surface: the twist is along
(fx, fy, tau / rho^2) with rho^2 = 3000 px^2. Contacts have no friction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point, Pose2, turned_left
from pushpressslide.core.task import ObjectModel
from pushpressslide.geometry.shapes import Prism
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

WORLD = 512.0  # [px] side of the square in which the pusher may be sent anywhere
WALLS = (7.0, 504.0)  # [px] inner faces of the walls, in x and in y
PUSHER_RADIUS = 15.0  # [px]
RHO = math.sqrt(3000.0)  # [px]
CENTER = (0.0, 45.0)  # [px] centre of mass in T
GOAL = Pose2(256.0, 256.0, 0.25 * math.pi)  # X_WT
OUTLINE = (
    (-60.0, 0.0),
    (60.0, 0.0),
    (60.0, 30.0),
    (15.0, 30.0),
    (15.0, 120.0),
    (-15.0, 120.0),
    (-15.0, 30.0),
    (-60.0, 30.0),
)  # [px] corners in T, counter-clockwise
CORNERS = tuple((x - CENTER[0], y - CENTER[1]) for x, y in OUTLINE)  # [px] in B
BODY = ObjectModel(Prism(OUTLINE, 1.0), 1.0, CENTER)
SURFACE = EllipsoidLimitSurface(1.0, RHO)
CLEARANCE = 3.0  # [px] of a contact from the ends of what can be touched of a face


@dataclass(frozen=True, slots=True)
class PushedFace:
    """A face of the T that the pusher can touch."""

    face: Face
    right: float  # [px] least and greatest place of a contact, to the left of the line
    left: float  # through the centre of mass along the inward normal

    @property
    def normal(self) -> Point:
        """Inward normal in B."""
        return self.face.normal

    def contact(self, left: float) -> Point:
        """Point [px] in B on the face, at ``left`` [px] of the line through the centre."""
        return on_face(self.face, left)

    def pusher(self, left: float, gap: float = 0.0) -> Point:
        """The pusher's centre [px] in B, at a distance ``gap`` [px] from the face."""
        x, y = self.contact(left)
        away = PUSHER_RADIUS + gap
        return (x - away * self.normal[0], y - away * self.normal[1])

    def place(self, pusher: Point) -> float:
        """Offset [px] to the left at which a pusher at a point in B touches the face."""
        along = turned_left(self.normal)
        return pusher[0] * along[0] + pusher[1] * along[1]

    def clipped(self, left: float) -> float:
        """Nearest offset [px] at which the pusher may touch the face."""
        return min(max(left, self.right), self.left)


def _pushed(face: Face) -> PushedFace:
    right, left = face.ends
    return PushedFace(face, right + CLEARANCE, left - CLEARANCE)


FACES = tuple(_pushed(face) for face in faces(BODY, CLEARANCE, PUSHER_RADIUS))


def body_pose(X_WT: Pose2) -> Pose2:
    """Pose X_WB of the frame at the centre of mass."""
    x, y = X_WT.apply(CENTER)
    return Pose2(x, y, X_WT.yaw)


GOAL_BODY = body_pose(GOAL)  # X_WB


def overlap(X_WB: Pose2) -> float:
    """Share of the goal's area that the T covers."""
    from shapely import Polygon

    goal = Polygon([GOAL_BODY.apply(corner) for corner in CORNERS])
    placed = Polygon([X_WB.apply(corner) for corner in CORNERS])
    return float(goal.intersection(placed).area / goal.area)
