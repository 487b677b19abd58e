"""A pressed object as a vehicle: its direction, its routes, and the limits of steering
without tipping.

Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from pushpressslide.core import margins
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.plan import Contact, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.run_in import gentlest, loop_free_length
from pushpressslide.rom.drives import UnicycleDrive
from pushpressslide.rom.unicycle import Unicycle

# force angles from the motion that steering may be bounded by: the steepest that does
# not tip the object
STEEPEST = tuple(math.radians(a) for a in (35.0, 45.0, 60.0))
CAR_ANGLE = math.radians(45.0)  # the bound for a car or a forklift
TIGHTER = (0.5, 0.75, 1.0, 2.0)  # curvatures that are tried, in units of that turn's


@dataclass(frozen=True, slots=True)
class PressedVehicle:
    """A pressed object as a vehicle, for one contact, load and direction."""

    press: Press
    car: Unicycle
    # at the virtual axle, x along the motion; of a turn on the spot, at its pivot
    X_BV: Pose2
    steepest: float  # [rad] force angle from the motion that it may be steered with
    # [half widths] distance of the centre of pressure inside the base with the least
    # steering
    tipping_margin: float


def press_of(scene: Scene, contact: Contact) -> Press:
    """Press of a contact on the believed object. Raises ValueError for a contact at the
    CoM.
    """
    mu = scene.support.friction
    return Press(scene.body, mu, contact.point, contact.load, scene.rho)


@lru_cache(maxsize=4096)
def steered(press: Press, backward: bool, angle: float) -> Unicycle:
    """Vehicle that is turned by a force at ``angle`` [rad] from its motion. Raises
    ValueError if the object tips.
    """
    ahead, reach = press.steered(angle, backward)
    shift = ahead + reach
    if backward:
        shift = -ahead - reach
    return Unicycle(
        press.contact, press.cop, math.sqrt(reach * press.lever), backward, shift
    )


def pressed_vehicle(
    query: MotionQuery,
    contact: Contact,
    backward: bool,
    angle: float,
    max_angle: float = math.inf,
) -> PressedVehicle:
    """The object as a vehicle that is turned by a force at ``angle`` [rad] and steered
    by at most ``max_angle`` [rad].

    ``motion.vehicle`` determines whether it turns on the spot. Raises ValueError, with
    the deciding number, if the object tips.
    """
    kind = query.motion.vehicle
    press = press_of(query.scene, contact)
    bounds = (0.5 * math.pi,) if kind == "pivot" else STEEPEST
    spaces = [(a, _tipping_margin(press, a, backward)) for a in bounds]
    lower = spaces[0][1]
    if lower < margins.TIPPING_MARGIN:
        text = (
            f"drag at {query.body.shape.top_height:.3f} m tips it: the centre of pressure "
            "comes within {figure:.2f} half widths of the base's edge, allowed "
            "{allowed:g}"
        )
        raise RefusedError(Refusal("tipping", text, lower, margins.TIPPING_MARGIN))
    steepest = min(
        max_angle, max(a for a, space in spaces if space >= margins.TIPPING_MARGIN)
    )
    if kind == "pivot":
        left = math.remainder(query.goal.yaw - query.start.yaw, 2.0 * math.pi) > 0.0
        car = Unicycle(press.contact, press.cop, 1.0)
        pivot = press.pivot(left)
        back = (press.cop[0] - pivot[0]) * car.axis[0] + (
            press.cop[1] - pivot[1]
        ) * car.axis[1]
        car = replace(car, rho=math.sqrt(back * press.lever))
        return PressedVehicle(press, car, Pose2(*pivot, car.X_BV.yaw), steepest, lower)
    if kind in ("car", "forklift"):
        steepest = min(steepest, CAR_ANGLE)
    car = steered(press, backward, angle)
    return PressedVehicle(press, car, car.X_BV, steepest, lower)


def way_back(press: Press, backward: bool) -> Unicycle | None:
    """Vehicle for a short straight path. None if the object would tip, or cannot be
    steered.

    It cannot be steered if the drag shifts the centre of pressure by more than the
    vehicle's length.
    """
    if _tipping_margin(press, STEEPEST[0], backward) < margins.TIPPING_MARGIN:
        return None
    car = steered(press, backward, 0.0)
    if car.length <= car.shift:
        return None
    return car


@lru_cache(maxsize=4096)
def _tipping_margin(press: Press, angle: float, backward: bool) -> float:
    if backward:
        angle = math.pi - angle
    return min(press.tipping_margin(angle), press.tipping_margin(-angle))


@dataclass(frozen=True, slots=True)
class PressedRoute:
    """A path of the virtual axle, with a straight segment backwards before it."""

    path: ArcPath
    back_up: float  # [m]
    run_in: float  # [m]
    curvature: float  # [1/m]
    too_long: float  # [m] longer than a path without a loop


def route_to(
    start: Pose2,
    goal: Pose2,
    vehicle: PressedVehicle,
    run_ins: Sequence[float],
    back_ups: Sequence[float],
) -> PressedRoute:
    """Route of the vehicle frame from ``start`` to ``goal`` with the gentlest turns.

    The vehicle backs up as little as necessary.
    """
    angle = margins.PLANNED_STEERING * vehicle.steepest
    tightest = math.tan(angle) / abs(vehicle.car.effective_wheelbase)
    curvatures = turns(vehicle.car, tightest)
    routes = []
    for back_up in back_ups:
        first = advance(start, 0.0, -back_up)
        run_in, curvature, path = gentlest((first, goal), curvatures, run_ins)
        routes.append(
            PressedRoute(
                path,
                back_up,
                run_in,
                curvature,
                path.length - loop_free_length(first, goal, curvature),
            )
        )
        if routes[-1].too_long <= 0.0:
            break
    return min(routes, key=lambda route: max(route.too_long, 0.0))


def turns(car: Unicycle, tightest: float) -> list[float]:
    """Curvatures [1/m] to try, up to ``tightest``, the gentlest first."""
    return sorted({min(k * margins.SWING / car.length, tightest) for k in TIGHTER})


def backing_up(
    X_GB: Pose2, X_WB: Pose2, vehicle: PressedVehicle, then: Segment, distance: float
) -> Segment:
    """Straight segment that backs up by ``distance`` [m] from ``X_WB``.

    Its direction is opposite to that of the next segment, ``then``.
    """
    car = way_back(vehicle.press, not vehicle.car.backward)
    planned = then.drive
    assert car is not None
    assert isinstance(planned, UnicycleDrive)
    start = X_WB.compose(car.X_BV)
    path = ArcPath(start, ((0.0, distance),))
    end = path.end.compose(car.X_BV.inverse()).compose(X_GB.inverse())
    drive = replace(
        planned,
        car=car,
        steepest=STEEPEST[0],
        curvature=1.0 / car.length,
        run_in=distance,
    )
    return replace(then, drive=drive, goal=end).follows(path)
