"""One contact on the ellipsoid: its friction cone, its motion cone, and the motion of a
body under a pusher with a given velocity (docs/mechanics.md, sections 2 to 4).

Everything is in frame B. The left tangent is the inward normal n turned by +90 degrees.
"""

from __future__ import annotations

from math import inf, isfinite, nan

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.compliant_tip import FREE, SLIP_LEFT, SLIP_RIGHT, STICK
from pushpressslide.kernels.elementary import cosine, sine
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.limit_surface import ellipsoid_wrench
from pushpressslide.kernels.plane import Pose, chord, cross, from_axis, in_axis
from pushpressslide.kernels.sliding import REST, Triple

Edges = tuple[Vector, Vector]
"""The right and the left edge of a cone."""
Contact = tuple[Vector, Vector, float, float]
"""A contact: vector [m] from the centre of pressure to it, unit inward normal, friction
of the pair, rho [m].
"""
Push = tuple[int, Triple, float]
"""Result of a push: status, which is ``FREE`` for a pusher that leaves the body; twist
of the centre of pressure; slip [m/s] of the pusher to the left, relative to the body.
"""
Face = tuple[Vector, Vector, Vector, float, float]
"""A pushed face: its foot, the point [m] at place 0; unit inward normal; right and left
end [m] from the foot; friction of the pair; rho [m].
"""
Pushed = tuple[Pose, float, float]
"""A pushed body: pose, position [m] of its pusher along the face, and gap [m] between
them, infinite once the pusher has passed an end of the face.
"""


@kernel
def cone_edges(normal: Vector, friction: float) -> Edges:
    """Edges f_-, f_+ = n -+ mu t of a friction cone."""
    nx, ny = normal
    right = (nx - friction * -ny, ny - friction * nx)
    return right, (nx + friction * -ny, ny + friction * nx)


@kernel
def cone_margin(force: Vector, normal: Vector, friction: float) -> float:
    """Margin mu f_n - |f_t| [N] of a force. Not negative inside the cone."""
    f_n = force[0] * normal[0] + force[1] * normal[1]
    return friction * f_n - abs(cross(normal, force))


@kernel
def velocity_of_force(lever: Vector, rho: float, force: Vector) -> Vector:
    """Vector G f along the velocity of the contact under a ``force`` f.

    Its length is not a speed; on the same scale the velocity of the CoP is f.
    """
    k = cross(lever, force) / (rho * rho)
    return force[0] - k * lever[1], force[1] + k * lever[0]


@kernel
def force_of_velocity(lever: Vector, rho: float, velocity: Vector) -> Vector:
    """Vector G^-1 v_c, along the force of a contact that sticks."""
    k = cross(lever, velocity) / (rho * rho + lever[0] * lever[0] + lever[1] * lever[1])
    return velocity[0] + k * lever[1], velocity[1] - k * lever[0]


@kernel
def motion_cone(contact: Contact) -> Edges:
    """Edges G f_-, G f_+ of the velocities at which the contact sticks."""
    lever, normal, friction, rho = contact
    right, left = cone_edges(normal, friction)
    return velocity_of_force(lever, rho, right), velocity_of_force(lever, rho, left)


@kernel
def pushed(velocity: Vector, contact: Contact) -> Push:
    """Motion of a body under a pusher with a velocity [m/s].

    Inside the motion cone the contact sticks. Outside, the force stays on the edge of
    the friction cone and the normal velocity is kept. The pusher separates from the
    body if its velocity is not into the body, or is not finite.
    """
    lever, normal, friction, rho = contact
    approach = velocity[0] * normal[0] + velocity[1] * normal[1]
    across = cross(normal, velocity)
    if not (approach > 0.0 and isfinite(velocity[0]) and isfinite(velocity[1])):
        return FREE, REST, across
    mobile = force_of_velocity(lever, rho, velocity)
    if not cone_margin(mobile, normal, friction) < 0.0:
        return STICK, driven(mobile, lever, rho), 0.0
    # An edge that leads away from the pusher cannot be passed by a velocity towards the
    # body.
    right, left = motion_cone(contact)
    edge, left_edge = cone_edges(normal, friction)
    edge_velocity = right
    kind = SLIP_RIGHT
    leads_in = left[0] * normal[0] + left[1] * normal[1] > 0.0
    if leads_in and cross(left, velocity) > 0.0:
        edge = left_edge
        edge_velocity = left
        kind = SLIP_LEFT
    k = approach / (edge_velocity[0] * normal[0] + edge_velocity[1] * normal[1])
    mobile = (k * edge[0], k * edge[1])
    return kind, driven(mobile, lever, rho), across - k * cross(normal, edge_velocity)


@kernel
def pushed_with_force(
    velocity: Vector, contact: Contact, max_force: float
) -> tuple[int, Vector, Triple, float]:
    """Result of ``pushed``, and the pusher's force [N].

    ``max_force`` [N] is mu_s N.
    """
    kind, twist, slip = pushed(velocity, contact)
    fx, fy, _ = ellipsoid_wrench(*twist, max_force, contact[3])
    return kind, (fx, fy), twist, slip


@kernel
def driven(mobile: Vector, lever: Vector, rho: float) -> Triple:
    """Twist of a body that slides under a force.

    The velocity of the centre of pressure is along the force.
    """
    return mobile[0], mobile[1], cross(lever, mobile) / (rho * rho)


@kernel
def quick_heading(yaw: float) -> Vector:
    """Unit vector at an angle [rad], computed by plain arithmetic in compiled code."""
    if not isfinite(yaw):
        return nan, nan
    return cosine(yaw), sine(yaw)


@kernel
def advance_push(
    pose: Pose, velocity: Vector, place: float, gap: float, dt: float, face: Face
) -> Pushed:
    """Body and pusher after ``dt`` [s] in which the pusher moves at a velocity [m/s] in
    the world.

    The pusher sticks, slips along the face, leaves the body, or passes an end of the
    face. The twist is constant in the body frame.
    """
    foot, normal, ends, friction, rho = face
    axis = quick_heading(pose[2])
    velocity = in_axis(axis, velocity)
    into = velocity[0] * normal[0] + velocity[1] * normal[1]
    along = cross(normal, velocity)
    until = 0.0
    if gap > 0.0:
        until = gap / into if into > 0.0 else inf
    free = until if until < dt else dt
    time = dt - free
    place = place + along * free
    left_over = gap - into * dt
    if not (time > 0.0 and ends[0] <= place <= ends[1]):
        # beside the face, at its level, the pusher has passed
        return pose, place + along * time, inf if until < dt else left_over
    lever = (foot[0] - normal[1] * place, foot[1] + normal[0] * place)
    _, twist, slip = pushed(velocity, (lever, normal, friction, rho))
    turn = twist[2] * time
    dx, dy = from_axis(axis, chord(twist, time, sine(turn), sine(0.5 * turn)))
    after = (pose[0] + dx, pose[1] + dy, pose[2] + turn)
    return after, place + slip * time, 0.0 if into > 0.0 else left_over
