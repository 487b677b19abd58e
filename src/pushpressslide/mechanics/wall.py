"""An object on a wall (docs/mechanics.md, section 7): its weight acts in the plane of
the wall, and does not press the object against it.

On a table all quantities of this module are zero.
"""

from __future__ import annotations

from math import hypot

from pushpressslide.core import margins
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath

# points of a path, besides its start, at which the weight's direction is checked
PLACES = 4


def weights(scene: Scene, path: TwistPath) -> list[Point]:
    """In-plane weights [N], in B, along a path of any body point."""
    weight = scene.weight_along
    if weight == (0.0, 0.0):
        return [weight]
    return [
        path.pose(i / PLACES * path.length).unrotate(weight) for i in range(PLACES + 1)
    ]


def lever(scene: Scene, load: float) -> float:
    """Displacement [m/N] of the centre of pressure per in-plane weight, against the
    direction of the weight.

    It is (h - h_com) / N, since the tips carry the weight at the object's top h while
    the weight acts at the height h_com of the CoM.
    """
    if not any(scene.weight_along):
        return 0.0
    return 0.5 * scene.body.shape.height / load


def lean_press(scene: Scene) -> float:
    """Press [N] of each of two arms at which the weight moves the centre of pressure by
    ``margins.LEAN``.
    """
    body = scene.body
    return (
        0.5
        * lever(scene, 1.0)
        * hypot(*scene.weight_along)
        / (margins.LEAN * body.shape.half_width)
    )


def lean(scene: Scene, goal: Pose2, press: float) -> Point:
    """Best offset [m] in B of two contacts of ``press`` [N] each.

    At the goal the weight shifts the centre of pressure back by the same distance.
    """
    x, y = goal.unrotate(scene.weight_along)
    k = lever(scene, scene.weight_on + 2.0 * press)
    return (k * x, k * y)
