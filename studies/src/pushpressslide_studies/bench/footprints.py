"""Friction of flat bases in each simulator beside the exact integral: translation, turn
on the spot, pivots, pushes off centre, and creep.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.shapes import Box, Cylinder, Prism, Shape
from pushpressslide.report.json_text import to_json
from pushpressslide_studies.bench.footprint_laws import (
    Law,
    exact_law,
    gyration,
    planar_law,
    pushed_twist,
)
from pushpressslide_studies.footprint_body import FRICTION, MASS

FOOTPRINTS: dict[str, Shape] = {
    "square": Box((0.15, 0.15, 0.15)),
    "bar": Box((0.30, 0.05, 0.06)),
    "disc": Cylinder(0.08, 0.10),
    "T": Prism(
        (
            (-0.06, 0.03),
            (-0.06, 0.0),
            (-0.015, 0.0),
            (-0.015, -0.09),
            (0.015, -0.09),
            (0.015, 0.0),
            (0.06, 0.0),
            (0.06, 0.03),
        ),
        0.05,
    ),
    "L": Prism(
        (
            (0.0, 0.0),
            (0.15, 0.0),
            (0.15, 0.05),
            (0.05, 0.05),
            (0.05, 0.15),
            (0.0, 0.15),
        ),
        0.05,
    ),
}
SPEEDS = (0.01, 0.05)
"""Speeds [m/s]: of a translation, and at the radius of gyration of a turn."""
PIVOTS = tuple((lever, angle) for lever in (0.4, 0.8, 2.0) for angle in (0.3, 1.9))
"""Distances of the centre of rotation from the centroid, in radii of gyration, and their
directions [rad].
"""
LEVERS = (0.2, 0.6, 1.0)
"""Levers of the pushes about the centroid, in radii of gyration."""
SETTLED = 0.4
"""Time [s] after which a steady motion is measured."""
END = 0.6
"""Time [s] at which a steady motion ends."""
PUSH = 0.03
"""Largest path [m] of a push."""
RESPONSE = 0.01
"""Time constant [s] of the servo that leads a body."""
INTEGRAL = 0.01
"""Time constant [s] of the integral of its error."""
HELD = 0.8
"""Force, as a share of the friction, under which a body should rest."""


class Rig(Protocol):
    """A body on a plane in a simulator."""

    period: float  # [s]

    def start(self) -> None:
        """Put the body at rest at the origin."""

    def apply(self, wrench: Vector3) -> None:
        """Apply a wrench about the centroid of the base until the next call."""

    def step(self) -> None:
        """Simulate one period."""

    def motion(self) -> tuple[Pose2, Vector3]:
        """Pose and velocity of the base's centroid, with the turn rate."""


@dataclass(frozen=True)
class Errors:
    """Errors of one simulator on one footprint at one speed."""

    footprint: str
    engine: str
    speed: float  # [m/s]
    force: float  # of a translation, as a share of the exact one; the worst of two
    spin: float  # of the moment in a turn on the spot, as a share
    pivots: float  # worst error of six pivots, scaled by mu N and by the spin's moment
    pushes: (
        float  # of the yaw per path in pushes off centre, as a share; worst of three
    )
    creep: float  # [m/s] under 80 % of the friction


def measured(
    rig: Rig, footprint: str, engine: str, speeds: Iterable[float] = SPEEDS
) -> Iterator[Errors]:
    """Errors of a simulator at each speed."""
    shape = FOOTPRINTS[footprint]
    law = exact_law(shape)
    radius = gyration(shape)
    _, _, moment = law((0.0, 0.0, 1.0))
    scale = np.array((1.0, 1.0, moment))
    creep = _creep(rig)
    for speed in speeds:
        straight = ((speed, 0.0, 0.0), (0.6 * speed, 0.8 * speed, 0.0))
        turning = (0.0, 0.0, speed / radius)
        pivots = [
            _pivot(lever * radius, angle, radius, speed) for lever, angle in PIVOTS
        ]
        twists = (*straight, turning, *pivots)
        wrongs = [_wrong(rig, law, twist, radius) / scale for twist in twists]
        pushes = [
            _push_error(rig, law, (-radius, lever * radius), speed, radius)
            for lever in LEVERS
        ]
        yield Errors(
            footprint,
            engine,
            speed,
            max(float(np.hypot(*wrong[:2])) for wrong in wrongs[:2]),
            float(wrongs[2][2]),
            max(float(np.abs(wrong).max()) for wrong in wrongs[3:]),
            max(pushes, key=abs),
            creep,
        )


def _pivot(lever: float, angle: float, radius: float, speed: float) -> Vector3:
    """Twist about a point at a ``lever`` [m] from the centroid."""
    w = speed / (radius + lever)
    return (w * lever * math.sin(angle), -w * lever * math.cos(angle), w)


def _wrong(rig: Rig, law: Law, twist: Vector3, radius: float) -> np.ndarray:
    """Error (3,) of the wrench of a steady motion, per newton of friction, in the axes
    of the body.
    """
    rows = np.array(list(_led(rig, twist, radius)))
    settled = rows[round(SETTLED / rig.period) :].mean(axis=0)
    wrench, motion = settled[:3], settled[3:]
    vx, vy, w = motion.tolist()
    out: np.ndarray = wrench / _friction() - np.array(law((vx, vy, w)))
    return out


def _led(rig: Rig, twist: Vector3, radius: float) -> Iterator[tuple[float, ...]]:
    """Wrench and twist of a body that a servo leads with a ``twist`` that is constant in
    the body, all in its axes.
    """
    rig.start()
    total = np.zeros(3)
    inertia = MASS * np.array((1.0, 1.0, radius**2))
    for _ in range(round(END / rig.period)):
        pose, (vx, vy, w) = rig.motion()
        now = (*pose.unrotate((vx, vy)), w)
        error = np.subtract(twist, now)
        total += rig.period / INTEGRAL * error
        wrench = inertia / RESPONSE * (error + total)
        fx, fy, tau = wrench.tolist()
        rig.apply((*pose.rotate((fx, fy)), tau))
        rig.step()
        yield (fx, fy, tau, *now)


def _push_error(rig: Rig, law: Law, point: Point, speed: float, radius: float) -> float:
    """Mean error of the yaw per path of a push, as a share of the exact one.

    A force at ``point`` [m] from the centroid leads that point along x.
    """
    rig.start()
    total = np.zeros(2)
    errors = []
    ticks = round(min(END, PUSH / speed) / rig.period)
    for tick in range(ticks):
        pose, (vx, vy, w) = rig.motion()
        ax, ay = pose.rotate(point)
        velocity = (vx - w * ay, vy + w * ax)
        error = np.subtract((speed, 0.0), velocity)
        total += rig.period / INTEGRAL * error
        fx, fy = (MASS / RESPONSE * (error + total)).tolist()
        rig.apply((fx, fy, ax * fy - ay * fx))
        rig.step()
        if tick > 0.5 * ticks:
            led = pose.unrotate((speed, 0.0))
            _, _, wanted = pushed_twist(law, point, led, radius)
            errors.append(w / wanted - 1.0)
    return float(np.mean(errors))


def _creep(rig: Rig) -> float:
    """Mean speed [m/s] under a constant force below the friction, after a second."""
    rig.start()
    rig.apply((HELD * _friction(), 0.0, 0.0))
    places = []
    for _ in range(round(2.0 / rig.period)):
        rig.step()
        pose, _ = rig.motion()
        places.append(pose.x)
    return abs(places[-1] - places[len(places) // 2])


def _friction() -> float:
    return FRICTION * MASS * GRAVITY


def planar_errors(footprint: str) -> Errors:
    """Errors of the planar engine, which are the same at every speed."""
    shape = FOOTPRINTS[footprint]
    law, own = exact_law(shape), planar_law(shape)
    radius = gyration(shape)
    speed = SPEEDS[0]
    _, _, moment = law((0.0, 0.0, 1.0))
    _, _, found = own((0.0, 0.0, 1.0))
    scale = np.array((1.0, 1.0, moment))
    pivots = [_pivot(lever * radius, angle, radius, speed) for lever, angle in PIVOTS]
    wrongs = [np.subtract(own(twist), law(twist)) / scale for twist in pivots]
    force = math.hypot(*np.subtract(own((1.0, 0.0, 0.0)), law((1.0, 0.0, 0.0)))[:2])
    pushes = []
    for lever in LEVERS:
        push = ((-radius, lever * radius), (speed, 0.0), radius)
        pushes.append(pushed_twist(own, *push)[2] / pushed_twist(law, *push)[2] - 1.0)
    worst = max(float(np.abs(wrong).max()) for wrong in wrongs)
    spin = found / moment - 1.0
    return Errors(
        footprint, "planar", speed, force, spin, worst, max(pushes, key=abs), 0.0
    )


Progress = Callable[[float, float], None]


def all_errors(
    footprints: Sequence[str] = tuple(FOOTPRINTS), progress: Progress | None = None
) -> list[Errors]:
    """Errors of all simulators on all footprints."""
    from pushpressslide_studies.sim.footprint_rigs import DrakeRig, MujocoRig

    out = []
    for i, name in enumerate(footprints):
        shape = FOOTPRINTS[name]
        rigs: dict[str, Rig] = {
            "drake": DrakeRig(shape, plain=False),
            "drake_plain": DrakeRig(shape, plain=True),
            "mujoco_pyramid": MujocoRig(shape, "box_pyramid"),
            "mujoco_elliptic": MujocoRig(shape, "box"),
            "mujoco": MujocoRig(shape, "feet"),
        }
        out.append(planar_errors(name))
        for engine, rig in rigs.items():
            out += measured(rig, name, engine)
        if progress is not None:
            progress(i + 1.0, len(footprints))
    return out


TITLES = {
    "planar": "planar engine",
    "drake": "Drake, this scene",
    "drake_plain": "Drake, plain shape",
    "mujoco_pyramid": "MuJoCo, plain shape, pyramid",
    "mujoco_elliptic": "MuJoCo, plain shape, elliptic",
    "mujoco": "MuJoCo, feet",
}


def footprints(out: Path, progress: Progress | None = None) -> list[Errors]:
    """Measure all simulators, and write errors.json and page.md into the folder ``out``."""
    errors = all_errors(progress=progress)
    (out / "errors.json").write_text(to_json([asdict(one) for one in errors]), "utf-8")
    (out / "page.md").write_text(page(errors), "utf-8")
    return errors


def page(errors: Sequence[Errors]) -> str:
    """Tables of the errors as Markdown, one for each footprint."""
    lines = []
    for footprint in dict.fromkeys(one.footprint for one in errors):
        lines += [f"### {footprint}", "", *_table(errors, footprint), ""]
    return "\n".join(lines)


def _table(errors: Sequence[Errors], footprint: str) -> Iterator[str]:
    """Yield the rows of one footprint."""
    yield "| simulator | speed | force | spin | pivots | yaw per push | creep |"
    yield "|---|---|---|---|---|---|---|"
    for one in errors:
        if one.footprint != footprint:
            continue
        speed = "any" if one.engine == "planar" else f"{1e3 * one.speed:.0f} mm/s"
        shares = (
            f"{100.0 * one.force:.1f} %",
            f"{100.0 * one.spin:+.1f} %",
            f"{100.0 * one.pivots:.1f} %",
            f"{100.0 * one.pushes:+.1f} %",
            f"{1e6 * one.creep:.0f} µm/s",
        )
        yield f"| {' | '.join((TITLES[one.engine], speed, *shares))} |"
