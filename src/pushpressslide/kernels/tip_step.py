"""One tick of a body on its support with one or two compliant tips at its flat sides:
the inner step of the planar engine (docs/mechanics.md, sections 1 to 3).

Everything is in the body frame B, in which the twist is constant during a tick.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Any

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.compliant_tip import (
    FREE,
    Law,
    Side,
    side_contact,
    side_touch,
    tip_velocity,
)
from pushpressslide.kernels.kernel import kernel, kernel_apart
from pushpressslide.kernels.plane import (
    Pose,
    carried_from,
    flat_gap,
    from_axis,
    heading,
    in_axis,
)
from pushpressslide.kernels.sliding import Laws, Triple, slide

PASSED = 1e-3  # [m] behind a face: a tip there came round its end, not through it

Command = tuple[Vector, Vector, Vector, Vector, Vector]
"""Command of a tip in the plane.

Force [N], position error [m] and reference velocity [m/s] are in the world. Stiffness
[N/m] and damping [N s/m] are along an axis and to its left.
"""
Led = tuple[Vector, Vector, Vector]
"""Position of a tip's centre [m], with its reference velocity [m/s] and force [N], in
the world.
"""
Face = tuple[Vector, float, float, float, float, float, float]
"""A flat side and its tip.

The members are the unit inward normal; the position [m] of the side along it; the right
and left end [m] of the side, measured to the left; the radius [m] of the tip; the
friction of the pair; and the damping [N s/m].
"""
Body = tuple[Vector, float, float, float]
"""A body: centre of pressure [m], mu_s N [N], rho [m], and duration of a tick [s]."""
Reach = tuple[Vector, Vector, Vector, Law]
"""A tip at the start of a tick.

B's x axis and the tip's position [m] are in the world; the second position [m] and the
tip's law are in B.
"""
Motion = tuple[Triple, Vector, Pose, float]
"""Motion of a body in a tick: twist of its centre of pressure, position [m] of this
centre, pose at the end, and duration of the tick [s].
"""
After = tuple[Vector, Vector, Vector]
"""A tip after a tick: position [m], velocity [m/s], and force on the body [N], in the
world.
"""
State = tuple[Vector, Vector, int]
"""A tip after a tick: position [m] and force on the body [N] in the world, and status
of its contact.
"""


@kernel
def held_force(axis: Vector, command: Command) -> Vector:
    """Force f_0 [N], in the world, of a tip at rest."""
    c, s = axis
    (fx, fy), (dx, dy), (ux, uy), (kn, kt), (bn, bt) = command
    fn = kn * (c * dx + s * dy) + bn * (c * ux + s * uy)
    ft = kt * (c * dy - s * dx) + bt * (c * uy - s * ux)
    return fx + c * fn - s * ft, fy + s * fn + c * ft


@kernel
def tip_law(axis: Vector, force: Vector, damping: Vector) -> Law:
    """Law of a tip along an axis, with its force f_0 [N] in B."""
    return axis, in_axis(axis, force), damping


@kernel
def carried_body(
    axis: Vector, pose: Pose, twist: Triple, cop: Vector, dt: float
) -> Pose:
    """Pose of a body after a tick at the ``twist`` of its centre of pressure."""
    vx, vy, w = twist
    ry = 0.0 - cop[1]
    rx = 0.0 - cop[0]
    return carried_from(axis, pose, (vx - w * ry, vy + w * rx, w), dt)


@kernel
def tip_after(reach: Reach, force: Vector, free: bool, motion: Motion) -> After:
    """Tip after one tick.

    ``force`` [N] acts on the body, in B. ``free`` says that the tip does not touch.
    """
    axis, (x, y), (px, py), law = reach
    (vx, vy, w), cop, after, dt = motion
    velocity = tip_velocity(force, law)
    ux, uy = from_axis(axis, velocity)
    if free:
        return (x + dt * ux, y + dt * uy), (ux, uy), from_axis(axis, force)
    # with the body, but for its slip
    sx = velocity[0] - (vx - w * (py - cop[1]))
    sy = velocity[1] - (vy + w * (px - cop[0]))
    dx, dy = from_axis(heading(after[2]), (px + dt * sx, py + dt * sy))
    return (after[0] + dx, after[1] + dy), (ux, uy), from_axis(axis, force)


@kernel
def reached(
    pose: Pose, axis: Vector, led: Led, face: Face, body: Body
) -> tuple[Reach, Side]:
    """Tip at the start of a tick, and its possible contact with its face. There is no
    contact if the tip is beyond the ends of the face or behind it, or if an argument is
    not finite.
    """
    (x, y), velocity, force = led
    normal, depth, right, left, radius, friction, damping = face
    cop, _, _, dt = body
    still = (0.0, 0.0)
    both = (damping, damping)
    force = held_force((1.0, 0.0), (force, still, velocity, still, both))
    place = in_axis(axis, (x - pose[0], y - pose[1]))
    law = tip_law(normal, in_axis(axis, force), both)
    gap = flat_gap(place, radius, normal, depth, (right, left))
    _, (fn, ft), _ = law
    if not (isfinite(fn + ft) and -PASSED < gap < inf):
        away = side_contact(still, 0.0, 0.0, (normal, (-1.0, 0.0), both), 0.0, dt)
        return (axis, (x, y), place, law), away
    off = (place[0] - cop[0], place[1] - cop[1])
    contact = side_contact(off, radius, gap, law, friction, dt)
    return (axis, (x, y), place, law), contact


@kernel
def followed(reach: Reach, contact: Side, motion: Motion) -> State:
    """Tip after a tick in which its body moved."""
    vx, vy, w = motion[0]
    force, _, status, _, _ = side_touch(vx, vy, w, contact)
    place, _, felt = tip_after(reach, force, status == FREE, motion)
    if status == FREE:
        felt = (0.0, 0.0)
    return place, felt, status


@kernel_apart
def one_tip_step(
    pose: Pose,
    guess: Triple,
    led: Led,
    face: Face,
    body: Body,
    surface: Any,
    laws: Laws,
) -> tuple[Pose, Triple, State]:
    """Pose and twist of a body and its tip after one tick. ``guess`` is the twist of
    the previous tick.
    """
    cop, limit, rho, dt = body
    axis = heading(pose[2])
    reach, contact = reached(pose, axis, led, face, body)
    twist = slide(guess, (contact,), (surface, limit, rho), laws)
    after = carried_body(axis, pose, twist, cop, dt)
    return after, twist, followed(reach, contact, (twist, cop, after, dt))


@kernel_apart
def two_tip_step(
    pose: Pose,
    guess: Triple,
    leds: tuple[Led, Led],
    faces: tuple[Face, Face],
    body: Body,
    surface: Any,
    laws: Laws,
) -> tuple[Pose, Triple, State, State]:
    """Pose and twist of a body and its two tips after one tick."""
    cop, limit, rho, dt = body
    axis = heading(pose[2])
    reach, contact = reached(pose, axis, leds[0], faces[0], body)
    other_reach, other = reached(pose, axis, leds[1], faces[1], body)
    twist = slide(guess, (contact, other), (surface, limit, rho), laws)
    after = carried_body(axis, pose, twist, cop, dt)
    motion = (twist, cop, after, dt)
    return (
        after,
        twist,
        followed(reach, contact, motion),
        followed(other_reach, other, motion),
    )
