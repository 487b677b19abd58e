"""An object pushed on one face by a force anywhere on it, as a car on the exact limit
surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pushpressslide.core.pose import Point
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face

RESOLUTION = 4  # of the base: axle and curvature are right to 0.3 mm and 0.3 %


class Turning(NamedTuple):
    """Turning motion of the object under a force."""

    # [m] ahead of the CoM along the face's normal, of the point without velocity across
    # it
    axle: float
    curvature: float  # [1/m] of that point's path


def on_face(face: Face, left: float) -> Point:
    """Point [m] in B on a face, a distance ``left`` [m] to the left of the line through
    the CoM along the normal.
    """
    n = face.normal
    return (-face.depth * n[0] - left * n[1], -face.depth * n[1] + left * n[0])


class Push(NamedTuple):
    """A force on a face, in the frame of the face's normal and the CoM."""

    face: Face
    left: float  # [m] of the CoM's line along the normal, where it acts
    slope: float  # its part to the left, per part along the normal


def turnings(
    body: ObjectModel, mu: float, height: float, pushes: Sequence[Push]
) -> list[Turning]:
    """Turning motion of the object under each of ``pushes`` at ``height`` [m].

    The pressure under the object is shifted by the push itself. ``mu`` is the friction
    of the pair object/support. Raises ValueError if the object tips, and for a force
    through the CoM, which does not turn the object.
    """
    if any(push.left == 0.0 and push.slope == 0.0 for push in pushes):
        raise ValueError("a force through the CoM does not turn the object")
    normals = np.array([push.face.normal for push in pushes])
    sideways = np.stack([-normals[:, 1], normals[:, 0]], axis=-1)
    slopes = np.array([[push.slope] for push in pushes])
    contacts = np.array([on_face(push.face, push.left) for push in pushes])
    forces = (normals + slopes * sideways) / np.hypot(1.0, slopes)
    slid = DraggedBase(body, height * mu, RESOLUTION).slide(
        np.zeros_like(contacts), contacts, forces
    )
    if np.isnan(slid.twists).any():
        raise ValueError(f"a push at {height * 1e3:.0f} mm tips the object")
    along, across = ((slid.twists[:, :2] * v).sum(1) for v in (normals, sideways))
    w = slid.twists[:, 2]
    return [
        Turning(*of)
        for of in zip((-across / w).tolist(), (w / along).tolist(), strict=True)
    ]
