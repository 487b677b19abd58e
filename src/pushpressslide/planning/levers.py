"""Pushes from the side that turn an object about a point fixed to it."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.core import margins
from pushpressslide.core.pose import Point, cross
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.side_contacts import pushable

PLACES = [0.1 * i for i in range(11)]  # on a face, from corner to corner


@dataclass(frozen=True, slots=True)
class Lever:
    """A push along the normal of a face."""

    face: Face
    point: Point  # [m] in B
    length: float  # [m] about the held point, > 0


def levers(
    scene: Scene, pivot: Point, side: float, height: float, face: int | None = None
) -> list[Lever]:
    """Pushes at ``height`` [m] that turn the object to ``side`` (1 left, -1 right)
    about ``pivot`` [m] in B, the longest lever first.

    With ``face``, only pushes on the face with that index.
    """
    body = scene.body
    inset = scene.inset
    out = []
    for candidate in pushable(scene, height, face):
        points = [candidate.foot]
        if candidate.flat:
            right, left = candidate.ends
            clear = min(inset, 0.5 * (left - right))
            points = [
                on_face(candidate, right + clear + k * (left - right - 2.0 * clear))
                for k in PLACES
            ]
        for point in points:
            length = side * cross(
                (point[0] - pivot[0], point[1] - pivot[1]), candidate.normal
            )
            out.append(Lever(candidate, point, length))
    longest = max((lever.length for lever in out), default=0.0)
    lower = max(margins.LEVER_SHARE * longest, margins.LEAST_LEVER * body.radius)
    good = [lever for lever in out if lever.length > lower]
    return sorted(good, key=lambda lever: -lever.length)
