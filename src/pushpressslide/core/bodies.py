"""The bodies of a task that can be moved, and the task of moving one of them.

A task with ``goals`` is executed in stages. A stage moves one body to one pose. It is
an ordinary task: its object is that body, and its obstacles are all other bodies at
their current poses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from pushpressslide.core.motion import ON_THE_WAY
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT as OBJECT
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import ObjectModel, Obstacle, Shape, Task

SET_DOWN = "task-object"
"""Name of the task's object as an obstacle, while another body is moved.

The name 'object' then belongs to the moved body.
"""


@dataclass(frozen=True, slots=True)
class Stage:
    """One body's motion to a pose X_WG."""

    body: str
    goal: Pose2
    aside: bool = False  # moved out of another body's way, not to a goal of its own


def start_state(task: Task) -> WorldState:
    """State at the start of the task, with the object at its planned start."""
    others = {o.name: o.pose for o in task.obstacles if o.movable}
    return WorldState({OBJECT: task.start, **others})


def body_shape(task: Task, body: str) -> Shape:
    """Shape of a body of the task."""
    if body == OBJECT:
        return task.object.shape
    return _obstacle(task, body).shape


def obstacle_name(body: str, driven_body: str) -> str:
    """Name of a body during a stage in which ``driven_body`` is the object."""
    if body == driven_body:
        return OBJECT
    return SET_DOWN if body == OBJECT else body


def in_stage(state: WorldState, driven_body: str) -> WorldState:
    """State with the names that the bodies have in a stage in which ``driven_body`` is
    the object.
    """
    poses = {obstacle_name(body, driven_body): X for body, X in state.poses.items()}
    spatial = {obstacle_name(body, driven_body): q for body, q in state.spatial.items()}
    return replace(state, poses=poses, spatial=spatial)


def goal_places(task: Task) -> tuple[tuple[str, Shape, Pose2], ...]:
    """Every goal of a task: the body's name, its shape, and its goal pose X_WG."""
    if task.goals:
        wanted = dict.fromkeys((goal.body, goal.pose) for goal in task.goals)
        return tuple((body, body_shape(task, body), X) for body, X in wanted)
    own = (OBJECT, task.object.shape, task.goal)
    tool = task.tool
    if tool is None:
        return (own,)
    return own, (tool.body, body_shape(task, tool.body), tool.goal)


def stage_task(task: Task, stage: Stage, start: WorldState) -> Task:
    """Ordinary task of a stage that starts in the state ``start``.

    The body keeps the mass, the shape and the support friction that the task gives it.
    The face, contacts and height in ``motion`` apply only to the task's object.
    """
    obstacles = [_at_its_pose(o, start) for o in task.obstacles if o.name != stage.body]
    common = replace(task, start=start.poses[stage.body], goal=stage.goal, goals=())
    common = replace(common, source=f"{task.source or task.name}: {stage.body!r}")
    if stage.aside:
        loose = replace(ON_THE_WAY, bodies=task.tolerance.bodies)
        common = replace(common, tolerance=loose)
    if stage.body == OBJECT:
        return replace(common, obstacles=tuple(obstacles))
    moved = _obstacle(task, stage.body)
    shape = moved.shape
    set_down = _set_down(task, start.object)
    belief = replace(
        task.belief,
        support_friction=moved.believed_friction,
        mass=moved.believed_mass,
        center_of_mass=None,
        rho=None,
    )
    return replace(
        common,
        object=ObjectModel(shape, moved.mass, shape.centroid),
        support=replace(task.support, friction=moved.friction),
        obstacles=(*obstacles, set_down),
        belief=belief,
        start_error=Pose2(),
        motion=replace(task.motion.freed, contact_height=None, press_force=None),
    )


def _obstacle(task: Task, name: str) -> Obstacle:
    return next(o for o in task.obstacles if o.name == name)


def _at_its_pose(obstacle: Obstacle, state: WorldState) -> Obstacle:
    pose = state.poses.get(obstacle.name)
    return obstacle if pose is None else replace(obstacle, pose=pose)


def _set_down(task: Task, pose: Pose2) -> Obstacle:
    """The task's object as an obstacle at ``pose``, X_WG."""
    return Obstacle(
        SET_DOWN,
        task.object.shape,
        pose,
        movable=True,
        mass=task.object.mass,
        friction=task.support.friction,
        believed_mass=task.belief.mass,
        believed_friction=task.belief.support_friction,
    )
