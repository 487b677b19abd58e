"""Disturbances: another body, or a force, moves the object while the arms do."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from pushpressslide.core.checks import check_fields
from pushpressslide.core.field_spec import documented, field_spec, setting
from pushpressslide.core.pose import Point

Side = Literal["left", "right"]


@documented
@dataclass(frozen=True, slots=True)
class Ball:
    """A push by another body: a ball that a force drives against the object."""

    side: Side = setting("left", "side to which the object turns")
    moved: float = setting(0.03, "displacement of the object", "m", "(0, 1]")
    turned: float = setting(
        math.radians(15.0),
        "turn of the object, after which half of `moved` is enough",
        "deg",
        "(0, 180]",
    )

    def __post_init__(self) -> None:
        check_fields(self)


@documented
@dataclass(frozen=True, slots=True)
class Push:
    """A constant force and moment on the object, for a time."""

    force: Point = field(
        metadata=field_spec(
            "x and y of the force at the centre of mass, world axes (on a wall: the wall's)",
            "N",
            "[-1000, 1000]",
        )
    )
    duration: float = field(metadata=field_spec("how long it acts", "s", "(0, 60]"))
    moment: float = setting(
        0.0, "moment about the support's normal", "N m", "[-1000, 1000]"
    )

    def __post_init__(self) -> None:
        check_fields(self)


@documented
@dataclass(frozen=True, slots=True)
class Knock:
    """One disturbance: its beginning by `time` or `share`, and its cause, `ball` or
    `push`.
    """

    time: float | None = setting(
        None, "when it begins, from the start of the run", "s", "[0, 3600]"
    )
    share: float | None = setting(
        None,
        "share of the direct path, turns included, after which it begins",
        within="[0, 1]",
    )
    ball: Ball | None = setting(None, "a push by another body, on drake and mujoco")
    push: Push | None = setting(None, "a push by a force")

    def __post_init__(self) -> None:
        check_fields(self)
