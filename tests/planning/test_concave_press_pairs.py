"""Positions at which two arms press a concave top."""

import math
from dataclasses import replace

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import ObjectModel, Task
from pushpressslide.geometry.shapes import Prism
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.planning.press_pairs import placed_pairs
from pushpressslide.taskfile.load import load_task

L_SHAPE = Prism(
    ((0.0, 0.0), (0.25, 0.0), (0.25, 0.06), (0.06, 0.06), (0.06, 0.25), (0.0, 0.25)),
    0.06,
)


def l_task() -> Task:
    task = load_task("bimanual-slide")
    body = ObjectModel(L_SHAPE, 1.0, L_SHAPE.centroid)
    motion = replace(task.motion, contacts=None)
    return replace(task, object=body, motion=motion, goal=Pose2(0.55, 0.1, 0.3))


def test_where_nothing_is_opposite_a_place_the_nearest_one_there_is_pressed() -> None:
    task = l_task()
    inset = task.scene.inset
    places = top_places(task.object, inset)
    opposite = [p for p in places if inside_top(task.object, (-p[0], -p[1]), inset)]
    assert len(opposite) < 0.2 * len(places)
    pairs = [pair for pair in placed_pairs(task.query) if pair.refusal is None]
    assert len(pairs) > len(opposite)
    for pair in pairs:
        points = [contact.point for contact in pair.contacts]
        assert all(inside_top(task.object, p, inset - 1e-5) for p in points)
    # one of them has an arm of the L for each arm
    assert max(math.dist(*(c.point for c in pair.contacts)) for pair in pairs) > 0.2
