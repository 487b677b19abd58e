"""Comparison of the selection's ranking with the results of all feasible modes.

On twenty tasks of different kinds, every feasible mode is run on the planar engine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import process_time
from typing import Any, NamedTuple

from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import (
    Box,
    Cylinder,
    Limits,
    ObjectModel,
    Prism,
    Robot,
    Shape,
    Support,
    Task,
    Tolerance,
)
from pushpressslide.selection.select import select

Row = dict[str, Any]

ONE_ARM = (Robot("panda", (0.0, 0.0, 0.0)),)
TWO_ARMS = (Robot("iiwa7", (0.0, 0.4, 0.2)), Robot("iiwa7", (0.0, -0.4, 0.2)))


def _regular(corners: int, radius: float, height: float) -> Prism:
    angles = [2.0 * math.pi * i / corners for i in range(corners)]
    return Prism(
        tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles), height
    )


class Case(NamedTuple):
    """One task of the study. Lengths are in [m], yaws in [deg]."""

    name: str
    robots: tuple[Robot, ...]
    shape: Shape
    mass: float  # [kg]
    support: float  # friction of the pair object/support
    tip: float  # friction of the pair tip/object
    start: tuple[float, float, float]
    goal: tuple[float, float, float]

    @property
    def task(self) -> Task:
        """The task, with every mode that the robots allow."""
        x, y, yaw = self.start
        gx, gy, gyaw = self.goal
        return Task(
            self.name,
            ObjectModel(self.shape, self.mass, (0.0, 0.0)),
            Pose2(x, y, math.radians(yaw)),
            Pose2(gx, gy, math.radians(gyaw)),
            self.robots,
            Support(friction=self.support),
            self.tip,
            Tolerance(0.01, math.radians(2.0)),
            limits=Limits(time=60.0, normal_force=60.0),
        )


HEXAGON = _regular(6, 0.09, 0.1)
TRIANGLE = _regular(3, 0.2, 0.1)
CUBE = Box((0.15, 0.15, 0.15))
TILE = Box((0.2, 0.15, 0.06))
BAR = Box((0.4, 0.12, 0.06))
LARGE = Box((0.4, 0.4, 0.2))
FLAT = Box((0.4, 0.3, 0.1))
SMALL = Box((0.24, 0.2, 0.1))
HEAVY = Box((0.2, 0.2, 0.12))
DIE = Box((0.08, 0.08, 0.08))
PUCK = Cylinder(0.08, 0.06)
CASES = (
    Case(
        "cube ahead", ONE_ARM, CUBE, 1.0, 0.3, 0.6, (0.40, 0.0, 0.0), (0.65, 0.0, 0.0)
    ),
    Case(
        "cube ahead, turned",
        ONE_ARM,
        CUBE,
        1.0,
        0.3,
        0.6,
        (0.40, -0.15, 0.0),
        (0.66, 0.02, 35.0),
    ),
    Case(
        "cube aside",
        ONE_ARM,
        CUBE,
        1.0,
        0.3,
        0.6,
        (0.50, 0.20, 0.0),
        (0.52, -0.18, 0.0),
    ),
    Case(
        "tile turned on the spot",
        ONE_ARM,
        TILE,
        0.5,
        0.3,
        0.8,
        (0.50, 0.0, 0.0),
        (0.50, 0.0, 60.0),
    ),
    Case(
        "tile backwards",
        ONE_ARM,
        TILE,
        0.5,
        0.3,
        0.8,
        (0.65, 0.05, 0.0),
        (0.42, 0.05, 0.0),
    ),
    Case(
        "tile a little aside",
        ONE_ARM,
        TILE,
        0.5,
        0.3,
        0.8,
        (0.50, 0.0, 0.0),
        (0.52, 0.06, 0.0),
    ),
    Case(
        "bar turned far",
        ONE_ARM,
        BAR,
        0.4,
        0.25,
        0.9,
        (0.50, -0.25, 90.0),
        (0.50, 0.20, 60.0),
    ),
    Case(
        "heavy box, smooth tip",
        ONE_ARM,
        HEAVY,
        3.0,
        0.4,
        0.45,
        (0.42, 0.1, 0.0),
        (0.62, 0.05, -15.0),
    ),
    Case(
        "small cube",
        ONE_ARM,
        DIE,
        0.3,
        0.3,
        0.7,
        (0.40, 0.15, -30.0),
        (0.62, 0.0, -50.0),
    ),
    Case(
        "hexagon",
        ONE_ARM,
        HEXAGON,
        0.8,
        0.25,
        0.7,
        (0.45, -0.1, 0.0),
        (0.55, 0.2, 40.0),
    ),
    Case("puck", ONE_ARM, PUCK, 0.5, 0.25, 0.8, (0.45, -0.15, 0.0), (0.60, 0.1, 0.0)),
    Case(
        "large box ahead",
        TWO_ARMS,
        LARGE,
        2.0,
        0.3,
        0.6,
        (0.50, 0.0, 0.0),
        (0.75, 0.0, 0.0),
    ),
    Case(
        "large box, turned ahead",
        TWO_ARMS,
        LARGE,
        2.0,
        0.3,
        0.6,
        (0.46, 0.05, 0.0),
        (0.72, -0.05, -20.0),
    ),
    Case(
        "large box, diagonal",
        TWO_ARMS,
        LARGE,
        2.0,
        0.3,
        0.6,
        (0.45, 0.12, 45.0),
        (0.65, 0.0, 50.0),
    ),
    Case(
        "flat box aside",
        TWO_ARMS,
        FLAT,
        2.0,
        0.3,
        0.8,
        (0.55, -0.12, 0.0),
        (0.55, 0.12, 0.0),
    ),
    Case(
        "flat box turned on the spot",
        TWO_ARMS,
        FLAT,
        2.0,
        0.3,
        0.8,
        (0.58, 0.0, 0.0),
        (0.58, 0.0, 40.0),
    ),
    Case(
        "flat box backwards",
        TWO_ARMS,
        FLAT,
        2.0,
        0.3,
        0.8,
        (0.68, 0.0, 0.0),
        (0.50, 0.03, 15.0),
    ),
    Case(
        "flat box, smooth tips",
        TWO_ARMS,
        FLAT,
        4.0,
        0.4,
        0.4,
        (0.50, 0.0, 0.0),
        (0.72, 0.06, 15.0),
    ),
    Case(
        "small box ahead",
        TWO_ARMS,
        SMALL,
        1.0,
        0.25,
        0.9,
        (0.50, 0.0, 0.0),
        (0.70, 0.05, 10.0),
    ),
    Case(
        "triangle ahead",
        TWO_ARMS,
        TRIANGLE,
        1.5,
        0.3,
        0.7,
        (0.50, 0.0, 0.0),
        (0.72, 0.0, 0.0),
    ),
)


def study(cases: Sequence[Case] = CASES) -> list[Row]:
    """A row for each case, with the selection's ranking of the modes and their results.

    Each row has the processor time [ms] of the selection, the mode that is ranked
    first, and the mode that reached the goal first. For the best choice of every
    feasible mode it has the estimated and the true time [s].
    """
    # what is read once is not counted
    for robots in {case.robots: None for case in cases}:
        select(next(case for case in cases if case.robots == robots).task)
    return [_row(case) for case in cases]


def _row(case: Case) -> Row:
    task = case.task
    begun = process_time()
    choices = select(task)
    spent = process_time() - begun
    best: dict[str, Choice] = {}
    for choice in choices:
        if choice.feasible:
            best.setdefault(choice.mode, choice)
    runs = {mode: _run(task, choice) for mode, choice in best.items()}
    reached = {mode: time for mode, (time, success) in runs.items() if success}
    winner = next(iter(best), "")
    soonest = min(reached, key=reached.__getitem__, default="")
    estimated = {mode: choice.time or math.nan for mode, choice in best.items()}
    modes = {
        mode: {"estimated": estimated[mode], "true": time, "reached": success}
        for mode, (time, success) in runs.items()
    }
    return {
        "task": case.name,
        "select_ms": 1e3 * spent,
        "winner": winner,
        "soonest": soonest,
        "right": bool(winner) and winner == soonest,
        "times": "; ".join(
            _sentence(mode, estimated[mode], *run) for mode, run in runs.items()
        ),
        "modes": modes,
    }


def _run(task: Task, choice: Choice) -> tuple[float, bool]:
    """Duration [s] of a choice's planar run, and whether it succeeds."""
    from pushpressslide.planar.engine import run
    from pushpressslide.report.metrics import result

    plan = Plan(task).of_choices([choice])
    record = run(plan)
    return float(record.arrays["time"][-1]), bool(result(task, plan, record)["success"])


def _sentence(mode: str, estimated: float, true: float, reached: bool) -> str:
    if not reached:
        return f"{mode} misses"
    return f"{mode} {true:.1f} s (estimated {estimated:.1f})"
