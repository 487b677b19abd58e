"""Quasi-static motions scale: with every length times k, every force times m and every
speed times sqrt(k), those of the arms included, the plan is the same.

The arms' reach is left out, since no arm's joints scale. The effect of a margin in the
wrong unit shows here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache

import pytest

from pushpressslide.core import margins
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, ObjectModel, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.geometry.shapes import Box, Cylinder, Prism, Shape
from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes import base, press_slide
from pushpressslide.selection.select import select
from pushpressslide.taskfile.load import load_task

EXPONENTS = {
    "m": (1.0, 0),
    "s": (0.5, 0),
    "1/s": (-0.5, 0),
    "m/s": (0.5, 0),
    "1": (0.0, 0),
}
"""Powers of k and m by which a margin in a unit scales; newtons scale with m."""
EXPONENTS["N"] = (0.0, 1)
EXPONENTS["N/m"] = (-1.0, 1)
TASKS = (
    "rear-push-rear",
    "press-slide",
    "orthogonal-push",
    "parallel-push",
    "bimanual-slide",
    "pivot-and-move",
)
PINNED = TASKS[-1]
TIE = 1e-3  # [s] within which choices count as equally quick
SCALES = ((0.2, 1.0), (0.5, 0.1), (1.7, 3.0), (5.0, 10.0))


def scaled_pose(X: Pose2, k: float) -> Pose2:
    return Pose2(k * X.x, k * X.y, X.yaw)


def scaled_shape(shape: Shape, k: float) -> Shape:
    if isinstance(shape, Box):
        x, y, z = shape.size
        return Box((k * x, k * y, k * z))
    if isinstance(shape, Cylinder):
        return Cylinder(k * shape.radius, k * shape.height)
    assert isinstance(shape, Prism)
    outline = tuple((k * x, k * y) for x, y in shape.corners)
    return Prism(outline, k * shape.height)


def scaled(task: Task, k: float, m: float) -> Task:
    """Return ``task`` with lengths times ``k``, forces times ``m``, speeds times the
    root of ``k``.
    """
    root = math.sqrt(k)
    body = task.object
    cx, cy = body.center_of_mass
    motion = task.motion
    robots = tuple(
        replace(
            robot,
            base=tuple(k * x for x in robot.base),
            tip_radius=k * robot.tip_radius,
            tip_length=k * robot.tip_length,
        )
        for robot in task.robots
    )
    contacts = motion.contacts
    if contacts is not None:
        contacts = tuple((k * x, k * y) for x, y in contacts)
    height = motion.contact_height
    if height is not None:
        height = k * height
    tolerance = task.tolerance
    return replace(
        task,
        object=ObjectModel(
            scaled_shape(body.shape, k), m * body.mass, (k * cx, k * cy)
        ),
        start=scaled_pose(task.start, k),
        goal=scaled_pose(task.goal, k),
        robots=robots,
        tolerance=replace(tolerance, position=k * tolerance.position),
        limits=replace(
            task.limits,
            time=root * task.limits.time,
            normal_force=m * task.limits.normal_force,
        ),
        motion=replace(
            motion,
            speed=root * motion.speed,
            run_in=k * motion.run_in,
            approach_distance=k * motion.approach_distance,
            contacts=contacts,
            contact_height=height,
        ),
    )


def scaled_arm(k: float, m: float) -> margins.ArmMargins:
    changed = {}
    for one in fields(margins.ARM):
        of_k, of_m = EXPONENTS[one.metadata["unit"]]
        changed[one.name] = getattr(margins.ARM, one.name) * k**of_k * m**of_m
    return replace(margins.ARM, **changed)


@pytest.fixture
def no_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(base, "contact_refusal", lambda *_, **__: None)
    monkeypatch.setattr(press_slide, "span_refusal", lambda *_, **__: None)


@cache
def based_on(name: str) -> Task:
    return load_task(name)


def tasks(name: str) -> Iterator[Task]:
    if name == PINNED:
        first = based_on(name).queries()[0]
        assert first.modes == ("press_and_push",)
        alone = replace(based_on(name), legs=(), modes=first.modes, goal=first.goal)
        part = replace(alone, motion=first.motion)
        for mass in (2.0, 4.0, 5.0):
            box = replace(part.object, mass=mass)
            yield replace(part, object=box, obstacles=(), belief=Belief())
        return
    for draw in ("ahead", "any"):
        for index in range(4):
            drawn = random_task(based_on(name), index, 5, draw)
            yield replace(drawn, belief=Belief())


def pieces(path: ArcPath | TwistPath, k: float) -> list[float]:
    """Return the path's parts, as they would be at k = 1."""
    if isinstance(path, ArcPath):
        return [x for bent, length in path.sections for x in (bent * k, length / k)]
    rates = [(*rate, length) for rate, length in path.sections]
    return [x for vx, vy, w, length in rates for x in (vx, vy, w * k, length / k)]


def figures(segment: Segment, k: float, m: float) -> list[float]:
    """Return all that a segment is planned as, as it would be at k = 1 and m = 1."""
    drive = segment.drive
    out = [segment.path.length / k, segment.profile.speed / math.sqrt(k)]
    out += pieces(segment.path, k)
    for contact in segment.contacts:
        x, y = contact.point
        out += [x / k, y / k, contact.height / k, contact.load / m]
    for name in ("look_ahead", "radius", "run_in"):
        if hasattr(drive, name):
            out.append(getattr(drive, name) / k)
    return out


def best(task: Task) -> Choice:
    return select(task)[0]


def check(task: Task, k: float, m: float, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether a task has a plan; asserts that the scaled one has the scaled plan."""
    first = best(task)
    with monkeypatch.context() as patch:
        patch.setattr(margins, "ARM", scaled_arm(k, m))
        other = best(scaled(task, k, m))
    assert other.feasible == first.feasible
    assert other.mode == first.mode
    if not first.feasible:
        return False
    root = math.sqrt(k)
    ties = TIE * (1.0 + root)
    assert other.time == pytest.approx(root * first.time, rel=1e-6, abs=ties)
    assert len(other.segments) == len(first.segments)
    for before, after in zip(first.segments, other.segments, strict=True):
        wanted = figures(before, 1.0, 1.0)
        assert figures(after, k, m) == pytest.approx(wanted, rel=1e-5, abs=1e-7)
    return True


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize(("k", "m"), SCALES)
def test_a_task_of_another_size_has_the_scaled_plan_of_the_same_choice(
    name, k, m, no_reach, monkeypatch
) -> None:
    planned = [check(task, k, m, monkeypatch) for task in tasks(name)]
    assert sum(planned) >= 3


def test_every_margin_of_the_arm_says_its_unit() -> None:
    assert {one.metadata["unit"] for one in fields(margins.ARM)} <= EXPONENTS.keys()
