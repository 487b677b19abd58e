"""Sticking of a flat finger: the prediction compared with pushes on the planar engine
(studies/docs/stable-push.md).

The finger's ends are two compliant tips that follow its motion. In each tick the engine
computes the object's twist on the exact limit surface, and the springs extend by the
object's lag. If the object's motion converges to that of the finger, the finger sticks.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

from pushpressslide.core.pose import Point
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.line_push import FlatFinger, LinePush, line_push
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide.planar.contact import SideContact, TipLaw
from pushpressslide.planar.sliding import slide
from pushpressslide.planar.support_friction import SupportFriction

RESOLUTION = 3  # of the base
SPEED = 0.05  # [m/s] of the finger's middle into the object
TICKS = 400
WITH = 1e-3  # of the finger's speed: slower motion on it counts as none
LASTING = 10  # ticks for which it has to be none: springs also turn back
ORIGIN = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Case:
    """A finger on the rear face of a box, and the planned motion of both."""

    body: ObjectModel
    support_friction: float
    finger: FlatFinger
    twist: Twist
    height: float  # [m]

    def pressure(self, cop: Point) -> PressureSamples:
        """Pressure of unit load with its centre at ``cop`` [m] in B."""
        body = self.body
        return support_pressure(body.shape, 1.0, body.center_of_mass, cop, RESOLUTION)

    def relative(self, moving: Twist) -> float:
        """Motion of the object relative to the finger, divided by the finger's speed. A
        rotation counts as the motion that it causes at the object's rim.
        """
        wanted = self.twist.moved_to(moving.point)
        drift = math.hypot(moving.vx - wanted.vx, moving.vy - wanted.vy)
        turn = abs(moving.w - wanted.w) * self.body.shape.circumradius
        return max(drift, turn) / SPEED

    def predicted(self) -> LinePush:
        """Prediction on the exact limit surface."""
        return line_push(
            self.pressure, self.support_friction, self.finger, self.twist, self.height
        )

    def by_ellipsoid(self) -> LinePush:
        """Prediction on the nearest ellipsoid, without the effect of the height."""
        rho = rho_fit(self.pressure(ORIGIN))
        surface = EllipsoidLimitSurface(self.support_friction, rho)
        return self.finger.hold(surface.wrench(self.twist))


def random_case(rng: random.Random) -> Case:
    """A random case in which the finger pushes rather than pulls."""
    length = rng.uniform(0.05, 0.3)
    width = rng.uniform(0.05, 0.3)
    height = rng.uniform(0.03, 0.15)
    com = (rng.uniform(-0.15, 0.15) * length, rng.uniform(-0.15, 0.15) * width)
    body = ObjectModel(Box((length, width, height)), 1.0, com)
    part = rng.uniform(0.1, 0.95) * width
    left = rng.uniform(-0.5, 0.5) * (width - part) - com[1]
    rear = -0.5 * length - com[0]
    friction = rng.uniform(0.1, 1.0)
    finger = FlatFinger((rear, left + 0.5 * part), (rear, left - 0.5 * part), friction)
    slope = rng.uniform(-1.0, 1.0)
    turn = rng.uniform(-1.0, 1.0) * SPEED / (length + width)
    twist = Twist(SPEED, slope * friction * SPEED, 4.0 * turn, (rear, left))
    mu = rng.uniform(0.1, 0.5)
    return Case(body, mu, finger, twist, rng.uniform(0.0, 0.5) * height)


class _Tip:
    """One end of the finger: a spring that follows the finger, with friction on the
    face.
    """

    def __init__(self, case: Case, point: Point, stiffness: float) -> None:
        moved = case.twist.moved_to(point)
        self._normal = case.finger.normal
        self._friction = case.finger.friction
        self._point = point
        self._stiffness = stiffness  # [N s/m] force per tick of relative motion
        self._ahead = self._in_axes((moved.vx, moved.vy))
        self._normal_spring = 0.0  # [N]; negative: a gap

    def _in_axes(self, v: Point) -> Point:
        nx, ny = self._normal
        return (nx * v[0] + ny * v[1], nx * v[1] - ny * v[0])

    def contact(self, cop: Point, side: float) -> SideContact:
        """Contact in a tick. ``side`` [N] is the contact's friction force in the
        previous tick.
        """
        k = self._stiffness
        force = (self._normal_spring + k * self._ahead[0], side + k * self._ahead[1])
        place = (self._point[0] - cop[0], self._point[1] - cop[1])
        law = TipLaw(self._normal, force, (k, k))
        return SideContact(place, place, law, self._friction)

    def take(self, twist: Twist) -> None:
        """Extend the spring by the lag of an object that moves with ``twist``."""
        at = twist.moved_to(self._point)
        behind = self._in_axes((at.vx, at.vy))
        self._normal_spring += self._stiffness * (self._ahead[0] - behind[0])

    def friction_of(self, force: Point) -> float:
        """Component of a force [N] along the face."""
        return self._in_axes(force)[1]


def sticks_on_the_engine(case: Case) -> bool:
    """Whether the object's motion converges to that of the finger."""
    mu = case.support_friction
    tips = [
        _Tip(case, p, 4.0 * mu / SPEED) for p in (case.finger.start, case.finger.end)
    ]
    sides = [0.0, 0.0]
    cop = ORIGIN
    guess = Twist(0.0, 0.0, 0.0)
    together = 0
    for _ in range(TICKS):
        friction = SupportFriction(case.pressure(cop))
        contacts = [tip.contact(cop, f) for tip, f in zip(tips, sides, strict=True)]
        start = guess.moved_to(cop)
        moving = slide(friction, mu, contacts, (start.vx, start.vy, start.w))
        guess = Twist(*moving, cop)
        forces = [contact.response(moving).force for contact in contacts]
        sides = [t.friction_of(f) for t, f in zip(tips, forces, strict=True)]
        for tip in tips:
            tip.take(guess)
        together = together + 1 if case.relative(guess) < WITH else 0
        if together == LASTING:
            return True
        x = sum(f[0] for f in forces)
        y = sum(f[1] for f in forces)
        cop = (case.height * x, case.height * y)
    return False


def scores(cases: int, seed: int) -> list[dict[str, object]]:
    """Share of correct predictions, for the exact surface and the ellipsoid.

    ``near`` is the largest ``distance`` of a wrongly predicted push.
    """
    rng = random.Random(seed)
    rows: dict[str, list[tuple[bool, LinePush]]] = {"exact": [], "ellipsoid": []}
    for _ in range(cases):
        case = random_case(rng)
        try:
            exact = case.predicted()
        except ValueError:  # tips
            continue
        truth = sticks_on_the_engine(case)
        rows["exact"].append((truth, exact))
        rows["ellipsoid"].append((truth, case.by_ellipsoid()))
    return [_score(model, pushes) for model, pushes in rows.items()]


def _score(model: str, pushes: list[tuple[bool, LinePush]]) -> dict[str, object]:
    """Row of one model."""
    wrong = [(truth, push) for truth, push in pushes if truth != push.sticks]
    return {
        "model": model,
        "pushes": len(pushes),
        "stick": sum(truth for truth, _ in pushes),
        "right": 1.0 - len(wrong) / len(pushes),
        "said_stick": sum(not truth for truth, _ in wrong),
        "said_slip": sum(truth for truth, _ in wrong),
        "near": max((distance(push) for _, push in wrong), default=0.0),
    }


def distance(push: LinePush) -> float:
    """Distance of a push from the nearer of its two limits.

    The friction utilisation and the magnitude of the resultant's position are both
    limited to 1.
    """
    return min(abs(push.friction_utilisation - 1.0), abs(abs(push.center) - 1.0))
