"""Mode selection: every mode and contact placement that the task's robots allow, judged
and ranked.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

from pushpressslide.core.footprint import carried, gap, overlap_area
from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Obstacle, Shape, Task
from pushpressslide.modes import MODES
from pushpressslide.modes.base import ENOUGH, Mode
from pushpressslide.selection.opening_path import opening_problem
from pushpressslide.selection.tool_use import tool_problem

OBJECT_CLEARANCE = 0.01
"""Gap [m] that the object keeps from obstacles, unless its start or its goal is nearer
already.
"""

# [m^2] shared with an obstacle from which on the object is in it, not beside it
ENTERED = 1e-5
SWEEP_STEP = 0.005  # [m] of the path between the places where the gap is looked at


def select(task: Task, enough: int = 1) -> list[Choice]:
    """Return all choices for ``task``, feasible ones first and the quickest first;
    never empty.

    A choice that cannot do the task says in ``reason`` why not, with the number that
    decides; or that it was not judged in full, as ``enough`` of its mode can that are
    no slower. Of a task with legs, the choices of one grasp after the other; ``leg``
    says which leg they begin with.
    """
    return [choice for grasp in grasps(task, enough) for choice in grasp]


def grasps(task: Task, enough: int = 1) -> list[list[Choice]]:
    """Return the choices for each grasp of ``task``, best first: a leg for which the
    arms can keep the contacts that they have is one more stretch of the leg before it.
    """
    parts = task.parts
    out = list[list[Choice]]()
    goes_on = any(
        set(a.modes or MODES) & set(b.modes or MODES) for a, b in pairwise(parts)
    )
    if goes_on:  # with contacts that need not be those of the first placement
        enough = max(enough, ENOUGH)
    for leg, part in enumerate(parts):
        found = [_of_leg(choice, leg) for choice in _select(part, enough)]
        lengthened = [_lengthened(choice, found) for choice in out[-1]] if out else []
        if any(choice.feasible for choice in lengthened):
            out[-1] = _ranked(lengthened)
        elif out and not carried(task, part.start):
            out.append([_falling(choice) for choice in found])
        else:
            out.append(found)
    return out


def _falling(choice: Choice) -> Choice:
    why = "but the object falls when the arms let go for it: nothing carries it where the leg before ends"
    return (
        replace(choice, feasible=False, reason=f"{choice.reason}; {why}")
        if choice.feasible
        else choice
    )


def _of_leg(choice: Choice, leg: int) -> Choice:
    following = None if choice.following is None else _of_leg(choice.following, leg)
    return replace(choice, leg=leg, following=following)


def _lengthened(choice: Choice, ahead: list[Choice]) -> Choice:
    """Return ``choice`` with the best of ``ahead`` that goes on with its contacts as
    its last stretches; infeasible where none does.
    """
    after = next(
        (
            c
            for c in ahead
            if c.mode == choice.mode and c.feasible and c.goes_on(choice)
        ),
        None,
    )
    if after is None or not choice.feasible:
        return replace(
            choice,
            feasible=False,
            reason=f"{choice.reason}; but no way on with its contacts",
        )
    path_length = _sum(choice.path_length, after.path_length)
    time = _sum(choice.time, after.time)
    return replace(_joined(choice, after), path_length=path_length, time=time)


def _joined(choice: Choice, after: Choice) -> Choice:
    return replace(
        choice,
        following=after
        if choice.following is None
        else _joined(choice.following, after),
    )


def _sum(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a + b


def _ranked(choices: list[Choice]) -> list[Choice]:
    """Return ``choices``, those of each mode in its own order, ranked: of equally quick
    modes that one first whose contacts push least against each other.
    """
    against: dict[str, float] = {}
    for choice in choices:
        against.setdefault(choice.mode, _against(choice))

    def rank(choice: Choice) -> tuple[bool, float, float]:
        time = math.inf if choice.time is None else round(choice.time, 3)
        return (not choice.feasible, time, against[choice.mode])

    return sorted(choices, key=rank)


def _against(choice: Choice) -> float:
    """Return which share of equal pushes of its contacts would be spent against each
    other.
    """
    normals = [contact.normal for contact in choice.contacts if contact.kind == "side"]
    return (
        round(1.0 - math.hypot(*map(sum, zip(*normals, strict=True))) / len(normals), 6)
        if normals
        else 0.0
    )


def _select(task: Task, enough: int) -> list[Choice]:
    """Return all choices for a task without legs, best first."""
    out: list[Choice] = []
    names = task.modes if task.modes is not None else tuple(MODES)
    for name in names:
        mode = MODES[name]
        if mode.arms != len(task.robots):
            out.append(
                Choice(
                    name,
                    False,
                    f"needs {mode.arms} arm(s), the task has {len(task.robots)}",
                )
            )
        elif task.support.kind == "wall" and not mode.walls:
            out.append(
                Choice(
                    name,
                    False,
                    "cannot hold an object on a wall; support.kind must be table",
                )
            )
        else:
            out.extend(_clear(task, mode, enough))
    return _ranked(out)


def _clear(task: Task, mode: Mode, enough: int) -> list[Choice]:
    """Return the choices of a mode; more of them judged where obstacles are in the way
    of the first.
    """
    judged = mode.choices(task, enough)
    choices = [_kept_clear(task, choice) for choice in judged]
    blocked = any(c.feasible for c in judged) and not any(c.feasible for c in choices)
    return _clear(task, mode, ENOUGH) if blocked and enough < ENOUGH else choices


def _kept_clear(task: Task, choice: Choice) -> Choice:
    """Return the choice, infeasible where the object's path comes too near to an
    obstacle, where it tips into an opening, or where as a tool it does not push
    straight.
    """
    anything = task.obstacles or task.support.opening or task.tool
    if not choice.feasible or choice.path is None or not anything:
        return choice
    poses = _swept(task, choice)
    problem = (
        obstacle_problem(task, poses)
        or opening_problem(task, choice, poses)
        or tool_problem(task, poses)
    )
    return (
        choice
        if problem is None
        else replace(choice, feasible=False, reason=f"{choice.reason}; {problem}")
    )


def obstacle_problem(task: Task, poses: list[Pose2]) -> str | None:
    """Return in one line where the object would come too near to an obstacle, or None;
    ``poses``: X_WG along a choice's path.

    A movable one counts where it stands at first, so that it is not pushed along. What
    the object is to push as a tool may be touched by it, and is itself kept clear of
    the others.
    """
    pushed = next(
        (
            o
            for o in task.obstacles
            if task.tool is not None and o.name == task.tool.body
        ),
        None,
    )
    others = [obstacle for obstacle in task.obstacles if obstacle is not pushed]
    ends = (task.start, task.goal)
    problem = _too_near("the object", task.object.shape, poses, ends, others)
    if problem is None and pushed is not None and task.tool is not None:
        ends = (pushed.pose, task.tool.goal)
        count = max(1, math.ceil(math.dist(*(X.position for X in ends)) / SWEEP_STEP))
        way = [_between(*ends, i / count) for i in range(count + 1)]
        problem = _too_near(f"{pushed.name!r}", Box(pushed.size), way, ends, others)
    return problem


def _swept(task: Task, choice: Choice) -> list[Pose2]:
    """Poses X_WG along the planned paths, SWEEP_STEP apart."""
    poses = []
    for stretch in choice.stretches:
        X_VG = (
            MODES[choice.mode]
            .vehicle_frame(stretch)
            .inverse()
            .compose(task.object.X_GB.inverse())
        )
        path = stretch.path
        assert path is not None
        count = max(1, math.ceil(path.length / SWEEP_STEP))
        poses += [
            path.pose(path.length * i / count).compose(X_VG) for i in range(count + 1)
        ]
    return poses


def _between(a: Pose2, b: Pose2, u: float) -> Pose2:
    turn = math.remainder(b.yaw - a.yaw, 0.5 * math.pi)  # whichever side is pushed
    return Pose2(a.x + u * (b.x - a.x), a.y + u * (b.y - a.y), a.yaw + u * turn)


def _too_near(
    what: str,
    shape: Shape,
    poses: list[Pose2],
    ends: tuple[Pose2, Pose2],
    obstacles: list[Obstacle],
) -> str | None:
    """Say where ``what`` comes nearer to an obstacle than it may; at its ``ends`` it
    may be where it is.
    """
    for obstacle in obstacles:
        box = Box(obstacle.size)

        def apart(X_WG: Pose2, box: Box = box, X_WO: Pose2 = obstacle.pose) -> float:
            return gap(shape, X_WG, box, X_WO)

        def inside(X_WG: Pose2, box: Box = box, X_WO: Pose2 = obstacle.pose) -> float:
            return overlap_area(shape, X_WG, box, X_WO)

        allowed = min(OBJECT_CLEARANCE, *(apart(X) for X in ends)) - 1e-6
        least, nearest = min(((apart(X), X) for X in poses), key=lambda found: found[0])
        if least == 0.0 and allowed <= 0.0:  # it touches at an end, and may on the way
            nearest = max(poses, key=inside)
            if inside(nearest) > ENTERED:
                return (
                    f"but {what} runs into obstacle {obstacle.name!r} at "
                    f"({nearest.x:.3f}, {nearest.y:.3f})"
                )
        if least < allowed:
            return (
                f"but {what} comes within {least * 1e3:.0f} mm of obstacle "
                f"{obstacle.name!r} "
                f"at ({nearest.x:.3f}, {nearest.y:.3f}), allowed from "
                f"{allowed * 1e3:.0f} mm"
            )
    return None
