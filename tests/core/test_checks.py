"""Public data accepts no impossible number: every numeric field of every dataclass
exported by the package, and of those they contain.
"""

import dataclasses
import math

import pytest

import pushpressslide as pps
from pushpressslide.core.checks import field_rules
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Belief, Opening, Scene
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import ToolUse
from pushpressslide.geometry.shapes import Part, Shape

BOX = pps.Box((0.2, 0.1, 0.05))
CORNERS = ((0.0, 0.0), (0.1, 0.0), (0.0, 0.1))
TASK = pps.load_task("rear-push-rear")

VALID = (
    BOX,
    pps.Cylinder(0.05, 0.1),
    pps.Prism(CORNERS, 0.1),
    pps.Prism((*CORNERS[:2], (0.02, 0.02), CORNERS[2]), 0.1),
    pps.Compound((Part(BOX, Pose2()),)),
    Part(BOX, Pose2(0.1, 0.2, 0.3)),
    pps.MeshSolid("a.stl", 1.0, CORNERS, 0.1, (0.03, 0.03)),
    pps.Object(BOX, 1.0, (0.01, 0.0)),
    pps.Obstacle("post", BOX, Pose2(0.5, 0.0, 0.0), True, 1.0, 0.3, 1.1, 0.4),
    pps.Robot("hand", (0.1, 0.2, 0.3), 0.4),
    pps.Support(region=CORNERS, angle=0.1),
    pps.Motion(face=1, contacts=((0.1, 0.0),), press_force=8.0, cop=0.5),
    pps.Limits(workspace=(-1.0, 1.0, -1.0, 1.0)),
    pps.Sensing(pose_delay=0.1, tip_delay=0.1, force_delay=0.1),
    pps.Tolerance(),
    pps.FlatFinger((0.0, 0.0), (0.1, 0.0), 0.3),
    TASK,
    TASK.scene,
    Belief(0.3, 0.4, 1.0, (0.0, 0.0), 0.05, 0.1, 0.01),
    Opening((0.2, 0.3), (0.1, 0.1), 0.05),
    SupportFrame(),
    ToolUse("ball", Pose2(), 1, 0.1),
)
HOT = {"Pose2"}
"""Built at every tick and every step of a search: a check would cost as much as they."""
# results, what a run is done with, and what a caller asks of it: no measures
RESULTS = {"Cell", "Choice", "Plan", "Record", "RunOptions"}


def spoilt(value, bad):
    """Each way to put a bad number into a value."""
    if isinstance(value, bool):
        return
    if isinstance(value, float | int):
        yield bad
    elif isinstance(value, Pose2):
        for name in ("x", "y", "yaw"):
            yield dataclasses.replace(value, **{name: bad})
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            for other in spoilt(part, bad):
                yield (*value[:i], other, *value[i + 1 :])


def changed(data, bad):
    """The name of each numeric field, with each of its numbers replaced."""
    for field in dataclasses.fields(data):
        for value in spoilt(getattr(data, field.name), bad):
            yield field.name, value


@pytest.mark.parametrize("data", VALID, ids=lambda data: type(data).__name__)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_no_number_of_public_data_is_not_finite(data, bad):
    for name, value in changed(data, bad):
        with pytest.raises(InputError, match=r"must be (one|finite)") as caught:
            dataclasses.replace(data, **{name: value})
        assert "\n" not in str(caught.value)


LENGTHS = {"size", "radius", "height", "scale"}
"""Fields of shapes, which the task file has in another form."""


@pytest.mark.parametrize("data", VALID, ids=lambda data: type(data).__name__)
def test_no_number_of_public_data_has_a_wrong_sign(data):
    rules = {name: allowed for name, _, allowed in field_rules(type(data))}
    for bad in (-0.1, 0.0):
        for name, value in changed(data, bad):
            length = name in LENGTHS and isinstance(data, Shape)
            positive = length or "> 0" in rules[name]
            if positive or (bad < 0.0 and ">= 0" in rules[name]):
                with pytest.raises(InputError, match="must be finite and >"):
                    dataclasses.replace(data, **{name: value})


def test_every_public_dataclass_is_among_these():
    kinds = {type(data).__name__ for data in VALID} | HOT | RESULTS
    for name in pps.__all__:
        public = getattr(pps, name)
        if isinstance(public, type) and dataclasses.is_dataclass(public):
            assert public.__name__ in kinds, name


def test_shapes_and_fingers_say_what_they_need():
    with pytest.raises(InputError, match=r"friction -0\.1; must be finite and >= 0"):
        pps.FlatFinger((0.0, 0.0), (0.1, 0.0), -0.1)
    with pytest.raises(InputError, match=r"size -0\.1 m; must be finite and > 0"):
        pps.Box((0.1, -0.1, 0.1))
    with pytest.raises(InputError, match="parts of a compound"):
        pps.Compound(())
    with pytest.raises(InputError, match="polygon of 2 points; must be 3 or more"):
        pps.Prism(CORNERS[:2], 0.1)
    with pytest.raises(InputError, match="three lengths"):
        pps.Box((0.1, 0.1))


def test_an_input_error_is_one_of_the_package_and_of_python():
    assert issubclass(InputError, pps.PushPressSlideError)
    assert issubclass(InputError, ValueError)


def test_a_scene_is_checked_like_a_task():
    with pytest.raises(InputError, match=r"Scene\.contact_friction nan"):
        dataclasses.replace(TASK.scene, contact_friction=math.nan)
    assert isinstance(TASK.scene, Scene)
