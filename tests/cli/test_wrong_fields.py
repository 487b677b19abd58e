"""Every task file that is wrong in one way is refused: exit status 2, one line on
stderr, no traceback.
"""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from pushpressslide.taskfile.load import load_task

Refusal = Callable[..., str]

GOOD: dict[str, Any] = {
    "name": "cube",
    "support": {"friction": 0.3},
    "object": {"shape": {"box": [0.15, 0.15, 0.15]}, "mass": 1.0},
    "contact": {"friction": 0.6},
    "start": {"x": 0.38, "y": 0.22},
    "goal": {"x": 0.66, "y": -0.2, "yaw_deg": -20},
    "robots": [{"model": "panda"}],
    "modes": ["rear_push"],
}


def put(path: str, value: object) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        *way, last = path.split(".")
        for key in way:
            data = data.setdefault(key, {})
        data[last] = value

    return change


def one_arm_for_two(data: dict[str, Any]) -> None:
    """Ask one arm of two to push side by side."""
    data["robots"] = [PANDA, {"model": "panda", "base": {"x": 1.2}}]
    data["modes"] = ["parallel_push"]
    data["motion"] = {"arm": "left"}


def drop(key: str) -> Callable[[dict[str, Any]], None]:
    return lambda data: data.pop(key)


def put_legs(*legs: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        del data["modes"]
        data["legs"] = list(legs)

    return change


def prism(polygon: list[Any]) -> Callable[[dict[str, Any]], None]:
    return put("object.shape", {"prism": {"polygon": polygon, "height": 0.1}})


def notched(path: str, value: object) -> Callable[[dict[str, Any]], None]:
    """Put a value, and an object with a notch narrower than the tip."""

    def change(data: dict[str, Any]) -> None:
        put("object.shape", {"prism": {"polygon": NOTCHED, "height": 0.06}})(data)
        put(path, value)(data)

    return change


def post(x: float, y: float, name: str = "post") -> dict[str, Any]:
    return {"name": name, "box": [0.1, 0.1, 0.2], "pose": {"x": x, "y": y}}


PANDA = {"model": "panda"}
PLACE = {"name": "can", "pose": {"x": 0.66, "y": -0.2}}
ROD = {"cylinder": {"radius": 0.03, "height": 0.1}}
BOW = [[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]]
NOTCHED = [
    [-0.08, -0.06],
    [0.08, -0.06],
    [0.08, 0.06],
    [0.01, 0.06],
    [0.01, -0.01],
    [-0.01, -0.01],
    [-0.01, 0.06],
    [-0.08, 0.06],
]
HALF = {"mode": "press_slide", "pose": {"x": 0.5, "y": 0.1}}

# What is wrong: the change, the field that the message names, and a part of what it
# says is allowed.
WRONG: dict[str, tuple[Callable[[dict[str, Any]], object], str, str]] = {
    "unknown key": (put("objct", 1), "objct:", "did you mean 'object'?"),
    "unknown nested key": (put("object.mas", 1), "object.mas:", "did you mean 'mass'?"),
    "key that is a number": (lambda d: d.update({7: 1}), "7:", "known: name"),
    "no name": (drop("name"), "name:", "missing"),
    "name that is a path": (put("name", "../x"), "name:", "a letter, then"),
    "name that is a number": (put("name", 7), "name:", "a name"),
    "no object": (drop("object"), "object:", "missing"),
    "no goal": (drop("goal"), "goal:", "missing"),
    "NaN": (put("goal.x", float("nan")), "goal.x:", "finite number [m]"),
    "infinity": (
        put("object.mass", float("inf")),
        "object.mass:",
        "finite number [kg]",
    ),
    "number too long for a float": (
        put("object.mass", 10**400),
        "object.mass:",
        "(0, 1000]",
    ),
    "text for a number": (put("object.mass", "1.0"), "object.mass:", "finite number"),
    "bool for a number": (
        put("support.friction", True),
        "support.friction:",
        "finite number",
    ),
    "number for a bool": (
        put("obstacles", [{**post(0.5, 0.5), "movable": 1}]),
        "obstacles[0].movable:",
        "true or false",
    ),
    "null for a number": (put("start.x", None), "start.x:", "finite number"),
    "number for a section": (
        put("start", 3),
        "start:",
        "a section with the fields x, y",
    ),
    "list for a section": (put("goal", [0.6, 0.1, 0]), "goal:", "a section"),
    "section for a list": (
        put("robots", {"model": "panda"}),
        "robots:",
        "a list of 1 to 2",
    ),
    "a side that there is not": (
        put("motion.cop", "middle"),
        "motion.cop:",
        "balanced, left, right",
    ),
    "a cop beyond the contacts": (put("motion.cop", 1.2), "motion.cop:", "[0, 1]"),
    "unknown vehicle": (put("motion.vehicle", "tank"), "motion.vehicle:", "unicycle"),
    "vehicle that the mode has not": (
        put("motion.vehicle", "mixed"),
        "motion.vehicle:",
        "allowed with rear_push: null",
    ),
    "vehicle that a leg's mode has not": (
        put_legs(
            HALF,
            {"mode": "rear_push", "motion": {"vehicle": "car"}},
        ),
        "motion.vehicle:",
        "allowed with rear_push: null",
    ),
    "half a face": (put("motion.face", 1.5), "motion.face:", "whole number"),
    "face that the box lacks": (put("motion.face", 4), "motion.face:", "0 to 3"),
    "negative size": (
        put("object.shape.box", [0.1, -0.1, 0.1]),
        "object.shape.box[1]:",
        "(0, 10]",
    ),
    "two sizes": (
        put("object.shape.box", [0.1, 0.1]),
        "object.shape.box:",
        "list of 3",
    ),
    "no shape": (
        put("object.shape", {}),
        "object.shape:",
        "exactly one of box, prism, cylinder",
    ),
    "two shapes": (
        put("object.shape.cylinder", {"radius": 0.1, "height": 0.1}),
        "object.shape:",
        "exactly one of",
    ),
    "radius zero": (
        put("object.shape", {"cylinder": {"radius": 0, "height": 1}}),
        "radius:",
        "(0, 5]",
    ),
    "mass zero": (put("object.mass", 0), "object.mass:", "(0, 1000]"),
    "mass negative": (put("object.mass", -1), "object.mass:", "(0, 1000]"),
    "centre of mass outside": (
        put("object.center_of_mass", [0.2, 0]),
        "center_of_mass:",
        "inside the base",
    ),
    "support friction zero": (
        put("support.friction", 0),
        "support.friction:",
        "in (0, 2)",
    ),
    "contact friction too large": (
        put("contact.friction", 2.5),
        "contact.friction:",
        "in (0, 2)",
    ),
    "contact friction two": (
        put("contact.friction", 2),
        "contact.friction:",
        "in (0, 2)",
    ),
    "believed friction zero": (
        put("belief.support_friction", 0),
        "belief.support_friction:",
        "in (0, 2)",
    ),
    "support of another kind": (
        put("support.kind", "floor"),
        "support.kind:",
        "table, wall",
    ),
    "wall without a pose": (
        put("support.kind", "wall"),
        "support.pose:",
        "it is missing",
    ),
    "opening in a table": (
        put("support.opening", {"size": [0.1, 0.1], "depth": 0.1}),
        "support.opening:",
        "only a wall",
    ),
    "pose of a table": (put("support.pose", {"x": 1}), "support.pose:", "only a wall"),
    "legs beside modes": (
        put("legs", [{"mode": "press_slide"}]),
        "modes:",
        "one of the two",
    ),
    "a leg to nowhere": (
        put_legs({"mode": "rear_push"}, {"mode": "rear_push"}),
        "legs[0].pose:",
        "missing",
    ),
    "a last leg past the goal": (
        put_legs({"mode": "rear_push", "pose": {"x": 0.5, "y": 0.0}}),
        "legs[0].pose:",
        "ends at the goal",
    ),
    "a leg in an unknown mode": (
        put_legs({"mode": "rear_shove"}),
        "modes[0]:",
        "rear_push",
    ),
    "a leg at another pace": (
        put_legs({"mode": "rear_push", "motion": {"time_step": 0.001}}),
        "legs[0].motion.time_step:",
        "0.004",
    ),
    "a leg out of reach": (
        put_legs(
            {"mode": "rear_push", "pose": {"x": 5.0, "y": 0.0}}, {"mode": "rear_push"}
        ),
        "legs[0]:",
        "reach",
    ),
    "goal of another body": (
        put("goal.body", "post"),
        "goal.body:",
        "allowed: a movable body",
    ),
    "goal on a cylinder": (
        put("obstacles", [{**PLACE, **ROD}]),
        "goal:",
        "no overlap with obstacle 'can'",
    ),
    "obstacle without a shape": (
        put("obstacles", [PLACE]),
        "obstacles[0]:",
        "exactly one of box, prism, cylinder",
    ),
    "obstacle of two shapes": (
        put("obstacles", [{**post(0.5, 0.5), **ROD}]),
        "obstacles[0]:",
        "exactly one of box, prism, cylinder",
    ),
    "obstacle on a polygon that crosses itself": (
        put("obstacles", [{**PLACE, "prism": {"polygon": BOW, "height": 0.1}}]),
        "obstacles[0].prism.polygon:",
        "crosses itself",
    ),
    "obstacle of a mesh that is not there": (
        put("obstacles", [{**PLACE, "mesh": "none.obj"}]),
        "obstacles[0].mesh.path:",
        "no such file",
    ),
    "fixed obstacle that may move": (
        put("obstacles", [{**post(0.5, 0.5), "may_move": True}]),
        "obstacles[0].may_move:",
        "movable: true",
    ),
    "region that crosses itself": (
        put("support.region", BOW),
        "support.region:",
        "crosses itself",
    ),
    "region of two corners": (
        put("support.region", [[0, 0], [1, 0]]),
        "support.region:",
        "3 to 64 points",
    ),
    "region that excludes the start": (
        put("support.region", [[0.5, -1], [1, -1], [1, 1], [0.5, 1]]),
        "start:",
        "over the part of the base on support.region",
    ),
    "region that excludes the goal": (
        put("support.region", [[0, -0.1], [1, -0.1], [1, 1], [0, 1]]),
        "goal:",
        "inside the edge of support.region",
    ),
    "face in a notch narrower than the tip": (
        notched("motion.face", 4),
        "motion.face:",
        "cannot reach it, or it is too narrow; allowed: null, 0, 1, 2, 6, 7",
    ),
    "contact in a notch": (
        notched("motion.contacts", [[0.0, 0.03]]),
        "motion.contacts[0]:",
        "on the object's top, 12 mm or more inside its edge",
    ),
    "contact beside the object": (
        put("motion.contacts", [[0.0, 0.0], [0.1, 0.0]]),
        "motion.contacts[1]:",
        "on the object's top",
    ),
    "polygon that crosses itself": (
        prism([[0, 1], [0.59, -0.81], [-0.95, 0.31], [0.95, 0.31], [-0.59, -0.81]]),
        "polygon:",
        "crosses itself",
    ),
    "polygon of two corners": (prism([[0, 0], [1, 0]]), "polygon:", "3 to 64"),
    "polygon on a line": (prism([[0, 0], [1, 0], [2, 0]]), "polygon:", "one line"),
    "polygon with a corner twice": (
        prism([[0, 0], [0, 0], [1, 0], [0, 1]]),
        "polygon:",
        "the same",
    ),
    "point of three numbers": (
        prism([[0, 0, 0], [1, 0], [0, 1]]),
        "polygon[0]:",
        "a point [x, y]",
    ),
    "no robot": (put("robots", []), "robots:", "1 to 2"),
    "three robots": (put("robots", [PANDA] * 3), "robots:", "1 to 2"),
    "one robot for two": (
        put("modes", ["parallel_push"]),
        "robots:",
        "2 robots, the number that mode parallel_push uses",
    ),
    "an arm that is not there": (
        put("motion.arm", "right"),
        "motion.arm:",
        "the task has 1 robot; allowed: null, left",
    ),
    "one arm for two": (
        one_arm_for_two,
        "motion.arm:",
        "mode parallel_push uses both arms; allowed: null",
    ),
    "unknown robot": (
        put("robots", [{"model": "pnda"}]),
        "robots[0].model:",
        "did you mean 'panda'?",
    ),
    "missing robot file": (
        put("robots", [{"model": "arm.urdf"}]),
        "robots[0].model:",
        "no such file",
    ),
    "tip of negative radius": (
        put("robots", [{"model": "panda", "tip_radius": -0.01}]),
        "robots[0].tip_radius:",
        "[0.002, 0.1]",
    ),
    "goal out of reach": (put("goal.x", 1.5), "goal:", "the tip of the panda stays 0."),
    "goal on another planet": (put("goal.x", 1e9), "goal.x:", "[-10, 10]"),
    "start out of reach": (
        put("start.y", -1.5),
        "start:",
        "the tip of the panda stays 0.",
    ),
    "start on the base": (put("start", {"x": 0.05, "y": 0}), "start:", "0.1 m or more"),
    "goal on the base": (put("goal", {"x": 0.0, "y": 0.1}), "goal:", "0.1 m or more"),
    "obstacle on the start": (
        put("obstacles", [post(0.4, 0.25)]),
        "start:",
        "no overlap with",
    ),
    "obstacle on the goal": (
        put("obstacles", [post(0.7, -0.2)]),
        "goal:",
        "no overlap with obstacle 'post'",
    ),
    "obstacle on the base": (
        put("obstacles", [post(0.0, 0.05)]),
        "obstacles[0].pose:",
        "0.1 m or more",
    ),
    "obstacles on each other": (
        put("obstacles", [post(0.5, 0.5), post(0.55, 0.5, "pole")]),
        "obstacles[1].pose:",
        "'post'",
    ),
    "two obstacles of one name": (
        put("obstacles", [post(0.5, 0.5), post(0.5, -0.5)]),
        "obstacles[1].name:",
        "a name of its own",
    ),
    "reserved name": (
        put("obstacles", [post(0.5, 0.5, "object")]),
        "obstacles[0].name:",
        "of its own",
    ),
    "true start on an obstacle": (
        lambda d: d.update(obstacles=[post(0.38, 0.4)], start_error={"y": 0.1}),
        "start_error:",
        "'post'",
    ),
    "unknown mode": (
        put("modes", ["rear_psh"]),
        "modes[0]:",
        "did you mean 'rear_push'?",
    ),
    "mode twice": (put("modes", ["rear_push"] * 2), "modes[1]:", "twice"),
    "no mode": (put("modes", []), "modes:", "1 or more"),
    "mode that is a number": (put("modes", [1]), "modes[0]:", "a name"),
    "tolerance zero": (put("tolerance.position", 0), "tolerance.position:", "(0, 1]"),
    "force limit zero": (
        put("limits.normal_force", 0),
        "limits.normal_force:",
        "(0, 1000]",
    ),
    "time limit negative": (put("limits.time", -1), "limits.time:", "(0, 3600]"),
    "workspace the wrong way round": (
        put("limits.workspace", {"x": [1, 0], "y": [-1, 1]}),
        "limits.workspace.x:",
        "lower < upper",
    ),
    "goal at the start by belief alone": (
        lambda task: task.update(
            goal={"x": 0.382, "y": 0.22, "yaw_deg": 1}, start_error={"x": 0.05}
        ),
        "goal: 2.0 mm and 1.00 deg",
        "there already",
    ),
    "goal off the workspace": (
        put("limits.workspace", {"x": [0, 0.5], "y": [-1, 1]}),
        "goal:",
        "limits.workspace",
    ),
    "negative noise": (
        put("sensing.force_noise", -1),
        "sensing.force_noise:",
        "[0, 100]",
    ),
    "too fast": (put("motion.speed", 0.3), "motion.speed:", "(0, 0.2]"),
    "contact above the object": (
        put("motion.contact_height", 0.2),
        "motion.contact_height:",
        "0.15 m",
    ),
}


@pytest.mark.parametrize("case", WRONG, ids=lambda case: case.replace(" ", "-"))
def test_it_is_refused_with_file_field_and_what_is_allowed(
    case: str, tmp_path: Path, refusal: Refusal
) -> None:
    change, field, allowed = WRONG[case]
    data = copy.deepcopy(GOOD)
    change(data)
    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump(data))
    line = refusal(
        "run", str(file), "--engine", "planar", "--out", str(tmp_path / "out")
    )
    assert line.startswith(f"pps: {file}: ")
    assert field in line
    assert allowed in line
    assert not (tmp_path / "out").exists()


def test_the_file_that_the_wrong_ones_are_made_from_is_right(tmp_path: Path) -> None:
    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump(GOOD))
    assert load_task(file).name == "cube"
