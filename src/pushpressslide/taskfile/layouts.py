"""Sections of the task file whose layout differs from that of the data."""

from __future__ import annotations

from types import NoneType
from typing import NamedTuple

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import BodyGoal
from pushpressslide.taskfile.kinds import (
    NAME,
    Field,
    array,
    nullable,
    number,
    section,
)


class Stand(NamedTuple):
    """Position and heading of an element of the task in the world."""

    x: float  # [m]
    y: float
    z: float
    yaw: float  # [rad]


_METRES = number("m", "[-10, 10]")
_BOUNDS = array(_METRES, 2, 2)
_HEADING = number("deg", "[-360, 360]")
_ERROR = number("m", "[-1, 1]")

_POSE = {
    "x": Field(_METRES, "along x of the support"),
    "y": Field(_METRES, "along y of the support"),
    "yaw_deg": Field(_HEADING, "from x towards y", 0.0),
}
_BODY = Field(nullable(NAME), "the body to be moved: object, or an obstacle")

_X_Y_YAW = ("x", "y", "yaw")

POSE = section(_POSE, Pose2, order=_X_Y_YAW)
GOAL = section(
    {**_POSE, "body": _BODY},
    lambda body, **pose: Pose2(**pose),
    data=Pose2,
    order=_X_Y_YAW,
)
BODY_GOAL = section(
    {
        "body": Field(NAME, "the body: object, or an obstacle that is movable"),
        **_POSE,
    },
    lambda body, **pose: BodyGoal(body, Pose2(**pose)),
    lambda goal: {"body": goal.body, **POSE.encode(goal.pose)},
    BodyGoal,
)
START_ERROR = section(
    {
        "x": Field(_ERROR, "along x", 0.0),
        "y": Field(_ERROR, "along y", 0.0),
        "yaw_deg": Field(number("deg", "[-180, 180]"), "counter-clockwise", 0.0),
    },
    Pose2,
    order=_X_Y_YAW,
)
STAND = section(
    {
        "x": Field(_METRES, "position in the world", 0.0),
        "y": Field(_METRES, "position in the world", 0.0),
        "z": Field(_METRES, "height above the table or floor", 0.0),
        "yaw_deg": Field(_HEADING, "heading in the world", 0.0),
    },
    Stand,
    Stand._asdict,
    order=("x", "y", "z", "yaw"),
)
CENTER = section(
    {
        "x": Field(_METRES, "along x", 0.0),
        "y": Field(_METRES, "along y", 0.0),
    },
    lambda x, y: (x, y),
    data=NoneType,
    order=("x", "y"),
)
WORKSPACE = section(
    {
        "x": Field(_BOUNDS, "lower and upper bound"),
        "y": Field(_BOUNDS, "lower and upper bound"),
    },
    lambda x, y: (*x, *y),
    lambda region: {"x": region[:2], "y": region[2:]},
    tuple,
)
