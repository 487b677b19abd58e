"""The task file as data: every field with its type, unit, range, default and meaning.

The reader, the error messages and docs/task-file.md all come from this one table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pushpressslide.core.task import Motion
from pushpressslide.taskfile.field import REQUIRED, Field


def _number(
    help: str,
    unit: str,
    low: float,
    high: float,
    default: Any = REQUIRED,
    open: str = "",
) -> Field:
    return Field("number", help, unit, low, high, "(" in open, ")" in open, default)


def _section(help: str, fields: Mapping[str, Field], default: Any = REQUIRED) -> Field:
    return Field("section", help, fields=fields, default=default)


def _flag(help: str, default: bool) -> Field:
    return Field("boolean", help, default=default)


def _friction(help: str, default: Any) -> Field:
    return _number(help, "", 0, 2, default, "()")


def _size3(help: str) -> Field:
    return Field("numbers", help, "m", 0, 10, open_low=True, count=(3, 3))


def _pose(default: Any = REQUIRED) -> dict[str, Field]:
    return {
        "x": _number("along x of the support", "m", -10, 10, default),
        "y": _number("along y of the support", "m", -10, 10, default),
        "yaw_deg": _number("from x towards y", "deg", -360, 360, 0.0),
    }


_BASE = {
    "x": _number("position in the world", "m", -10, 10, 0.0),
    "y": _number("position in the world", "m", -10, 10, 0.0),
    "z": _number("height above the table or floor", "m", -10, 10, 0.0),
    "yaw_deg": _number("heading in the world", "deg", -360, 360, 0.0),
}

_OPENING = {
    "size": Field("numbers", "along x and y", "m", 0, 10, open_low=True, count=(2, 2)),
    "pose": _section(
        "its centre",
        {
            "x": _number("along x", "m", -10, 10, 0.0),
            "y": _number("along y", "m", -10, 10, 0.0),
        },
        {},
    ),
    "depth": _number("of its back behind the wall's face", "m", 0, 10, open="("),
}

_PRISM = {
    "polygon": Field(
        "points",
        "corners of the base in G: convex, in order, either sense",
        "m",
        -5,
        5,
        count=(3, 64),
    ),
    "height": _number("height", "m", 0, 10, open="("),
}

_CYLINDER = {
    "radius": _number("radius", "m", 0, 5, open="("),
    "height": _number("height", "m", 0, 10, open="("),
}

_SHAPE = {
    "box": Field(
        "numbers",
        "full lengths along x, y and z; G at the centre",
        "m",
        0,
        10,
        open_low=True,
        count=(3, 3),
        default=None,
    ),
    "prism": _section("upright prism; G is the polygon's own origin", _PRISM, None),
    "cylinder": _section("upright cylinder; G at the centre", _CYLINDER, None),
}

_OBJECT = {
    "shape": _section(
        "exactly one of box, prism, cylinder; it defines the frame G", _SHAPE
    ),
    "mass": _number("mass", "kg", 0, 1000, open="("),
    "center_of_mass": Field(
        "numbers",
        "in G, projected on the support, inside the footprint; null: the centroid",
        "m",
        -5,
        5,
        default=None,
        count=(2, 2),
    ),
}

_ROBOT = {
    "model": Field(
        "text",
        "panda, iiwa7, hand (a free force-controlled tip), or the path of a URDF or "
        "SDF file",
    ),
    "base": _section("where the base stands", _BASE, {}),
    "tip_frame": Field(
        "text",
        "frame at the tip's centre; needed for a model given by path",
        default=None,
    ),
    "tip_radius": _number("radius of the spherical tip", "m", 0.002, 0.1, 0.02),
    "tip_length": _number(
        "from the flange to the tip's centre, for the generated models",
        "m",
        0,
        0.5,
        0.15,
    ),
}

_OBSTACLE = {
    "name": Field("name", "unique; not 'object'"),
    "box": _size3("full lengths along x, y and z; it stands on the support"),
    "pose": _section("pose of its centre", _pose()),
    "movable": Field("boolean", "free to be pushed away, or fixed", default=False),
    "mass": _number("mass, if movable", "kg", 0, 1000, 1.0, "("),
    "friction": _friction("pair obstacle/support, if movable", 0.3),
}

_DEFAULT = Motion()

MOTION = {
    "speed": _number(
        "along the path of the tracking point", "m/s", 0, 0.2, _DEFAULT.speed, "("
    ),
    "acceleration": _number(
        "of the ramps of the speed", "m/s^2", 0, 2, _DEFAULT.acceleration, "("
    ),
    "tracking_gain": _number(
        "of the steering law, in units of the largest without overshoot",
        "",
        0,
        10,
        _DEFAULT.tracking_gain,
        "(",
    ),
    "servo_damping": _number(
        "of the contact velocity servo", "N s/m", 0, 1e4, _DEFAULT.servo_damping
    ),
    "joint_stiffness": _number(
        "of the joint-tracking term", "N m/rad", 0, 1000, _DEFAULT.joint_stiffness
    ),
    "force_gain": _number(
        "on the feed-forward force; null: 1 with the servo, 1.05 without",
        "",
        0,
        2,
        _DEFAULT.force_gain,
        "(",
    ),
    "contact_height": _number(
        "of a side contact above the support, below the object's top; null: chosen by "
        "the mode",
        "m",
        0,
        10,
        _DEFAULT.contact_height,
        "(",
    ),
    "approach_distance": _number(
        "free way before the touch", "m", 0.005, 0.5, _DEFAULT.approach_distance
    ),
    "joint_tracking": _flag(
        "joint impedance about the planned joint path", _DEFAULT.joint_tracking
    ),
    "velocity_servo": _flag(
        "velocity servo on top of the feed-forward force", _DEFAULT.velocity_servo
    ),
    "curvature_margin": _number(
        "share of the friction-limited curvature that is used",
        "",
        0,
        1,
        _DEFAULT.curvature_margin,
        "(",
    ),
    "run_in": _number("straight end of the path", "m", 0, 1, _DEFAULT.run_in),
    "control_period": _number(
        "of the controller", "s", 0.0005, 0.01, _DEFAULT.control_period
    ),
    "time_step": _number(
        "of the physics engine", "s", 0.0002, 0.01, _DEFAULT.time_step
    ),
    "face": Field(
        "integer",
        "index of the pushed edge of the footprint, edge i from corner i to i + 1 "
        "counter-clockwise (box: 0 is -y, 1 is +x, 2 is +y, 3 is -x); null: chosen",
        low=0,
        high=63,
        default=_DEFAULT.face,
    ),
    "contacts": Field(
        "points",
        "places of top contacts in G, on the object's top, of two the left arm's first "
        "unless "
        "the arms would cross; null: chosen",
        "m",
        -5,
        5,
        default=_DEFAULT.contacts,
        count=(1, 2),
    ),
    "press_force": _number(
        "normal force of a top contact; null: chosen by the mode",
        "N",
        0,
        1000,
        _DEFAULT.press_force,
        "(",
    ),
    "cop": Field(
        "number",
        "where two top contacts put the centre of pressure on a table: balanced "
        "(alike), as "
        "far left or right as a turn on the spot allows, or a part of the way from the "
        "left contact to the "
        "right one; null: balanced",
        low=0,
        high=1,
        default=_DEFAULT.cop,
        choices=("balanced", "left", "right"),
    ),
    "vehicle": Field(
        "text",
        "how a pressed object is driven: unicycle (pulled or pushed), car (pulled), "
        "forklift "
        "(pushed), "
        "pivot (turned about its virtual axle); null: unicycle",
        default=_DEFAULT.vehicle,
        choices=("unicycle", "car", "forklift", "pivot"),
    ),
    "look_ahead": _number(
        "of a pressed object's alignment with its path; null: chosen",
        "m",
        0,
        1,
        _DEFAULT.look_ahead,
        "(",
    ),
    "fixed_target": _flag(
        "align with a target fixed beyond the goal, as the paper has it, in place of "
        "one that slides "
        "along the "
        "path",
        _DEFAULT.fixed_target,
    ),
}

_LEG = {
    "mode": Field("name", "contact mode"),
    "pose": _section(
        "pose of G at its end; null for the last leg: the goal", _pose(), None
    ),
    "motion": _section("fields of `motion` that are otherwise in this leg", MOTION, {}),
}

SCHEMA = _section(
    "a task",
    {
        "name": Field("name", "name of the task; names the folder of a run"),
        "description": Field("text", "one line for `pps tasks`", default=""),
        "support": _section(
            "what the object slides on",
            {
                "kind": Field(
                    "text",
                    "kind of support",
                    default="table",
                    choices=("table", "wall"),
                ),
                "friction": _friction("pair object/support", 0.3),
                "pose": _section(
                    "of a wall, needed for one: its origin in the world, and where its "
                    "normal, which points "
                    "at the robots, heads",
                    _BASE,
                    None,
                ),
                "opening": _section(
                    "a rectangular opening in a wall, closed at its back",
                    _OPENING,
                    None,
                ),
            },
            {},
        ),
        "object": _section("what is to be moved", _OBJECT),
        "contact": _section(
            "at the tips", {"friction": _friction("pair end effector/object", 0.6)}, {}
        ),
        "start": _section(
            "pose of the shape's frame G that the plan is made for", _pose()
        ),
        "goal": _section(
            "wanted pose of the shape's frame G",
            {
                **_pose(),
                "body": Field(
                    "name", "the body to be moved: object, or an obstacle", default=None
                ),
            },
        ),
        "tool": _section(
            "the object is a tool that pushes the goal's body",
            {
                "face": Field(
                    "integer",
                    "index of the edge of the tool's footprint that pushes",
                    low=0,
                    high=63,
                    default=1,
                ),
            },
            {},
        ),
        "tolerance": _section(
            "when the goal counts as reached",
            {
                "position": _number("distance", "m", 0, 1, 0.01, "("),
                "yaw_deg": _number("angle", "deg", 0, 180, 2.0, "("),
            },
            {},
        ),
        "robots": Field(
            "sections",
            "the arms; of two, the first is the left one",
            fields=_ROBOT,
            count=(1, 2),
        ),
        "obstacles": Field(
            "sections",
            "boxes in the scene",
            fields=_OBSTACLE,
            default=[],
            count=(0, 32),
        ),
        "modes": Field(
            "names",
            "contact modes that may be used; null: every mode that the robots allow",
            default=None,
            count=(1, math.inf),
        ),
        "limits": _section(
            "bounds of the run",
            {
                "time": _number("simulated time", "s", 0, 3600, 60.0, "("),
                "normal_force": _number("at each contact", "N", 0, 1000, 40.0, "("),
                "workspace": _section(
                    "region that the origin of G stays in; null: no bound",
                    {
                        "x": Field(
                            "numbers",
                            "lower and upper bound",
                            "m",
                            -10,
                            10,
                            count=(2, 2),
                        ),
                        "y": Field(
                            "numbers",
                            "lower and upper bound",
                            "m",
                            -10,
                            10,
                            count=(2, 2),
                        ),
                    },
                    None,
                ),
            },
            {},
        ),
        "belief": _section(
            "what planner and controller are told, where it differs from the truth",
            {
                "support_friction": _friction("null: the truth", None),
                "contact_friction": _friction("null: the truth", None),
                "mass": _number("null: the truth", "kg", 0, 1000, None, "("),
                "rho": _number(
                    "length of the limit surface; null: from the shape",
                    "m",
                    0,
                    10,
                    None,
                    "(",
                ),
            },
            {},
        ),
        "start_error": _section(
            "how far off `start` the object truly starts, in world axes",
            {
                "x": _number("along x", "m", -1, 1, 0.0),
                "y": _number("along y", "m", -1, 1, 0.0),
                "yaw_deg": _number("counter-clockwise", "deg", -180, 180, 0.0),
            },
            {},
        ),
        "sensing": _section(
            "imperfections of what the controller is given",
            {
                "position_noise": _number("standard deviation", "m", 0, 0.1, 0.0),
                "yaw_noise_deg": _number("standard deviation", "deg", 0, 45, 0.0),
                "force_noise": _number("standard deviation", "N", 0, 100, 0.0),
                "delay": _number("of every measurement", "s", 0, 1, 0.0),
            },
            {},
        ),
        "motion": _section("how the motion is to be done", MOTION, {}),
        "legs": Field(
            "sections",
            "parts of the task in order, in place of `modes`: arms that have other "
            "contacts in "
            "the next one let go and take them, all others hold on; null: one mode "
            "does it all",
            fields=_LEG,
            default=None,
            count=(1, 20),
        ),
    },
)
"""The whole file."""
