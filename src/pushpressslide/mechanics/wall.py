"""An object on a wall: its weight acts in the plane and presses nothing
(docs/mechanics.md, section 7).

On a table all of this is nothing.
"""

from __future__ import annotations

from math import hypot

from pushpressslide.core.pose import Point
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath

PLACES = 4  # of a path, and its start, at which the weight's direction is looked at
LEAN = 0.15  # half widths by which the weight may move the centre of pressure


def weights(task: Task, path: TwistPath) -> list[Point]:
    """Return what of the weight acts in the plane [N], in B, along a path of any body
    point.
    """
    weight = task.weight_in_plane
    if weight == (0.0, 0.0):
        return [weight]
    return [
        path.pose(i / PLACES * path.length).unrotate(weight) for i in range(PLACES + 1)
    ]


def lever(task: Task, load: float) -> float:
    """Return how far a weight in the plane moves the centre of pressure, against itself
    [m/N].

    Tips that carry it at the top, and the weight at the height of the CoM: (h - h_com)
    / N.
    """
    return 0.5 * task.object.shape.height / load if any(task.weight_in_plane) else 0.0


def lean_press(task: Task) -> float:
    """Return the press [N] of each of two arms at which the weight moves the centre of
    pressure by LEAN.
    """
    body = task.object
    return (
        0.5
        * lever(task, 1.0)
        * hypot(*task.weight_in_plane)
        / (LEAN * body.shape.half_width)
    )


def lean(task: Task, press: float) -> Point:
    """Return how far two contacts of ``press`` [N] each are best moved, in B [m]: at
    the goal the weight moves the centre of pressure back by as much.
    """
    x, y = task.goal.unrotate(task.weight_in_plane)
    k = lever(task, task.weight_on_support + 2.0 * press)
    return (k * x, k * y)
