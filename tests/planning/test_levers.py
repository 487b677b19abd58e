"""Push positions that turn an object about a held point."""

from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.pose import cross
from pushpressslide.core.scene import Scene
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Prism
from pushpressslide.planning.levers import levers

SCENE = load_task("parallel-push").scene

BOX = ObjectModel(Box((0.6, 0.8, 0.7)), 5.0, (0.05, -0.02))
CYLINDER = ObjectModel(Cylinder(0.2, 0.1), 1.0, (0.03, 0.0))
PRISM = ObjectModel(
    Prism(((0.0, 0.0), (0.3, 0.0), (0.1, 0.25)), 0.1), 1.0, (0.133, 0.083)
)
# objects, and the points [m] in B at which they are held
HELD = [(BOX, (-0.05, 0.04)), (CYLINDER, (-0.1, 0.06)), (PRISM, (-0.05, 0.04))]


def scene_of(body: ObjectModel) -> Scene:
    """A scene with that object."""
    return replace(SCENE, body=body)


@pytest.mark.parametrize(("body", "held"), HELD, ids=["box", "cylinder", "prism"])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_every_lever_turns_to_the_side_that_was_asked_the_longest_first(
    body, held, side: float
) -> None:
    found = levers(scene_of(body), held, side, 0.04)
    assert found
    for lever in found:
        turn = cross(
            (lever.point[0] - held[0], lever.point[1] - held[1]), lever.face.normal
        )
        assert side * turn == pytest.approx(lever.length)
        assert lever.length >= margins.LEVER_SHARE * found[0].length
        assert body.shape.depth(body.X_GB.apply(lever.point)) == pytest.approx(
            0.0, abs=2e-3
        )
    assert [lever.length for lever in found] == sorted(
        (lever.length for lever in found), reverse=True
    )


def test_a_face_can_be_asked_for() -> None:
    held = (-0.16, 0.225)
    assert {
        lever.face.index for lever in levers(scene_of(BOX), held, 1.0, 0.04, 3)
    } == {3}
    assert (
        len({lever.face.index for lever in levers(scene_of(BOX), held, 1.0, 0.04)}) > 1
    )


def test_a_point_held_at_the_middle_of_a_cylinder_leaves_no_lever() -> None:
    body = ObjectModel(Cylinder(0.2, 0.1), 1.0, (0.0, 0.0))
    assert levers(scene_of(body), (0.0, 0.0), 1.0, 0.04) == []


def test_depth_is_measured_to_the_nearest_edge() -> None:
    assert BOX.shape.depth(BOX.X_GB.apply((0.0, 0.0))) == pytest.approx(0.25)
    assert BOX.shape.depth(BOX.X_GB.apply((0.30, 0.0))) == pytest.approx(-0.05)
