"""Contact forces, their total wrench, and the mobility of a contact point.

Source: docs/mechanics.md, sections 0 and 2. Points and forces are in one planar frame:
the body frame B, unless stated otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Wrench
from pushpressslide.kernels import pushing

Matrix2 = tuple[tuple[float, float], tuple[float, float]]


def wrench_of_forces(
    points: Sequence[Point], forces: Sequence[Point], about: Point = (0.0, 0.0)
) -> Wrench:
    """Wrench of ``forces`` [N] on the object at ``points`` [m], with the moment about
    the point ``about`` [m].

    Raises ValueError for unequal lengths.
    """
    if len(points) != len(forces):
        raise ValueError(
            f"{len(points)} points and {len(forces)} forces; need one force per point"
        )
    fx = fy = tau = 0.0
    for p, f in zip(points, forces, strict=True):
        fx += f[0]
        fy += f[1]
        tau += cross((p[0] - about[0], p[1] - about[1]), f)
    return Wrench(fx, fy, tau, about)


def least_norm_forces(points: Sequence[Point], wrench: Wrench) -> tuple[Point, ...]:
    """Forces [N] at ``points`` [m] that add up to ``wrench``, with the smallest sum of
    squares.

    Each force is an equal share of the total plus a part that turns about the mean
    point: f_i = F/k + g J (p_i - p_mean). Friction cones are ignored. Raises ValueError
    for fewer than two distinct points, which cannot provide every moment.
    """
    k = len(points)
    if k == 0:
        raise ValueError("no contact point; need at least two")
    mean = (sum(p[0] for p in points) / k, sum(p[1] for p in points) / k)
    arms = [(p[0] - mean[0], p[1] - mean[1]) for p in points]
    spread = sum(a[0] * a[0] + a[1] * a[1] for a in arms)
    if spread == 0.0:
        raise ValueError("contact points coincide; need at least two distinct ones")
    g = wrench.moved_to(mean).tau / spread
    return tuple((wrench.fx / k - g * a[1], wrench.fy / k + g * a[0]) for a in arms)


def contact_mobility(lever: Point, rho: float) -> Matrix2:
    """Mobility G = I + (J r)(J r)^T / rho^2 of a contact on the ellipsoid.

    A contact force f moves its point with a velocity v_c ~ G f. ``lever`` r [m] is the
    contact relative to the centre of pressure (docs/mechanics.md, section 2).
    """
    a = -lever[1] / rho
    b = lever[0] / rho
    return ((1.0 + a * a, a * b), (a * b, 1.0 + b * b))


def velocity_of_force(lever: Point, rho: float, force: Point) -> Point:
    """Vector G f along the velocity of the contact point under a ``force`` f [N].

    Its length is not a speed; on the same scale the velocity of the CoP is f.
    """
    return pushing.velocity_of_force(lever, rho, force)


def force_of_velocity(lever: Point, rho: float, velocity: Point) -> Point:
    """Vector G^-1 v_c, along the force of a sticking contact that moves with
    ``velocity``.

    Its length is not that of the force, which results from scaling it onto the limit
    surface.
    """
    return pushing.force_of_velocity(lever, rho, velocity)
