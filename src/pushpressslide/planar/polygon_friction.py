"""Friction between object and support as a smooth function of the twist: the exact
limit surface of a base with straight edges, in closed form.
"""

from __future__ import annotations

from pushpressslide.batch.edge_loops import row_friction
from pushpressslide.mechanics.face_pressure import FacePressure
from pushpressslide.planar.support_friction import Matrix, Vector


class PolygonFriction:
    """Wrench that slides the object, about the centre of pressure.

    It falls to zero with a speed below ``CREEP`` (docs/mechanics.md, section 1.3).
    """

    def __init__(self, face: FacePressure) -> None:
        """Prepare the edges; the friction's limit mu N [N] is given at each call."""
        self.rho = face.rho  # [m] root mean square distance
        self._friction = row_friction(face)

    def wrench(self, twist: Vector, limit: float) -> Vector:
        """Return (fx, fy [N], tau [N m]) that slides the object with ``twist`` (m/s,
        rad/s), both at the CoP.

        ``limit`` [N] is mu N.
        """
        fx, fy, tau, *_ = self._friction(*twist, False)
        return (limit * fx, limit * fy, limit * tau)

    def wrench_and_slope(self, twist: Vector, limit: float) -> tuple[Vector, Matrix]:
        """Return the wrench and its derivative by the twist, symmetric and positive
        definite.
        """
        fx, fy, tau, xx, xy, xw, yy, yw, ww = self._friction(*twist, True)
        xy = limit * xy
        xw = limit * xw
        yw = limit * yw
        return (limit * fx, limit * fy, limit * tau), [
            [limit * xx, xy, xw],
            [xy, limit * yy, yw],
            [xw, yw, limit * ww],
        ]
