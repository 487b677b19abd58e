"""Reach of an arm that follows a contact along a path, with its tool upright or tilted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal, literal
from pushpressslide.core.scene import Robot, Scene
from pushpressslide.core.support_frame import TABLE
from pushpressslide.robots.arm_files import arm_kinematics, at_origin, changed_at
from pushpressslide.robots.reach import held_somehow_problem, short_by
from pushpressslide.robots.reach_map import each_reached, has_tables, surely_reached
from pushpressslide.robots.sheet import largest_force, largest_press
from pushpressslide.robots.tool import SIDES, TOOL_TILTS, ToolAttitude

DOWN = np.array([0.0, 0.0, -1.0])
# share of the largest press in the ready posture below which no other posture is
# checked
EASY = 0.5
# [rad] the only lean along the face that is tried for a tool tilted away from its arm
ASIDE = (math.radians(20.0), math.radians(60.0))
# angles from behind the contact, for a tool that turns with the object
LEANS = tuple(math.radians(a) for a in (0.0, -45.0, 45.0, -75.0, 75.0))
UNKNOWN = Refusal("reach", "the arm does not surely reach it, upright or tilted")
TURNING = 0.3  # [rad] turn of the object on its path above which such tools are tried


def contact_refusal(
    scene: Scene,
    contact: Contact,
    bodies: Sequence[Pose2],
    *,
    alone: bool = False,
    quick: bool = False,
) -> Refusal | None:
    """Refusal of a contact that its arm cannot follow along the body poses X_WB with
    one tool attitude, or None.

    ``alone`` marks a press that is the only contact, and whose tip must not roll far.
    With ``quick`` there is no search: everything that the reach tables do not contain
    is refused.
    """
    weak = press_refusal(scene, contact)
    if weak is not None:
        return weak
    robot = scene.robots[contact.arm]
    frame = scene.support.frame
    point, height = contact.tip_place(robot.tip_radius)
    points = [frame.point((*X_WB.apply(point), height)) for X_WB in bodies]
    middle = bodies[len(bodies) // 2]
    azimuths = tool_azimuths(contact, middle, scene.bases[contact.arm])
    yaws = np.unwrap([X_WB.yaw for X_WB in bodies])
    turned = float(np.ptp(yaws))
    tilted = [(tilt, azimuth) for tilt in TOOL_TILTS[1:] for azimuth in azimuths]
    fixed = [ToolAttitude(*held, frame.axes) for held in [(0.0, 0.0), *tilted]]
    if alone:
        upper = margins.ROLLED * math.hypot(*contact.point)
        fixed = [h for h in fixed if h.rolled(robot.tip_radius, turned) <= upper]
    if frame == TABLE:
        if surely_reached(robot, points, fixed if quick else fixed[:1]):
            return None
        if quick:
            return UNKNOWN
    beyond = span_refusal(scene, contact, bodies)
    if beyond is not None:
        return beyond
    holds: list[tuple[ToolAttitude, NDArray[np.float64] | None]] = []
    holds += [(hold, None) for hold in fixed]
    if turned > TURNING:
        behind = math.atan2(contact.normal[1], contact.normal[0])
        holds += [
            (
                ToolAttitude(TOOL_TILTS[-1], side, frame.axes, turns=True),
                yaws + behind + lean - side,
            )
            for lean in LEANS
            for side in SIDES
        ]
    problem = held_somehow_problem(robot, points, holds)
    return None if problem is None else Refusal("reach", literal(problem))


def press_refusal(scene: Scene, contact: Contact) -> Refusal | None:
    """Refusal of a press that exceeds the arm's largest press over the table, or that
    the arm is too late to control, or None.
    """
    robot = scene.robots[contact.arm]
    if contact.load == 0.0:
        return None
    late = _late_refusal(robot)
    if late is not None or robot.model == "hand":
        return late
    unplaced = at_origin(robot)
    changed = changed_at(robot)
    if contact.load <= EASY * _ready_press(unplaced, changed):
        return None
    most = _largest_press(unplaced, changed)
    if contact.load <= most:
        return None
    name = arm_kinematics(robot).facts.name
    text = (
        f"the press needs {{figure:N.1f}}, {literal(name)} gives at most "
        "{allowed:N.1f} over the table by its joints' torque limits"
    )
    return Refusal("arm_torque", text, contact.load, most, "N")


def _late_refusal(robot: Robot) -> Refusal | None:
    """Refusal of a press by an arm that takes too long to follow a command, or None."""
    most = margins.ARM.longest_reaction
    if robot.reaction <= most:
        return None
    text = (
        "the arm follows a command after {figure:s.3f} (lag, delay and one period of "
        "its rate), a press allows at most {allowed:s.3f}"
    )
    return Refusal("late_arm", text, robot.reaction, most, "s")


@lru_cache(maxsize=16)
def _ready_press(robot: Robot, changed: int) -> float:
    """Largest press [N] of a robot in its ready posture, cached until its file
    changes.
    """
    kin = arm_kinematics(robot)
    return float(largest_force(kin, kin.facts.home[None], DOWN)[0])


@lru_cache(maxsize=16)
def _largest_press(robot: Robot, changed: int) -> float:
    """Largest press [N] of a robot, cached until its file changes."""
    return largest_press(arm_kinematics(robot))


def span_refusal(
    scene: Scene, contact: Contact, bodies: Sequence[Pose2]
) -> Refusal | None:
    """Refusal of body poses X_WB that place a contact farther from its arm's shoulder
    than the arm is long, or None.

    The tool may lean towards the base.
    """
    robot = scene.robots[contact.arm]
    kin = arm_kinematics(robot)
    frame = scene.support.frame
    base_x, base_y, _ = scene.bases[contact.arm]
    point, height = contact.tip_place(robot.tip_radius)
    places = [X_WB.apply(point) for X_WB in bodies]
    points = np.array([frame.point((x, y, height)) for x, y in places])
    away = np.array([math.atan2(y - base_y, x - base_x) for x, y in places])
    shortest = np.full(len(places), math.inf)
    for tilt in TOOL_TILTS:
        lean = math.sin(tilt)
        down = np.full(len(places), -math.cos(tilt))
        axes = np.column_stack([lean * np.cos(away), lean * np.sin(away), down])
        short = short_by(kin, points, axes @ np.array(frame.axes).T)
        shortest = np.minimum(shortest, short)
    worst = int(shortest.argmax())
    if shortest[worst] <= 0.0:
        return None
    x, y, z = points[worst].tolist()
    far = math.dist(places[worst], (base_x, base_y))
    text = (
        f"{literal(kin.facts.name)} cannot bring its tip to ({x:.3f}, {y:.3f}, "
        f"{z:.3f}), {far:.3f} m from its base's axis: {{figure:mm.0f}} beyond its span"
    )
    return Refusal("reach", text, float(shortest[worst]), 0.0, "m")


def contacts_reached(
    scene: Scene, arm: int, contacts: Sequence[Contact], bodies: Sequence[Pose2]
) -> NDArray[np.bool_]:
    """Mask (n, m) of the m contacts of one kind that an arm reaches at n body poses
    X_WB, according to the reach tables. All True if the tables do not apply.
    """
    shape = (len(bodies), len(contacts))
    robot = scene.robots[arm]
    frame = scene.support.frame
    known = robot.model == "hand" or has_tables(robot)
    if frame != TABLE or 0 in shape or not known:
        return np.full(shape, True)
    base = scene.bases[arm]
    tips = [contact.tip_place(robot.tip_radius) for contact in contacts]
    points = [frame.point((*X.apply(p), h)) for X in bodies for p, h in tips]
    azimuths = [tool_azimuths(contact, X, base) for X in bodies for contact in contacts]
    widest = max(map(len, azimuths))
    filled = [(*each, *[each[0]] * (widest - len(each))) for each in azimuths]
    reachable = each_reached(robot, np.array(points), np.array(filled))
    return reachable.reshape(shape)


def tool_azimuths(
    contact: Contact, X_WB: Pose2, base: tuple[float, float, float]
) -> tuple[float, ...]:
    """Azimuths [rad] to try for a tilted tool.

    The tip of a push leans along the face's inward normal or, within the limits of the
    face, farther away from the arm's base. The tip of a press leans away from the base,
    or towards it.
    """
    x, y = X_WB.apply(contact.point)
    outward = math.atan2(y - base[1], x - base[0])
    if contact.kind == "top":
        return (outward, outward + math.pi)
    nx, ny = X_WB.rotate(contact.normal)
    behind = math.atan2(ny, nx)
    aside = math.remainder(outward - behind, math.tau)
    if not ASIDE[0] < abs(aside) < 0.5 * math.pi:
        return (behind,)
    return (behind, behind + math.copysign(min(abs(aside), ASIDE[1]), aside))
