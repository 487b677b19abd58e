"""Where a push from the side turns an object about a point of it that is held."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.side_contacts import pushable, span

CORNER = 0.02  # [m] that a push stays away from its face's corners
PLACES = [0.1 * i for i in range(11)]  # on a face, from corner to corner
LEAST_LEVER = 0.03  # [m]
SHORTEST = 0.5  # of the longest lever: places with less are left out


@dataclass(frozen=True, slots=True)
class Lever:
    """A push along the normal of a face."""

    face: Face
    point: Point  # [m] in B
    length: float  # [m] about the held point, > 0


def levers(
    body: ObjectModel, held: Point, side: float, face: int | None = None
) -> list[Lever]:
    """Return places to push that turn ``body`` to ``side`` (1 left, -1 right) about
    ``held`` [m] in B, the longest lever first; only those of the face with index
    ``face`` if that is given.
    """
    out = []
    for candidate in pushable(body, CORNER, face):
        points = [candidate.foot]
        if body.shape.corners:
            right, left = span(body, candidate)
            clear = min(CORNER, 0.5 * (left - right))
            points = [
                on_face(candidate, right + clear + k * (left - right - 2.0 * clear))
                for k in PLACES
            ]
        for point in points:
            length = side * cross(
                (point[0] - held[0], point[1] - held[1]), candidate.normal
            )
            out.append(Lever(candidate, point, length))
    longest = max((lever.length for lever in out), default=0.0)
    good = [
        lever for lever in out if lever.length > max(SHORTEST * longest, LEAST_LEVER)
    ]
    return sorted(good, key=lambda lever: -lever.length)
