"""The motion of a body on its support under compliant tips: the twist at which all
forces balance.

A tick is quasi-static (docs/mechanics.md, sections 1 to 3): it takes into account the
friction of the support and contacts that stick, slip or separate, but no inertia.
Everything is in frame B, about the centre of pressure. The laws of the support and of
the contacts are also kernels, passed as ``laws``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt
from typing import Any

from pushpressslide.kernels.compliant_tip import FREE, Touch
from pushpressslide.kernels.edge_friction import FASTEST
from pushpressslide.kernels.kernel import kernel, kernel_apart
from pushpressslide.kernels.support_friction import CREEP, Friction

BALANCE = 1e-9  # unbalanced force at which a tick is solved, as a share of mu N
# unbalanced force below which Newton's slope is used twice, as a share of mu N
CLOSE = 0.1
# largest unbalanced force after a second step with one slope, as a share of that at
# balance
SURE = 0.01
STEPS = 25  # of Newton's method
HALVINGS = 40  # halvings of a step that is too long
# share of friction over speed that is added to its slope, which is zero along the
# motion
SOFTENING = 1e-6
# [m/s] speed with a drag of mu N, if balance is found by releasing the body
DRAG_SPEED = 0.01
TRIALS = 60

STATUSES = 8  # more than a contact has

Triple = tuple[float, float, float]
"""A twist [m/s, rad/s], or a force [N] and moment [N m], of the centre of pressure."""
Matrix = tuple[Triple, Triple, Triple]
Drag = tuple[float, Triple]
"""A drag coefficient [N s/m], and the twist towards which the drag acts."""
Support = tuple[Any, float, float]
"""Description of the support for ``Laws``, mu_s N [N], and rho [m]."""
Laws = tuple[
    Callable[[float, float, float, Any, float, bool], Friction],
    Callable[[float, float, float, Any], Touch],
]
"""Two functions.

The first returns the friction for a twist, a description of the support and mu_s N [N];
it may omit the slope unless its last argument is true. The second returns the reaction
of a contact to a twist.
"""
REST = (0.0, 0.0, 0.0)
FREED: Drag = (0.0, REST)


@kernel_apart
def slide(
    guess: Triple, contacts: Sequence[Any], support: Support, laws: Laws
) -> Triple:
    """Twist [m/s, rad/s] at which the forces of the support and of ``contacts``
    balance, to 1e-9 of mu_s N.

    ``guess`` is the twist of the previous tick, from which Newton's method starts. At
    rest the body creeps, by less than a few times ``CREEP``. Close to balance, the last
    two Newton steps share one slope if no contact changes its status. If the method
    fails, the body is released from rest against a drag, which is reduced until the
    body moves in balance; this gives the motion that the body would really take up. The
    search ends after ``TRIALS`` attempts even without balance.
    """
    touched = False
    for contact in contacts:
        if laws[1](0.0, 0.0, 0.0, contact)[2] != FREE:
            touched = True
            break
    if not touched:
        return REST
    found, twist = solved(guess, FREED, contacts, support, laws)
    if found:
        return twist
    return let_go(contacts, support, laws)


@kernel_apart
def let_go(contacts: Sequence[Any], support: Support, laws: Laws) -> Triple:
    """Balanced twist of a body released from rest."""
    twist = REST
    drag = support[1] / DRAG_SPEED
    for _ in range(TRIALS):
        found, stepped = solved(twist, (drag, twist), contacts, support, laws)
        if not found:
            drag = 4.0 * drag
            continue
        twist = stepped
        drag = 0.5 * drag
        found, balanced = solved(twist, FREED, contacts, support, laws)
        if found:
            return balanced
    return twist


@kernel_apart
def solved(
    start: Triple, drag: Drag, contacts: Sequence[Any], support: Support, laws: Laws
) -> tuple[bool, Triple]:
    """Whether Newton's method reaches balance from a twist, and the final twist."""
    _, limit, rho = support
    twist = start
    force, slope = left_over_and_slope(twist, drag, contacts, support, laws)
    for _ in range(STEPS):
        size = size_of(force, rho)
        if size < BALANCE * limit:
            return is_motion(twist), twist
        regular, step = newton_step(slope, force)
        if not regular:
            return False, twist
        end = stepped(twist, step, 1.0)
        if size < CLOSE * limit:
            found, last = ended(end, (size, slope), drag, contacts, support, laws)
            if found:
                return True, last
        twist = end
        ahead, slope = left_over_and_slope(twist, drag, contacts, support, laws)
        if too_far(ahead, force, step, rho):
            twist = shortened(twist, (force, step), drag, contacts, support, laws)
            ahead, slope = left_over_and_slope(twist, drag, contacts, support, laws)
        force = ahead
    return False, twist


@kernel_apart
def left_over_and_slope(
    twist: Triple, drag: Drag, contacts: Sequence[Any], support: Support, laws: Laws
) -> tuple[Triple, Matrix]:
    """Unbalanced force [N] and moment [N m], and their derivative with respect to the
    twist.
    """
    vx, vy, w = twist
    surface, limit, rho = support
    friction, touch = laws
    taken = friction(vx, vy, w, surface, limit, True)
    fx, fy, tau, x_x, x_y, x_w, y_y, y_w, w_w = taken
    fx, fy, tau = dragged((fx, fy, tau), twist, drag, rho)
    y_x = x_y
    w_x = x_w
    w_y = y_w
    for contact in contacts:
        (gx, gy), (xx, xy, yx, yy), status, point, center = touch(vx, vy, w, contact)
        if status == FREE:
            continue
        px, py = point
        qx, qy = center
        fx = fx - gx
        fy = fy - gy
        tau = tau - px * gy + py * gx
        xw = xy * qx - xx * qy
        yw = yy * qx - yx * qy
        x_x += xx
        x_y += xy
        x_w += xw
        y_x += yx
        y_y += yy
        y_w += yw
        w_x += px * yx - py * xx
        w_y += px * yy - py * xy
        w_w += px * yw - py * xw
    turn = rho * rho
    soft = drag[0] + SOFTENING * limit / (
        sqrt(vx * vx + vy * vy + turn * w * w) + CREEP
    )
    slope = (
        (x_x + soft, x_y, x_w),
        (y_x, y_y + soft, y_w),
        (w_x, w_y, w_w + soft * turn),
    )
    return (fx, fy, tau), slope


@kernel_apart
def left_over(
    twist: Triple, drag: Drag, contacts: Sequence[Any], support: Support, laws: Laws
) -> tuple[Triple, int]:
    """Unbalanced force [N] and moment [N m], and a number that encodes the statuses of
    all contacts.
    """
    vx, vy, w = twist
    surface, limit, rho = support
    friction, touch = laws
    taken = friction(vx, vy, w, surface, limit, False)
    fx, fy, tau = dragged((taken[0], taken[1], taken[2]), twist, drag, rho)
    statuses = 0
    for contact in contacts:
        (gx, gy), _, status, (px, py), _ = touch(vx, vy, w, contact)
        fx = fx - gx
        fy = fy - gy
        tau = tau - px * gy + py * gx
        statuses = STATUSES * statuses + status
    return (fx, fy, tau), statuses


@kernel
def statuses_of(
    twist: Triple,
    contacts: Sequence[Any],
    touch: Callable[[float, float, float, Any], Touch],
) -> int:
    """Number that encodes the statuses of all contacts, as in ``left_over``."""
    vx, vy, w = twist
    statuses = 0
    for contact in contacts:
        statuses = STATUSES * statuses + touch(vx, vy, w, contact)[2]
    return statuses


@kernel
def dragged(wrench: Triple, twist: Triple, drag: Drag, rho: float) -> Triple:
    """Wrench [N, N m] of friction and drag."""
    size, (vx, vy, w) = drag
    if size == 0.0:
        return wrench
    turn = size * (twist[2] - w)
    return (
        wrench[0] + size * (twist[0] - vx),
        wrench[1] + size * (twist[1] - vy),
        wrench[2] + rho * rho * turn,
    )


@kernel_apart
def ended(
    twist: Triple,
    before: tuple[float, Matrix],
    drag: Drag,
    contacts: Sequence[Any],
    support: Support,
    laws: Laws,
) -> tuple[bool, Triple]:
    """Whether force and friction balance near ``twist``, and the twist at which they
    do.

    One Newton step led to ``twist``; ``before`` holds the remaining force [N] and the
    slope before this step. If the contacts keep their status, another step with the
    same slope leaves about twice the fraction of the force that the first step left.
    """
    _, limit, rho = support
    past, slope = before
    ahead, statuses = left_over(twist, drag, contacts, support, laws)
    size = size_of(ahead, rho)
    allowed = BALANCE * limit
    if size < allowed:
        return is_motion(twist), twist
    if 2.0 * size * size > SURE * allowed * past:
        return False, twist
    regular, step = newton_step(slope, ahead)
    if not regular:
        return False, twist
    end = stepped(twist, step, 1.0)
    return statuses_of(end, contacts, laws[1]) == statuses, end


@kernel_apart
def shortened(
    end: Triple,
    led: tuple[Triple, Triple],
    drag: Drag,
    contacts: Sequence[Any],
    support: Support,
    laws: Laws,
) -> Triple:
    """Twist along the step to ``end`` at which little force along the step remains, by
    bisection.

    ``led`` are the force before the step, and the step itself.
    """
    force, step = led
    rho = support[2]
    low = -1.0
    high = 0.0
    twist = end
    for _ in range(HALVINGS):
        share = 0.5 * (low + high)
        twist = stepped(end, step, share)
        ahead, _ = left_over(twist, drag, contacts, support, laws)
        if too_far(ahead, force, step, rho):
            high = share
        elif too_near(ahead, force, step, rho):
            low = share
        else:
            break
    return twist


@kernel
def is_motion(twist: Triple) -> bool:
    """Whether a twist is finite, and small enough that its square does not overflow."""
    return dot(twist, twist) <= FASTEST


@kernel
def too_far(ahead: Triple, force: Triple, step: Triple, rho: float) -> bool:
    """Whether a step overshoots balance: the remaining force points backward, with more
    than half the size of the original force.
    """
    on = -dot(force, step)
    return (
        on > 0.0
        and 2.0 * dot(ahead, step) > on
        and 2.0 * size_of(ahead, rho) > size_of(force, rho)
    )


@kernel
def too_near(ahead: Triple, force: Triple, step: Triple, rho: float) -> bool:
    """Whether a step falls short of balance: the remaining force points forward, with
    more than half the size of the original force.
    """
    return 2.0 * dot(ahead, step) < dot(force, step) and 2.0 * size_of(
        ahead, rho
    ) > size_of(force, rho)


@kernel
def size_of(force: Triple, rho: float) -> float:
    """Size [N] of a force and a moment, which is divided by rho."""
    turning = force[2] / rho
    return sqrt(force[0] * force[0] + force[1] * force[1] + turning * turning)


@kernel
def dot(a: Triple, b: Triple) -> float:
    """Dot product of two triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def stepped(twist: Triple, step: Triple, share: float) -> Triple:
    """Twist after a fraction of a step."""
    return (
        twist[0] + share * step[0],
        twist[1] + share * step[1],
        twist[2] + share * step[2],
    )


@kernel
def newton_step(slope: Matrix, force: Triple) -> tuple[bool, Triple]:
    """Whether a slope is regular, and the step x with slope x = -force, by Cramer's
    rule.
    """
    (a, b, c), (d, e, f), (g, h, i) = slope
    A = e * i - f * h
    B = f * g - d * i
    C = d * h - e * g
    determinant = a * A + b * B + c * C
    if determinant == 0.0:
        return False, REST
    x = -force[0] / determinant
    y = -force[1] / determinant
    z = -force[2] / determinant
    step = (
        A * x + (c * h - b * i) * y + (b * f - c * e) * z,
        B * x + (a * i - c * g) * y + (c * d - a * f) * z,
        C * x + (b * g - a * h) * y + (a * e - b * d) * z,
    )
    return True, step
