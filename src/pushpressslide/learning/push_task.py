"""Tasks for learning: one object on a table, pushed by one tip on a straight face, and
the parameters of their environment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from pushpressslide.core.errors import Shown, TaskError
from pushpressslide.core.plan import Choice, Contact
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.task import Belief, Task
from pushpressslide.core.truth import EXACT
from pushpressslide.modes.rear_push import MODE
from pushpressslide.planning.rear_car_fit import FittedFace, fitted_faces
from pushpressslide.planning.side_contacts import lone_contact_height
from pushpressslide.taskfile.load import load_task

PERIOD = 0.05
"""Duration [s] of a step."""
SPREAD = (0.05, 0.05, math.radians(15.0))
"""Largest offset of a random start from the task's start, to either side: x, y [m] and
yaw [rad].
"""
FIELD = 10.0
"""Largest coordinate [m] of a start, and of a goal."""
FASTER = 4.0  # largest speed of a tip along x and along y, over motion.speed
LONGER = 2.0  # longest episode, over the planned duration


Threshold = tuple[float, float]
"""Errors within which an episode is a success: position [m] and yaw [rad]."""


def with_threshold(task: Task, threshold: Threshold | None) -> Task:
    """The task with ``threshold`` as its tolerance, if one is given.

    Raises InputError unless both errors are > 0.
    """
    if threshold is None:
        return task
    position, yaw = threshold
    return replace(task, tolerance=replace(task.tolerance, position=position, yaw=yaw))


@dataclass(frozen=True, slots=True)
class PushTask:
    """True parameters of a task of one push, and the parameters of its environment.

    The object is on an ellipsoid, chosen so that it moves as on the exact limit surface
    under the forces with which a planned path turns. The origin of frame B is the
    centre of pressure, which the support's friction shifts ahead of the centre of mass;
    its axes are parallel to those of G.
    """

    task: Task
    face: int  # index of the pushed face
    contact: Contact  # middle of the face, in the frame at the true centre of mass
    foot: Point  # [m] in B, foot of the face
    normal: Point  # unit, inward
    # [m] right and left end of the face, from its foot
    ends: tuple[float, float] = (-math.inf, math.inf)
    rho: float = 1.0  # [m]
    center: Point = (0.0, 0.0)  # [m] origin of B in G
    steps: int = 1  # steps of the longest episode

    @property
    def speed_limit(self) -> float:
        """Largest speed [m/s] of the tip along x and along y of the world."""
        return FASTER * self.task.motion.speed

    @property
    def reach(self) -> float:
        """Largest coordinate [m] at which object and tip may be."""
        path = PERIOD * self.steps * self.speed_limit
        return FIELD + path + 2.0 * self.task.object.radius


def push_task(task: Task | str | Path, threshold: Threshold | None = None) -> PushTask:
    """Task of one push, given directly or by the name or path of a task file.

    ``threshold`` replaces the task's tolerance. Raises TaskError for any other kind of
    task.
    """
    loaded = task if isinstance(task, Task) else load_task(task)
    loaded = with_threshold(loaded, threshold)
    _check(loaded)
    planned = choice(loaded.query)
    (segment,) = planned.segments
    (contact,) = segment.contacts
    truth = replace(loaded, belief=Belief(), start_error=Pose2())
    fitted = _face_at(truth.query, contact.point, contact.normal)
    steps = math.ceil(LONGER * segment.profile.duration / PERIOD)
    return _figures(truth, loaded, fitted, steps)


def faces_of(push: PushTask) -> list[PushTask]:
    """Copies of the task, one for each flat face that can be pushed."""
    truth = replace(push.task, belief=Belief(), start_error=Pose2())
    scene = truth.scene
    fitted = fitted_faces(scene, replace(truth.motion, face=None))
    flat = [one for one in fitted if one.face.flat and one.cars]
    return [_figures(truth, push.task, one, push.steps) for one in flat]


def choice(query: MotionQuery, face: int | None = None) -> Choice:
    """Fastest push for a query, on ``face`` if given, without a check of the arm's
    reach.

    Raises TaskError if no face can be pushed.
    """
    index = query.motion.face if face is None else face
    asked = replace(query, motion=replace(query.motion, face=index))
    choices: list[Choice] = []
    for candidate in MODE.candidates(asked):
        found = [candidate] if isinstance(candidate, Choice) else candidate.make(True)
        choices += found
    feasible = [one for one in choices if one.segments]
    if not feasible:
        reason = "; ".join(str(one.refusal) for one in choices) or "it has no face"
        raise _refused(
            query.source, "object", "this", f"no face can be pushed: {reason}"
        )
    return min(feasible, key=lambda one: (not one.feasible, one.time))


def _check(task: Task) -> None:
    """Raise TaskError unless a task is one push of one body on a table."""
    source = task.source or task.name
    kind = task.support.kind
    if kind != "table":
        raise _refused(source, "support.kind", kind, "allowed to learn: table")
    if task.modes is not None and MODE.name not in task.modes:
        modes = ", ".join(task.modes)
        raise _refused(source, "modes", modes, f"allowed to learn: {MODE.name}")
    for field in ("obstacles", "goals", "legs"):
        count = len(getattr(task, field))
        if count:
            raise _refused(source, field, f"{count} of them", "allowed to learn: none")
    if task.support.region is not None:
        raise _refused(source, "support.region", "an edge", "allowed to learn: null")
    if task.truth != EXACT:
        raise _refused(source, "truth", "given", "allowed to learn: its defaults")


def _refused(source: str, field: str, value: str, allowed: str) -> TaskError:
    return TaskError(source, field, Shown(value), allowed)


def _face_at(query: MotionQuery, foot: Point, normal: Point) -> FittedFace:
    """Pushed face of the true object.

    Raises TaskError if the face is round, or if the push tips the object.
    """
    fitted = min(
        fitted_faces(query.scene, query.motion),
        key=lambda one: (
            math.dist(one.face.normal, normal),
            math.dist(one.face.foot, foot),
        ),
    )
    if not fitted.face.flat:
        raise _refused(
            query.source, "object", "a round face", "allowed to learn: a straight one"
        )
    if not fitted.cars:
        raise _refused(query.source, "object", "its push", f"{fitted.refusal}")
    return fitted


def _figures(truth: Task, task: Task, fitted: FittedFace, steps: int) -> PushTask:
    """Ellipsoid with the axle and the wheelbase of the fitted car."""
    face = fitted.face
    car, shift = fitted.cars[min(fitted.cars)]
    ex, ey = car.axis
    x, y = truth.object.center_of_mass
    height = lone_contact_height(truth.scene, truth.motion)
    ahead = (shift * ex, shift * ey)
    return PushTask(
        task=task,
        face=face.index,
        contact=Contact(0, "side", face.foot, face.normal, height),
        foot=(face.foot[0] - ahead[0], face.foot[1] - ahead[1]),
        normal=face.normal,
        ends=(face.ends[0] - face.offset, face.ends[1] - face.offset),
        rho=math.sqrt(car.effective_wheelbase * (car.lever + shift)),
        center=(x + ahead[0], y + ahead[1]),
        steps=steps,
    )
