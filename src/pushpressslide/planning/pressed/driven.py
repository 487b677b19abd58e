"""An object driven by one press as one vehicle: the segments to a goal, and their
continuation from a measured state.

Source: docs/mechanics.md, sections 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from pushpressslide.core import margins
from pushpressslide.core.motion import Vehicle
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import Ends, MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.scene import ObjectModel
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.friction import utilisation_margin
from pushpressslide.mechanics.pressing import lever_refusal, press_utilisation
from pushpressslide.mechanics.top import inside_top
from pushpressslide.planning.pressed.placements import PressPlacements
from pushpressslide.planning.pressed.turns import steering_of
from pushpressslide.planning.pressed.vehicle import (
    PressedRoute,
    PressedVehicle,
    backing_up,
    press_of,
    pressed_vehicle,
    route_to,
    turns,
    way_back,
)
from pushpressslide.planning.run_in import gentlest
from pushpressslide.planning.segments import (
    describe_points,
    run_time,
    segment,
)
from pushpressslide.planning.tool_drag import tool_load
from pushpressslide.rom.drives import SpinDrive, SteeredDrive, TurnDrive, UnicycleDrive

# whether a vehicle is driven backward, with the contact behind its axle
DIRECTIONS: Mapping[Vehicle, tuple[bool, ...]] = {
    "unicycle": (False, True),
    "car": (False,),
    "forklift": (True,),
    "pivot": (False,),
}
FEW = 10  # vehicles that are tried for one motion of a sequence


@dataclass(frozen=True, slots=True)
class Press:
    """One contact with its load, direction and steering limits."""

    contact: Contact
    backward: bool
    angle: float = 0.0  # [rad] of the force in turns
    steepest: float = math.inf  # [rad] largest steering angle
    # look-aheads to go back straight first, to try
    back_ups: Sequence[float] = margins.BACK_UPS


def driven_choice(query: MotionQuery, mode: str, press: Press) -> Choice:
    """Choice for one press and direction, evaluated without a check of the arm's reach."""
    contact = press.contact
    how = "pushed" if press.backward else "pulled"
    if query.motion.vehicle == "pivot":
        how = "turned on the spot"
    choice = Choice(mode, f"{how} at {describe_points([contact.point])}", (contact,))
    inset = margins.inset(query.scene.robots[contact.arm].tip_radius)
    if not inside_top(query.body, contact.point, inset):
        text = "the contact must be {allowed:mm.0f} inside the object's top"
        return choice.refused(Refusal("off_top", text, None, inset, "m"))
    try:
        vehicle = pressed_vehicle(
            query, contact, press.backward, press.angle, press.steepest
        )
        pushed, segments = _driven_segments(query, mode, press, vehicle)
    except ValueError as error:
        return choice.refused(refusal_of(error, "tipping"))
    utilisation = press_utilisation(query.scene, contact.load, pushed)
    margin = utilisation_margin(query.scene.contact_friction, utilisation)
    segments = tuple(replace(segment, cone_margin=margin) for segment in segments)
    last = segments[-1]
    distance = math.dist(vehicle.X_BV.position, vehicle.car.cop)
    summary = (
        f"{contact.load:.1f} N, path {last.path.length:.3f} m, virtual axle "
        f"{1e3 * distance:.0f} mm from the centre of pressure, {utilisation:.2f} of the "
        "tip's friction used"
    )
    for driven_back in segments[:-1]:
        summary += f", {driven_back.path.length:g} m back first"
    time = run_time(query.motion, segments, pressed=True)
    return replace(choice, segments=segments, time=time, summary=summary)


def _driven_segments(
    query: MotionQuery, mode: str, press: Press, vehicle: PressedVehicle
) -> tuple[float, tuple[Segment, ...]]:
    """Drag [N] added by a body that the object pushes, and the segments: a turn on the
    spot, or a drive.

    Raises RefusedError if no segments can be planned.
    """
    if query.motion.vehicle == "pivot":
        pushed = _tool_drag(query, vehicle)
        return pushed, (_spin(query, mode, press.contact, vehicle),)
    # where it cannot go back there is no retry: only with a long run-in
    returns = way_back(vehicle.press, not press.backward) is not None
    pushed = _tool_drag(query, vehicle)
    return pushed, _drive(query, mode, press, vehicle, returns)


def _spin(
    query: MotionQuery, mode: str, contact: Contact, vehicle: PressedVehicle
) -> Segment:
    """Segment that turns the object on the spot. Raises RefusedError if the goal is not
    at the object's position.
    """
    X_BV = vehicle.X_BV
    start, goal = (X_WB.compose(X_BV) for X_WB in query.body_ends)
    path = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position))
    moved = math.dist(start.position, goal.position)
    allowed = query.tolerance.position
    if moved > allowed:
        text = (
            "the point about which it turns has to stay in its place, from start "
            "to goal it moves by {figure:mm.1f}, allowed {allowed:mmg}"
        )
        raise RefusedError(Refusal("pin_moves", text, moved, allowed, "m"))
    drive = SpinDrive(vehicle.car, query.scene.max_friction(contact.load), X_BV)
    speed = query.motion.speed * min(1.0, vehicle.tipping_margin / margins.SAFE_MARGIN)
    return segment(query, mode, (contact,), drive, path, speed=speed)


def _drive(
    query: MotionQuery, mode: str, press: Press, vehicle: PressedVehicle, returns: bool
) -> tuple[Segment, ...]:
    """Segments of the path of one vehicle. With ``returns`` the vehicle may back up.
    Raises RefusedError if every path has a loop.
    """
    motion = query.motion
    car = vehicle.car
    contact = press.contact
    look_ahead = motion.look_ahead or margins.ARM.look_ahead(car.length, motion.speed)
    route = _route(query, press, vehicle, look_ahead, returns)
    speed = motion.speed * min(1.0, vehicle.tipping_margin / margins.SAFE_MARGIN)
    if press.backward:
        speed *= margins.PUSHED_SPEED
    speed *= min(1.0, margins.SWING / (car.length * route.curvature))
    drive = UnicycleDrive(
        car,
        query.scene.max_friction(contact.load),
        vehicle.steepest,
        look_ahead,
        route.curvature,
        route.run_in,
    )
    one_segment = segment(query, mode, (contact,), drive, route.path, speed=speed)
    if not route.back_up:
        return (one_segment,)
    start, _ = query.body_ends
    return (
        backing_up(query.X_GB, start, vehicle, one_segment, route.back_up),
        one_segment,
    )


def _route(
    query: MotionQuery,
    press: Press,
    vehicle: PressedVehicle,
    look_ahead: float,
    returns: bool,
) -> PressedRoute:
    """Path to the goal, with a straight segment backwards first if that helps."""
    straight = 0.0
    if query.tool is not None:
        straight = query.tool.straight
    run_ins = [straight + k * look_ahead for k in margins.VEHICLE_RUN_INS]
    back_ups = [k * look_ahead for k in press.back_ups]
    if not returns:
        run_ins = run_ins[:2]
        back_ups = [0.0]
    start, goal = (X_WB.compose(vehicle.X_BV) for X_WB in query.body_ends)
    route = route_to(start, goal, vehicle, run_ins, back_ups)
    # where a loop is too long a manoeuvre is better, if one is allowed
    loop = 0.0
    if query.motion.vehicle or query.tool:
        loop = margins.LONGEST_LOOP * query.body.radius
    if route.too_long > loop:
        text = (
            f"only by a loop of {route.path.length:.2f} m, {{figure:m.2f}} too long, "
            "allowed {allowed:mg}"
        )
        raise RefusedError(Refusal("loop", text, route.too_long, loop, "m"))
    return route


def _tool_drag(query: MotionQuery, vehicle: PressedVehicle) -> float:
    """Drag [N] added by a body that the object pushes.

    Raises RefusedError if the object's heading is not square to its pushing face.
    """
    drag, skew = tool_load(query, vehicle.X_BV.yaw)
    if skew > margins.ASKEW:
        text = (
            "it drives {figure:deg.1f} off the normal of tool.face, allowed "
            "{allowed:degg}"
        )
        raise RefusedError(Refusal("tool_skew", text, skew, margins.ASKEW, "rad"))
    return drag


def vehicle_choices(
    query: MotionQuery, mode: str, placements: PressPlacements
) -> list[Choice]:
    """Choices, one for each contact and direction, planned for straight motion.

    Each has the safest load that does not tip the object. For a query from a search
    over sequences, only the choices that head most directly to the goal are returned,
    since such a search has other motions to try.
    """
    directions = DIRECTIONS[query.motion.vehicle or "unicycle"]
    pairs = list(product(placements.contacts, directions))
    if query.from_search:
        pairs = sorted(pairs, key=lambda pair: _askew(query.body_ends, *pair))[:FEW]
    out = []
    for contact, backward in pairs:
        for load in placements.loads:  # a lighter press tips less
            press = Press(replace(contact, load=load), backward)
            choice = driven_choice(query, mode, press)
            refusal = lever_refusal(query.scene, press.contact)
            choice = choice.refused(refusal or choice.refusal)
            if choice.feasible:
                break
        out.append(choice)
    return out


def _askew(ends: Ends, contact: Contact, backward: bool) -> float:
    """Approximate sum [rad], over start and goal, of the angles between the vehicle's
    heading and the direction to the goal.
    """
    start, goal = ends
    bearing = math.atan2(goal.y - start.y, goal.x - start.x)
    heading = math.atan2(contact.point[1], contact.point[0]) + math.pi * backward
    return sum(
        abs(math.remainder(X.yaw + heading - bearing, 2.0 * math.pi))
        for X in (start, goal)
    )


def with_turns(query: MotionQuery, choice: Choice, min_angle: float) -> Choice:
    """The choice planned with the axle of its turns.

    It is refused if it can be steered like a unicycle only by less than ``min_angle``
    [rad].
    """
    drive = choice.segments[-1].drive
    if not isinstance(drive, UnicycleDrive):
        return choice
    (contact,) = choice.contacts
    backward = drive.car.backward
    steering = math.inf
    if min_angle > 0.0 and query.tool is None:
        steering = steering_of(
            press_of(query.scene, contact), backward, query.motion.speed
        )
    if steering < min_angle:
        text = (
            "it is steered like a unicycle only up to {figure:deg.1f}, needed "
            "{allowed:degg}"
        )
        return choice.refused(Refusal("steering", text, steering, min_angle, "rad"))
    angle = margins.PLANNED_STEERING * min(drive.steepest, steering)
    press = Press(contact, backward, angle, steering)
    return driven_choice(query, choice.mode, press)


def driven_anew(
    query: MotionQuery, mode: str, contact: Contact, drive: UnicycleDrive
) -> Choice:
    """Choice that backs up first and then drives to the goal as one vehicle, with the
    current contact.
    """
    steepest = drive.steepest
    angle = margins.PLANNED_STEERING * steepest
    press = Press(contact, drive.car.backward, angle, steepest, margins.BACK_UPS[1:])
    return driven_choice(query, mode, press)


def steered_path(
    body: ObjectModel,
    ends: tuple[Pose2, Pose2],
    drive: SteeredDrive,
    longest: float,
    turning: float,
) -> MotionPath:
    """Path of ``drive`` with the gentlest turns between its ``ends``.

    It is at most ``longest`` [m] long and turns by about ``turning`` [rad]. It is
    straight if steering along a run-in suffices, or does all that can be done.
    """
    start, goal = ends
    ahead, left = goal.unapply(start.position)
    straight = None
    if isinstance(drive, TurnDrive) and ahead < 0.0:
        straight = ArcPath(advance(goal, 0.0, ahead), ((0.0, -ahead),))
        if abs(left) < margins.CORRECTED * body.radius:
            return straight
    car = drive.car
    tightest = math.tan(margins.PLANNED_STEERING * drive.steepest) / abs(
        car.effective_wheelbase
    )
    run_ins = [k * drive.look_ahead for k in (*margins.VEHICLE_RUN_INS, 0.5, 0.0)]
    path = gentlest(ends, turns(car, tightest), run_ins, longest, turning)[2]
    # a short way is steered along as far as it goes
    near = abs(left) < margins.MISSED * body.radius
    if straight is not None and near and path.length > longest:
        return straight
    return path
