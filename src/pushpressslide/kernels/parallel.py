"""Two pushes on one face: the friction force is shared in the ratio of the normal forces
(docs/mechanics.md, section 5).
"""

from __future__ import annotations

from math import copysign

from pushpressslide.kernels.allocation import EXACT, OK, Two, Vector
from pushpressslide.kernels.contact_line import contact_line, line_parts
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.two_contacts import (
    Linear,
    Rest,
    two_contact_figures,
    two_contacts,
)
from pushpressslide.kernels.wrench_cone import Points

Face = tuple[float, float, float, float, float, float, float, float]
"""Two contacts on one face: normal force of contact 1 per fx, fy and tau; normal x, y;
friction; caps [N].
"""


@kernel
def parallel_figures(
    points: Points,
    normal: Vector,
    frictions: Vector,
    caps: Vector,
    choices: Vector,
) -> tuple[Face, tuple[Linear, Rest]]:
    """Parameters of ``parallel_pushes``, with the arguments of ``two_contact_figures``."""
    line = contact_line(points[0], points[1])
    nx, ny = normal
    sign = copysign(1.0, line[0] * ny - line[1] * nx)
    origin = (0.0, 0.0)
    x = sign * line_parts(1.0, 0.0, 0.0, line, origin)[1]
    y = sign * line_parts(0.0, 1.0, 0.0, line, origin)[1]
    t = sign * line_parts(0.0, 0.0, 1.0, line, origin)[1]
    general = two_contact_figures(points, (normal, normal), frictions, caps, choices)
    return (x, y, t, nx, ny, frictions[0], caps[0], caps[1]), general


@kernel
def parallel_pushes(
    fx: float, fy: float, tau: float, face: Face, general: tuple[Linear, Rest]
) -> Two:
    """Allocation of a wrench [N, N m] about B's origin. Wrenches that this split cannot
    realise are passed to ``two_contacts``.
    """
    x, y, t, nx, ny, friction, cap1, cap2 = face
    push = nx * fx + ny * fy
    slide = nx * fy - ny * fx
    f1n = x * fx + y * fy + t * tau
    f2n = push - f1n
    margin = friction * push - (slide if slide > 0.0 else -slide)
    if push > 0.0 and margin >= 0.0 and 0.0 <= f1n <= cap1 and 0.0 <= f2n <= cap2:
        share = f1n / push
        f1x = share * fx
        f1y = share * fy
        lower = share if share < 0.5 else 1.0 - share
        forces = ((f1x, f1y), (fx - f1x, fy - f1y))
        return forces, (f1n, f2n), lower * margin, OK, EXACT
    linear, rest = general
    return two_contacts(fx, fy, tau, linear, rest)
