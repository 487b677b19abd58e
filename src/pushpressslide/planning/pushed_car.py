"""An object that two arms push on one face, as a car fitted to the exact limit surface,
and its paths.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import Ends, MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.face_push import Push, on_face, turnings
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.run_in import longest_way, with_run_in
from pushpressslide.planning.side_contacts import contact_height
from pushpressslide.rom.differential_car import DifferentialCar
from pushpressslide.rom.drives import ORIGIN
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import RearSteerCar

# curvatures that are tried, in shares of the tightest that a plan may use
TIGHTER = (0.3, 0.6, 1.0)


def pushed_cars(
    scene: Scene,
    motion: Motion,
    places: Sequence[tuple[Face, float]],
    synchronised: bool,
) -> list[PushedCar]:
    """Believed reduced models of two contacts on each face, at a given distance [m] to
    either side of the line through the CoM.

    Pushes by normal forces alone make the object a differential car. With
    ``synchronised``, equal forces make it a rear-steer car (docs/mechanics.md, section
    5). Axle and rho are those of the exact surface at the fraction
    ``motion.curvature_margin`` of the force's range; the load is shifted by the push
    itself. The model's tightest curves are no tighter than those of the object. Raises
    ValueError if the object tips.
    """
    if scene.rho is not None:
        shift = contact_height(scene, motion) * scene.support.friction
        fits = [_Fit(scene.rho, shift, math.inf, math.inf) for _ in places]
    else:
        fits = _fits(scene, motion, places, synchronised)
    return [
        _car(face, half_width, scene.contact_friction, fit, synchronised)
        for (face, half_width), fit in zip(places, fits, strict=True)
    ]


@dataclass(frozen=True, slots=True)
class _Fit:
    """Fit of the limit surface for the contacts on one face."""

    rho: float  # [m]
    shift: float  # [m] of the centre of pressure under way
    left: float  # [1/m] tightest curvature of the object to the left, > 0
    right: float


def _fits(
    scene: Scene,
    motion: Motion,
    places: Sequence[tuple[Face, float]],
    synchronised: bool,
) -> list[_Fit]:
    """Rho and shift of the centre of pressure on the exact surface, at the fraction
    ``curvature_margin`` of the force's range.
    """
    use = motion.curvature_margin
    mu_a = scene.contact_friction
    pushes = []
    for face, half_width in places:
        for share in (-use, use, -1.0, 1.0):
            off = (share * half_width, 0.0)
            if synchronised:
                off = (0.0, share * mu_a)
            pushes.append(Push(face, *off))
    height = contact_height(scene, motion)
    turned = turnings(scene.body, scene.support.friction, height, pushes)
    out = []
    for i, (face, half_width) in enumerate(places):
        right, left, rightmost, leftmost = turned[4 * i : 4 * i + 4]
        mean = 0.5 * (1.0 / abs(right.curvature) + 1.0 / abs(left.curvature))
        # how far off the CoM the force may be, or how much across the normal; and the
        # moment that this makes
        limit = half_width
        arm = 1.0
        if synchronised:
            limit = mu_a
            arm = face.depth
        rho = math.sqrt(arm * use * limit * mean)
        axle = 0.5 * (right.axle + left.axle)
        shift = axle - _wheelbase(face, rho, synchronised)
        tightest = abs(rightmost.curvature), abs(leftmost.curvature)
        out.append(_Fit(rho, shift, *tightest))
    return out


def _wheelbase(face: Face, rho: float, synchronised: bool) -> float:
    """Distance [m] of the axle ahead of the centre of pressure."""
    if not synchronised:
        return 0.0
    return rho * rho / face.depth


def _car(
    face: Face, half_width: float, mu_a: float, fit: _Fit, synchronised: bool
) -> PushedCar:
    """Reduced model of two contacts on one face."""
    rho = fit.rho
    heading = math.atan2(face.normal[1], face.normal[0])
    wheelbase = _wheelbase(face, rho, synchronised)
    car: DifferentialCar | RearSteerCar
    if synchronised:
        car = RearSteerCar(on_face(face, 0.0), face.normal, ORIGIN, rho, mu_a)
    else:
        car = DifferentialCar(ORIGIN, heading, half_width, half_width, rho)
    low, high = car.curvature_limits
    left = min(high, fit.left)
    right = min(-low, fit.right)
    return PushedCar(heading, fit.shift + wheelbase, wheelbase, rho, left, right)


def least_lengths(ends: Ends, radius: float, face: Face) -> tuple[float, float]:
    """Lower bounds of the length [m] of a path between the ``ends`` X_WB of an object
    of ``radius`` [m] pushed on a face.

    The first is for twists of the object, the second for the path of a car's axle
    anywhere ahead of the CoM.
    """
    start, goal = ends
    direct = TwistPath.between(ends, radius).length
    ax, ay = start.rotate(face.normal)
    bx, by = goal.rotate(face.normal)
    x = goal.x - start.x
    y = goal.y - start.y
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    ahead = max(0.0, -(x * dx + y * dy) / square) if square > 0.0 else 0.0
    return direct, math.hypot(x + ahead * dx, y + ahead * dy)


def car_path(query: MotionQuery, car: PushedCar, curvature: float) -> ArcPath:
    """Path of a car's axle between the ends of ``query``, with gentle turns up to
    ``curvature`` [1/m]. Raises RefusedError if every path has a loop.
    """
    start, goal = (X_WB.compose(car.X_BV) for X_WB in query.body_ends)
    longest = longest_way(query.body.radius, math.dist(start.position, goal.position))
    path = gentle_path((start, goal), curvature, longest, run_ins(query.motion))
    if path.length > longest:
        text = (
            "a loop of {figure:m.2f} with radii of "
            f"{1.0 / curvature:.3f} m and no reversing, allowed {{allowed:m.2f}}"
        )
        raise RefusedError(Refusal("loop", text, path.length, longest, "m"))
    return path


def run_ins(motion: Motion) -> list[float]:
    """Lengths [m] of the run-ins to try, the longest first."""
    return [share * motion.run_in for share in margins.CAR_RUN_INS]


def gentle_path(
    ends: tuple[Pose2, Pose2],
    tightest: float,
    longest: float,
    run_ins: Sequence[float],
    turning: float | None = None,
) -> ArcPath:
    """First path tried that is no longer than ``longest`` [m], or else the shortest one
    tried.

    The ``run_ins`` [m] are tried in order, each with gentler turns first and no
    curvature above ``tightest`` [1/m]. ``turning`` [rad] is as in ``with_run_in``.
    """
    tried = []
    for run_in in run_ins:
        for share in TIGHTER:
            curvature = share * tightest
            path = with_run_in(ends, curvature, curvature, run_in, turning)
            if path.length <= longest:
                return path
            tried.append(path)
    return min(tried, key=lambda path: path.length)
