"""Two top contacts: tangential forces inside the friction discs of two presses
(docs/mechanics.md, section 7).

The force components across the line of contacts follow from the wrench. Those along the
line are free of antagonistic shear if they do not have opposite signs.
"""

from __future__ import annotations

from math import inf, sqrt

from pushpressslide.kernels.allocation import (
    EXACT,
    GIVEN,
    INFEASIBLE,
    OK,
    PROJECTED,
    Two,
    Vector,
    Wrench,
)
from pushpressslide.kernels.contact_line import contact_line
from pushpressslide.kernels.elementary import hypotenuse
from pushpressslide.kernels.kernel import kernel

# allowed excess over the discs' radii, as a share: a wrench at the limit of one contact
# is allowed
ROUNDING = 1e-12
NOTHING = 1e-9  # share of a wrench that counts as zero
# square of a force along the line that counts as zero, over those across it
LITTLE = 1e-30

PressPair = tuple[float, float, float, float, float, float, float, float]
"""Two presses: unit vector x, y in B from contact 1 to 2; half of this vector turned
left, x, y; midpoint x, y [m] in B; inverse distance [1/m]; friction.
"""


@kernel
def press_pair(first: Vector, second: Vector, friction: float) -> tuple[PressPair]:
    """Parameters of ``two_presses``."""
    ex, ey, length, middle_x, middle_y = contact_line(first, second)
    per_length = 1.0 / length if length > 0.0 else inf
    return ((ex, ey, -0.5 * ey, 0.5 * ex, middle_x, middle_y, per_length, friction),)


@kernel
def two_presses(
    fx: float,
    fy: float,
    tau: float,
    normals: Vector,
    cop: Vector,
    pair: PressPair,
) -> Two:
    """Allocation of a wrench [N, N m] to two presses with ``normals`` [N], about their
    centre of pressure ``cop`` [m].
    """
    n1, n2 = normals
    cop_x, cop_y = cop
    ex, ey, half_x, half_y, mid_x, mid_y, per_length, friction = pair
    along = ex * fx + ey * fy
    half = half_x * fx + half_y * fy
    turning = (tau - (mid_x - cop_x) * fy + (mid_y - cop_y) * fx) * per_length
    g1 = half - turning
    g2 = half + turning
    most1 = friction * n1
    most2 = friction * n2
    across1 = g1 * g1
    across2 = g2 * g2
    free1 = most1 * most1 - across1
    free2 = most2 * most2 - across2
    if free1 >= 0.0 and free2 >= 0.0:
        room1 = sqrt(free1)
        slack = room1 + sqrt(free2)
        if slack > 0.0 and slack < inf and n1 >= 0.0 and n2 >= 0.0:
            s1 = along * room1 / slack
            s2 = along - s1
            margin = most1 - sqrt(s1 * s1 + across1)
            margin2 = most2 - sqrt(s2 * s2 + across2)
            if margin2 < margin:
                margin = margin2
            # below zero by rounding alone, at the edges of both discs
            if margin >= 0.0 or margin >= -ROUNDING * (most1 + most2):
                f1x = s1 * ex - g1 * ey
                f1y = s1 * ey + g1 * ex
                forces = ((f1x, f1y), (fx - f1x, fy - f1y))
                return forces, normals, margin, OK, EXACT
    return onto_discs((fx, fy, tau), (along, g1, g2), (most1, most2), normals, (ex, ey))


@kernel
def onto_discs(
    wrench: Wrench, parts: Wrench, radii: Vector, normals: Vector, e: Vector
) -> Two:
    """Allocation of a wrench, from its ``line_parts``, scaled onto two friction discs.
    ``e`` is the unit vector from contact 1 to 2.
    """
    fx, fy, tau = wrench
    ex, ey = e
    along, g1, g2 = parts
    n1, n2 = normals
    none = ((0.0, 0.0), (0.0, 0.0))
    size = abs(along) + abs(g1) + abs(g2)
    if not (size + n1 + n2 < inf and n1 >= 0.0 and n2 >= 0.0):
        return none, normals, 0.0, INFEASIBLE, wrench
    most1 = max(radii[0], 0.0)
    most2 = max(radii[1], 0.0)
    rounding = ROUNDING * (most1 + most2)
    most1 = most1 + rounding
    most2 = most2 + rounding
    scale = min(largest_scale(parts, (most1, most2)), 1.0)
    if not scale > NOTHING:
        return none, normals, 0.0, INFEASIBLE, wrench
    g1 = g1 * scale
    room1 = sqrt(max(most1 * most1 - g1 * g1, 0.0))
    slack = room1 + sqrt(max(most2 * most2 - scale * g2 * scale * g2, 0.0))
    s = scale * along * room1 / slack if slack > 0.0 else 0.0
    f1x = s * ex - g1 * ey
    f1y = s * ey + g1 * ex
    f2x = scale * fx - f1x
    f2y = scale * fy - f1y
    margin = min(most1 - hypotenuse(f1x, f1y), most2 - hypotenuse(f2x, f2y))
    lost = 1.0 - scale
    status = OK if lost <= GIVEN else PROJECTED
    residual = (lost * fx, lost * fy, lost * tau)
    return ((f1x, f1y), (f2x, f2y)), normals, margin, status, residual


@kernel
def largest_scale(parts: Wrench, radii: Vector) -> float:
    """Largest factor [0, inf] by which a wrench can be scaled with both contact forces
    inside their friction discs.

    ``parts`` are the (F.e, g_1, g_2) [N] of ``line_parts``, ``radii`` [N] are the radii
    of the discs. If the factor is below 1, the wrench is infeasible.
    """
    along, g1, g2 = parts
    most1, most2 = radii
    x = least_root(most1 * most1, g1 * g1, most2 * most2, g2 * g2, abs(along))
    return inf if x == 0.0 else 1.0 / sqrt(x)


@kernel
def least_root(a1: float, b1: float, a2: float, b2: float, e: float) -> float:
    """Smallest x >= 0 with sqrt(a1 x - b1) + sqrt(a2 x - b2) >= e.

    All arguments are >= 0.
    """
    if (
        (a1 == 0.0 and b1 > 0.0)
        or (a2 == 0.0 and b2 > 0.0)
        or (a1 == 0.0 and a2 == 0.0 and e > 0.0)
    ):
        return inf
    x = max(b1 / a1 if a1 > 0.0 else 0.0, b2 / a2 if a2 > 0.0 else 0.0)
    square = e * e
    if (
        square <= LITTLE * (b1 + b2)
        or sqrt(max(a1 * x - b1, 0.0)) + sqrt(max(a2 * x - b2, 0.0)) >= e
    ):
        return x
    # The smaller root of the quadratic that squaring twice leads to, without
    # cancellation
    root = sqrt(max(a1 * a2 * square + (a1 - a2) * (a2 * b1 - a1 * b2), 0.0))
    numerator = square * (square + 2.0 * (b1 + b2)) + (b1 - b2) * (b1 - b2)
    denominator = square * (a1 + a2) + (a1 - a2) * (b1 - b2) + 2.0 * e * root
    return x if denominator == 0.0 else numerator / denominator
