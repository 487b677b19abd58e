"""Friction between object and support as a smooth function of the twist: the exact
limit surface of a base with straight edges, in closed form.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pushpressslide.batch import fast
from pushpressslide.kernels.edge_friction import polygon_friction
from pushpressslide.kernels.support_friction import Friction
from pushpressslide.mechanics.face_pressure import FacePressure
from pushpressslide.planar.support_friction import Matrix, Vector


class PolygonFriction:
    """Friction under a polygonal base: the wrench that slides the object, about the
    centre of pressure.

    Below the speed ``CREEP`` the wrench decreases to zero with the speed
    (docs/mechanics.md, section 1.3).
    """

    def __init__(self, face: FacePressure) -> None:
        """Prepare the edges. The limiting friction mu_s N [N] is an argument of each
        call.
        """
        self.rho = face.rho  # [m] root mean square distance
        self._friction = friction_under(face)

    def wrench(self, twist: Vector, limit: float) -> Vector:
        """Wrench (fx, fy [N], tau [N m]) that slides the object with ``twist`` [m/s,
        rad/s], both at the CoP.

        ``limit`` [N] is mu_s N.
        """
        fx, fy, tau, *_ = self._friction(*twist, False)
        return (limit * fx, limit * fy, limit * tau)

    def wrench_and_slope(self, twist: Vector, limit: float) -> tuple[Vector, Matrix]:
        """Wrench, and its derivative with respect to the twist, which is symmetric and
        positive definite.
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


def friction_under(
    face: FacePressure,
) -> Callable[[float, float, float, bool], Friction]:
    """Function that evaluates ``polygon_friction`` of a twist under a face, with or
    without the slope.

    It is compiled only if numba is already loaded, because loading numba takes longer
    than a run would gain. The compiled and the Python version give identical results,
    to the last bit.
    """
    plane = face.plane()
    edges = face.edges()
    series = face.series()
    if fast.loaded():
        from pushpressslide.batch.compiled import call_of

        compiled = call_of(polygon_friction)
        arrays = (np.array(plane), edges, np.array(series))
        return lambda vx, vy, w, sloped: compiled(vx, vy, w, *arrays, sloped)
    rows = tuple(map(tuple, edges.tolist()))
    return lambda vx, vy, w, sloped: polygon_friction(
        vx, vy, w, plane, rows, series, sloped
    )
