"""The virtual axle of one contact: on the ellipsoid, exactly, and with the height of
the contact.

Source: docs/mechanics.md, sections 2, 3 and 4. The heading axis is the line through
contact and CoP. The axle is the point on this line, beyond the CoP, that has no
velocity across the line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.core.pose import Point, cross
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.kernels.exact_surface import exact_axle
from pushpressslide.mechanics.face_pressure import FacePressure
from pushpressslide.mechanics.face_slide import FaceSurface
from pushpressslide.mechanics.limit_surface import load_spread, slide_samples
from pushpressslide.mechanics.pressure import PressureSamples

# force angle [rad] below which the limit of straight motion is used in closed form,
# which has no noise to divide
STRAIGHT_FACE = 1e-6
# tolerance of the force over the load, between the force that slides and the one that
# moved the centre of pressure
SETTLED = 1e-7
NARROW = 1e-12  # the same, of an interval in which the two differ by a jump
SECANTS = 8  # steps, after which the interval is halved
EDGE = 1e-4  # distance to tipping up to which the force is followed, as a share of mu


def axle_distance(rho: float, lever: float) -> float:
    """Distance rho^2 / d [m] of the axle from the CoP, away from the contact. On the
    ellipsoid it is the same for every force.

    ``lever`` d [m] is the distance from CoP to contact. Raises ValueError unless it is
    > 0.
    """
    if not lever > 0.0:
        raise ValueError(
            f"lever {lever} m; the contact must not be at the centre of pressure"
        )
    return rho * rho / lever


def exact_axle_distance(
    samples: PressureSamples, lever: Point, force_angle: float
) -> float:
    """Exact distance [m] from the CoP to the virtual axle, positive away from the
    contact.

    ``lever`` [m] is the contact relative to the CoP; ``force_angle`` [rad] is the angle
    of the contact force from the heading axis. A force and its opposite give the same
    axle, so either sign of the force may be used. The distance is v_t/w, where v_t is
    the CoP's velocity to the left of the line from CoP to contact and w the angular
    velocity. Towards a straight push it tends to the load's variance along the axis
    divided by d; it grows or shrinks with the angle. It does not depend on the support
    friction. Raises ValueError for a zero lever.
    """
    axle_distance(1.0, math.hypot(lever[0], lever[1]))
    extent, over_rho = slide_samples(samples)
    spread = load_spread(samples)
    x, y = lever
    (distance,) = exact_axle(x, y, force_angle, spread, extent, over_rho)
    return distance


class Slide(NamedTuple):
    """Sliding of an object under one force."""

    face: FacePressure  # pressure as moved by the force
    wrench: Wrench  # of a force of 1 N, about that pressure's centre
    twist: Twist  # only the direction counts
    # force that slides it less the force that has moved the pressure, over the load
    surplus: float


def sliding(
    face_at: Callable[[Point], FacePressure],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    direction: Point,
) -> Slide:
    """Sliding of the object under a force along the unit vector ``direction``.

    The force acts at ``contact`` [m] in B, ``height`` [m] above the support, and shifts
    the CoP from ``cop`` by h F / N. ``face_at(p)`` gives the pressure with its CoP at
    p; ``mu`` is the friction of the pair object/support. A bracketed secant method
    finds the force at which the object just slides. Raises ValueError if the CoP leaves
    the base at a smaller force, so that the object tips.
    """

    def slide(ratio: float, guess: Twist | None = None) -> Slide:
        """Slide under a force of ``ratio`` times the load, with the pressure shifted by
        this force.
        """
        shift = height * ratio
        moved = (cop[0] + shift * direction[0], cop[1] + shift * direction[1])
        face = face_at(moved)
        arm = (contact[0] - moved[0], contact[1] - moved[1])
        wrench = Wrench(*direction, cross(arm, direction), moved)
        twist, level = FaceSurface(face).slide(wrench, guess)
        return Slide(face, wrench, twist, mu / level - ratio)

    if height == 0.0:
        return slide(0.0)
    return _balanced(slide, mu)


def _balanced(slide: Callable[[float, Twist | None], Slide], max_force: float) -> Slide:
    """Slide with zero surplus, with a ratio of force to load in [0, ``max_force``].

    Raises the ValueError of ``slide`` if the surplus is positive for every valid
    pressure.
    """
    interval = _Interval(0.0, max_force)
    ratio = max_force
    guess = None
    while True:
        try:
            found = slide(ratio, guess)
        except ValueError:
            if interval.width < EDGE * max_force:
                raise
            interval.high = ratio
            ratio = interval.middle
        else:
            if abs(found.surplus) < SETTLED or interval.width < NARROW:
                return found
            guess = found.twist
            ratio = interval.next(ratio, found.surplus)


@dataclass(slots=True)
class _Interval:
    """A bracket of a zero. The function is positive at the low end and negative at the
    high end.
    """

    low: float
    high: float
    steps: int = 0
    place: float = 0.0  # position of the previous value
    value: float = 0.0

    @property
    def width(self) -> float:
        """Length of the bracket."""
        return self.high - self.low

    @property
    def middle(self) -> float:
        """Midpoint of the bracket."""
        return 0.5 * (self.low + self.high)

    def next(self, place: float, value: float) -> float:
        """Next point to evaluate: the zero of the line through the last two values. At
        the first step it is the zero of a line with slope -1 through the only value.
        """
        if value > 0.0:
            self.low = place
        else:
            self.high = place
        slope = -1.0
        if self.steps:
            slope = (value - self.value) / (place - self.place)
        self.steps += 1
        self.place = place
        self.value = value
        root = place - value / slope if slope < 0.0 else self.low
        if self.steps <= SECANTS and self.low < root < self.high:
            return root
        return self.middle


def dragged_twist(
    face_at: Callable[[Point], FacePressure],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    direction: Point,
) -> Twist:
    """Twist of B's origin under the force of ``sliding``, on the exact surface. Its
    magnitude is arbitrary.
    """
    slide = sliding(face_at, mu, cop, contact, height, direction)
    return slide.twist.moved_to((0.0, 0.0))


def axle_with_height(
    face_at: Callable[[Point], FacePressure],
    mu: float,
    cop: Point,
    contact: Point,
    height: float,
    force_angle: float,
) -> Point:
    """Virtual axle [m] in B when the force of ``sliding`` acts at ``height`` [m].

    The force angle [rad] is measured from the line from CoP to contact, so that an
    angle near pi pushes the contact back towards the CoP. For straight motion x_va =
    (x_cop +- h mu) - rho_x^2(x_cop +- h mu) / d, with the unshifted d
    (docs/mechanics.md, section 4). Raises ValueError if the shifted CoP leaves the
    base, so that the object tips.
    """
    lever = (contact[0] - cop[0], contact[1] - cop[1])
    d = math.hypot(lever[0], lever[1])
    axle_distance(1.0, d)
    e = (lever[0] / d, lever[1] / d)
    slide = sliding(face_at, mu, cop, contact, height, turned(e, force_angle))
    if abs(math.sin(force_angle)) < STRAIGHT_FACE:
        distance = slide.face.variance(e) / d
        x, y = slide.wrench.about
        return (x - distance * e[0], y - distance * e[1])
    twist = slide.twist.moved_to(cop)
    distance = (twist.vy * e[0] - twist.vx * e[1]) / twist.w
    return (cop[0] - distance * e[0], cop[1] - distance * e[1])


def turned(e: Point, angle: float) -> Point:
    """The vector ``e`` turned by ``angle`` [rad] to the left."""
    c = math.cos(angle)
    s = math.sin(angle)
    return (c * e[0] - s * e[1], s * e[0] + c * e[1])
