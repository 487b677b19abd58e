"""Manoeuvres of a pressed object: up to three turns, each by a force at one angle, and
a straight run-in.

They reach goals to which no path of a single vehicle leads. Errors decay on the run-in.

Source: docs/mechanics.md, sections 1.2, 2 and 4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import ObjectModel, Scene
from pushpressslide.mechanics.friction import utilisation_margin
from pushpressslide.mechanics.pressing import press_utilisation
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pressed.three_turns import words
from pushpressslide.planning.pressed.turns import PressedTurn, pressed_turns
from pushpressslide.planning.pressed.vehicle import press_of
from pushpressslide.planning.segments import describe_points
from pushpressslide.rom.drives import TurnDrive
from pushpressslide.rom.unicycle import Unicycle

COUNT = 3  # words per run-in that are handed on


@dataclass(frozen=True, slots=True)
class DrivenTurn:
    """One turn of a manoeuvre."""

    turn: PressedTurn
    path: ArcPath  # of the turn's axle
    end: Pose2  # X_WB
    speed: float  # [m/s]
    most_speed: float  # [m/s] of the task

    @property
    def look_ahead(self) -> float:
        """Look-ahead [m]: a third of the vehicle's length, or more if even full
        steering corrects little.
        """
        press = self.turn.press
        wheelbase = abs(self.turn.effective_wheelbase)
        upper = min(self.turn.left, -self.turn.right)
        aside = margins.CORRECTED * press.body.radius
        lower = math.sqrt(4.0 * aside * wheelbase / math.tan(upper))
        length = wheelbase + press.lever
        return margins.ARM.look_ahead(length, self.most_speed, lower)

    def drive(self, max_friction: float, last: bool) -> TurnDrive:
        """Drive of the turn. ``last`` marks the run-in."""
        turn = self.turn
        press = turn.press
        X_BV = turn.X_BV
        wheelbase = abs(turn.effective_wheelbase)
        ex, ey = press.axis
        cop = press.cop
        backward = abs(turn.angle) > 0.5 * math.pi
        ahead = (X_BV.x - cop[0]) * ex + (X_BV.y - cop[1]) * ey
        shift = ahead + wheelbase
        if backward:
            shift = -ahead - wheelbase
        rho = math.sqrt(wheelbase * press.lever)
        across = math.sin(turn.angle) ** 2
        if across < 1e-3:
            stiffness = press.lever / wheelbase
        else:
            stiffness = (1.0 / turn.share**2 - 1.0) / across
        return TurnDrive(
            car=Unicycle(press.contact, cop, rho, backward, shift),
            max_friction=max_friction,
            X_BV=X_BV,
            look_ahead=self.look_ahead,
            axis_angle=turn.angle,
            angle=math.atan2(ey, ex) + turn.angle,
            turn=self.path.curvature(0.0),
            effective_wheelbase=turn.effective_wheelbase,
            right=turn.right,
            left=turn.left,
            stiffness=stiffness,
            last=last,
        )


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """Turns in order, the last of which is the run-in, and their total time."""

    contact: Contact
    start: Pose2  # X_WB
    goal: Pose2  # X_WB
    most_speed: float  # [m/s] of the task
    arcs: tuple[
        tuple[PressedTurn, float, tuple[float, float]], ...
    ]  # speed [m/s], curvature [1/m], length [m]
    time: float  # [s]

    @property
    def driven_turns(self) -> list[DrivenTurn]:
        """The turns with the paths of their axles."""
        out = []
        X = self.start
        for turn, speed, arc in self.arcs[:-1]:
            path = ArcPath(X.compose(turn.X_BV), (arc,))
            X = path.end.compose(turn.X_BV.inverse())
            out.append(DrivenTurn(turn, path, X, speed, self.most_speed))
        turn, speed, (_, length) = self.arcs[-1]
        path = ArcPath(
            advance(self.goal.compose(turn.X_BV), 0.0, -length), ((0.0, length),)
        )
        return [*out, DrivenTurn(turn, path, self.goal, speed, self.most_speed)]

    def choice(self, query: MotionQuery, mode: str) -> Choice:
        """The manoeuvre as a choice of ``mode``, with a segment for each turn."""
        scene = query.scene
        contact = self.contact
        utilisation = press_utilisation(scene, contact.load)
        margin = utilisation_margin(scene.contact_friction, utilisation)
        max_friction = scene.max_friction(contact.load)
        X_BG = query.X_GB.inverse()
        driven_turns = self.driven_turns
        run_in = driven_turns[-1]
        segments = []
        for driven in driven_turns:
            last = driven is run_in
            path = driven.path
            goal = query.goal
            if not last:
                goal = driven.end.compose(X_BG)
            drive = driven.drive(max_friction, last)
            profile = SpeedProfile(path.length, driven.speed, query.motion.acceleration)
            segments.append(
                Segment(mode, (contact,), drive, path, profile, goal, margin)
            )
        turns = ", ".join(
            f"{1e3 * driven.path.length:.0f} mm at "
            f"{math.degrees(driven.turn.angle):.0f} deg"
            for driven in driven_turns
        )
        moving = sum(segment.profile.duration for segment in reversed(segments))
        return Choice(
            mode,
            f"manoeuvre at {describe_points([contact.point])}",
            (contact,),
            tuple(segments),
            moving + overhead(query.motion, pressed=True),
            f"{contact.load:.1f} N, {turns}; {utilisation:.2f} of the tip's friction "
            "used",
        )


def pressed_manoeuvres(
    query: MotionQuery,
    X_WB: Pose2,
    contacts: Sequence[Contact],
    swing: float = math.inf,
) -> list[Manoeuvre]:
    """Manoeuvres from ``X_WB`` to the goal of ``query`` by a press at one of
    ``contacts``, the quickest first.

    ``swing`` [rad] limits the rotation of the object from its present yaw.
    """
    _, goal = query.body_ends
    out = []
    for contact in contacts:
        if contact.point == (0.0, 0.0):
            continue
        usable = pressed_turns(press_of(query.scene, contact), query.motion.speed)
        if usable:
            out += _by_press(query, (X_WB, goal), contact, usable, swing)
    return sorted(out, key=lambda manoeuvre: manoeuvre.time)


@dataclass(frozen=True, slots=True)
class _RunIn:
    """A straight final segment that leads to the goal."""

    turn: PressedTurn
    speed: float  # [m/s]
    length: float  # [m]


def _by_press(
    query: MotionQuery,
    ends: tuple[Pose2, Pose2],
    contact: Contact,
    turns: Sequence[PressedTurn],
    swing: float,
) -> list[Manoeuvre]:
    """Quickest manoeuvres of one press, for each of its run-ins."""
    X_WB, goal = ends
    most_speed = query.motion.speed
    run_ins = _run_ins(query.scene, most_speed, goal, turns)
    if not run_ins:
        return []
    straight = straightest(query.body)
    turns = _both_ways(turns, straight)
    speeds = [_speed(most_speed, turn) for turn in turns]
    curvatures = [turn.curvature for turn in turns]
    bent = np.array([as_driven(each, each, straight) for each in curvatures])
    axles = np.array([complex(*turn.X_BV.position) for turn in turns])
    normals = 1j * np.exp(1j * np.array([turn.X_BV.yaw for turn in turns]))
    centers = axles + normals / bent
    times = 1.0 / (np.abs(bent) * np.array(speeds))
    free = np.array([min(-turn.right, turn.left) for turn in turns])
    lower = pause(query.motion)
    careful = lower + narrow(query.body, most_speed)
    pauses = np.where(free < margins.CORRECTING, careful, lower)
    stagings = [_staging(X_WB, goal, run_in) for run_in in run_ins]
    every = words(centers, np.sign(bent), times, pauses, stagings, COUNT, swing)
    out = []
    for run_in, quickest in zip(run_ins, every, strict=True):
        end = (run_in.turn, run_in.speed, (0.0, run_in.length))
        for word in quickest:
            time = word.time + run_in.length / run_in.speed + lower
            if time >= margins.LONGEST * query.limits.time:
                continue
            arcs = [
                (turns[c], speeds[c], (float(bent[c]), float(angle / bent[c])))
                for c, angle in zip(word.turns, word.angles, strict=True)
            ]
            out.append(Manoeuvre(contact, X_WB, goal, most_speed, (*arcs, end), time))
    return out


def pause(motion: Motion) -> float:
    """Extra time [s] of a turn, which starts and ends at rest."""
    return margins.REST_TO_REST * motion.speed / motion.acceleration


def narrow(body: ObjectModel, speed: float) -> float:
    """Time [s] that a turn with little steering reserve must save at ``speed`` [m/s] to
    be preferred.
    """
    return margins.NARROW * body.radius / speed


def straightest(body: ObjectModel) -> float:
    """Curvature [1/m] below which a turn counts as straight.

    A straight motion is treated as a turn about a distant centre.
    """
    return margins.STRAIGHTEST / body.radius


def _both_ways(turns: Sequence[PressedTurn], straight: float) -> list[PressedTurn]:
    """The turns, and for each turn with a curvature below ``straight`` [1/m] a copy
    that bends to the other side.
    """
    others = [turn for turn in turns if abs(turn.curvature) < straight]
    return [*turns, *(replace(turn, curvature=-turn.curvature) for turn in others)]


def _run_ins(
    scene: Scene, max_speed: float, goal: Pose2, turns: Sequence[PressedTurn]
) -> list[_RunIn]:
    """Run-ins along the straight turns that leave enough steering for corrections, at a
    speed of up to ``max_speed`` [m/s].
    """
    out = []
    for turn in turns:
        if _straight(turn) and min(-turn.right, turn.left) >= margins.CORRECTING:
            speed = _speed(max_speed, turn)
            path = ArcPath(turn.X_BV, ())
            look_ahead = DrivenTurn(turn, path, goal, speed, max_speed).look_ahead
            out += [_RunIn(turn, speed, k * look_ahead) for k in scene.run_ins]
    return out


def _staging(X_WB: Pose2, goal: Pose2, run_in: _RunIn) -> Pose2:
    """Pose, relative to B, from which a run-in leads to ``goal``."""
    yaw = run_in.turn.X_BV.yaw
    length = run_in.length
    back = Pose2(-length * math.cos(yaw), -length * math.sin(yaw), 0.0)
    ahead = X_WB.inverse().compose(goal.compose(back))
    return Pose2(ahead.x, ahead.y, math.remainder(ahead.yaw, 2.0 * math.pi))


def _straight(turn: PressedTurn) -> bool:
    """Whether the turn is driven by a force along the heading axis."""
    return abs(math.remainder(turn.angle, math.pi)) < 1e-6


def _speed(speed: float, turn: PressedTurn) -> float:
    swing = min(1.0, margins.SWING / turn.pace)
    return speed * swing * min(1.0, turn.tipping_margin / margins.SAFE_MARGIN)


def as_driven(curvature: float, like: float, straight: float) -> float:
    """Curvature [1/m] with which a turn is driven: at least ``straight`` [1/m] in
    magnitude, with the sign of ``like``.

    Even a straight turn therefore has a centre, although a distant one.
    """
    if abs(curvature) >= straight:
        return curvature
    return math.copysign(straight, like)
