"""Presses on the floor of a hollow body, which need a long enough rod."""

from __future__ import annotations

from pushpressslide.core import margins
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene


def hollow_refusal(scene: Scene) -> Refusal | None:
    """Refusal of presses on the floor of a hollow, or None.

    They are refused if the shortest rod does not reach the floor with the hand above
    the body.
    """
    shape = scene.body.shape
    deep = shape.height - shape.top_height
    rod = min(robot.tip_length for robot in scene.tips) - margins.ARM.wrist_gap
    if deep <= max(rod, 0.0):
        return None
    text = "the place to press is {figure:mm.0f} down inside it, the rod allows {allowed:mm.0f}"
    return Refusal("hollow", text, deep, rod, "m")
