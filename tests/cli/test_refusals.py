"""Every wrong task file and option is refused: exit status 2, one line on stderr, no traceback."""

import copy
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

from pushpressslide.cli import app

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


def drop(key: str) -> Callable[[dict[str, Any]], None]:
    return lambda data: data.pop(key)


def prism(polygon: list[Any]) -> Callable[[dict[str, Any]], None]:
    return put("object.shape", {"prism": {"polygon": polygon, "height": 0.1}})


def post(x: float, y: float, name: str = "post") -> dict[str, Any]:
    return {"name": name, "box": [0.1, 0.1, 0.2], "pose": {"x": x, "y": y}}


PANDA = {"model": "panda"}

# What is wrong: the change, the field that the message names, and a part of what it says is allowed.
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
    "infinity": (put("object.mass", float("inf")), "object.mass:", "finite number [kg]"),
    "number too long for a float": (put("object.mass", 10**400), "object.mass:", "(0, 1000]"),
    "text for a number": (put("object.mass", "1.0"), "object.mass:", "finite number"),
    "bool for a number": (put("support.friction", True), "support.friction:", "finite number"),
    "number for a bool": (put("motion.joint_tracking", 1), "motion.joint_tracking:", "true or false"),
    "null for a number": (put("start.x", None), "start.x:", "finite number"),
    "number for a section": (put("start", 3), "start:", "a section with the fields x, y"),
    "list for a section": (put("goal", [0.6, 0.1, 0]), "goal:", "a section"),
    "section for a list": (put("robots", {"model": "panda"}), "robots:", "a list of 1 to 2"),
    "half a face": (put("motion.face", 1.5), "motion.face:", "whole number"),
    "face that the box lacks": (put("motion.face", 4), "motion.face:", "0 to 3"),
    "negative size": (put("object.shape.box", [0.1, -0.1, 0.1]), "object.shape.box[1]:", "(0, 10]"),
    "two sizes": (put("object.shape.box", [0.1, 0.1]), "object.shape.box:", "list of 3"),
    "no shape": (put("object.shape", {}), "object.shape:", "exactly one of box, prism, cylinder"),
    "two shapes": (
        put("object.shape.cylinder", {"radius": 0.1, "height": 0.1}),
        "object.shape:",
        "exactly one of",
    ),
    "radius zero": (put("object.shape", {"cylinder": {"radius": 0, "height": 1}}), "cylinder.radius:", "(0, 5]"),
    "mass zero": (put("object.mass", 0), "object.mass:", "(0, 1000]"),
    "mass negative": (put("object.mass", -1), "object.mass:", "(0, 1000]"),
    "centre of mass outside": (put("object.center_of_mass", [0.2, 0]), "center_of_mass:", "inside the footprint"),
    "support friction zero": (put("support.friction", 0), "support.friction:", "in (0, 2)"),
    "contact friction too large": (put("contact.friction", 2.5), "contact.friction:", "in (0, 2)"),
    "contact friction two": (put("contact.friction", 2), "contact.friction:", "in (0, 2)"),
    "believed friction zero": (put("belief.support_friction", 0), "belief.support_friction:", "in (0, 2)"),
    "support of another kind": (put("support.kind", "floor"), "support.kind:", "table, wall"),
    "wall": (put("support.kind", "wall"), "support.kind:", "not supported yet"),
    "pose of a table": (put("support.pose", {"x": 1}), "support.pose:", "only a wall"),
    "legs": (put("legs", [{"mode": "rear_push", "pose": {"x": 0, "y": 0}}]), "legs:", "not supported yet"),
    "goal of another body": (put("goal.body", "post"), "goal.body:", "not supported yet"),
    "concave polygon": (prism([[0, 0], [1, 0], [0.2, 0.2], [0, 1]]), "polygon:", "convex"),
    "polygon that crosses itself": (
        prism([[0, 1], [0.59, -0.81], [-0.95, 0.31], [0.95, 0.31], [-0.59, -0.81]]),
        "polygon:",
        "crosses itself",
    ),
    "polygon of two corners": (prism([[0, 0], [1, 0]]), "polygon:", "3 to 64"),
    "polygon on a line": (prism([[0, 0], [1, 0], [2, 0]]), "polygon:", "one line"),
    "polygon with a corner twice": (prism([[0, 0], [0, 0], [1, 0], [0, 1]]), "polygon:", "the same"),
    "point of three numbers": (prism([[0, 0, 0], [1, 0], [0, 1]]), "polygon[0]:", "a point [x, y]"),
    "no robot": (put("robots", []), "robots:", "1 to 2"),
    "three robots": (put("robots", [PANDA] * 3), "robots:", "1 to 2"),
    "two robots for one": (
        put("robots", [PANDA, {"model": "panda", "base": {"x": 1.2}}]), "robots:", "1 robot",
    ),
    "unknown robot": (put("robots", [{"model": "pnda"}]), "robots[0].model:", "did you mean 'panda'?"),
    "robot file that is missing": (put("robots", [{"model": "arm.urdf"}]), "robots[0].model:", "no such file"),
    "tip of negative radius": (
        put("robots", [{"model": "panda", "tip_radius": -0.01}]), "robots[0].tip_radius:", "[0.002, 0.1]",
    ),
    "goal out of reach": (put("goal.x", 1.5), "goal:", "within the 1.005 m"),
    "goal on another planet": (put("goal.x", 1e9), "goal.x:", "[-10, 10]"),
    "start out of reach": (put("start.y", -1.5), "start:", "within the 1.005 m"),
    "start on the base": (put("start", {"x": 0.05, "y": 0}), "start:", "0.1 m or more"),
    "goal on the base": (put("goal", {"x": 0.0, "y": 0.1}), "goal:", "0.1 m or more"),
    "obstacle on the start": (put("obstacles", [post(0.4, 0.25)]), "start:", "no overlap with obstacle 'post'"),
    "obstacle on the goal": (put("obstacles", [post(0.7, -0.2)]), "goal:", "no overlap with obstacle 'post'"),
    "obstacle on the base": (put("obstacles", [post(0.0, 0.05)]), "obstacles[0].pose:", "0.1 m or more"),
    "obstacles on each other": (
        put("obstacles", [post(0.5, 0.5), post(0.55, 0.5, "pole")]), "obstacles[1].pose:", "'post'",
    ),
    "two obstacles of one name": (
        put("obstacles", [post(0.5, 0.5), post(0.5, -0.5)]), "obstacles[1].name:", "a name of its own",
    ),
    "obstacle called object": (put("obstacles", [post(0.5, 0.5, "object")]), "obstacles[0].name:", "of its own"),
    "true start on an obstacle": (
        lambda d: d.update(obstacles=[post(0.38, 0.4)], start_error={"y": 0.1}), "start_error:", "'post'",
    ),
    "unknown mode": (put("modes", ["rear_psh"]), "modes[0]:", "did you mean 'rear_push'?"),
    "mode twice": (put("modes", ["rear_push"] * 2), "modes[1]:", "twice"),
    "no mode": (put("modes", []), "modes:", "1 or more"),
    "mode that is a number": (put("modes", [1]), "modes[0]:", "a name"),
    "tolerance zero": (put("tolerance.position", 0), "tolerance.position:", "(0, 1]"),
    "force limit zero": (put("limits.normal_force", 0), "limits.normal_force:", "(0, 1000]"),
    "time limit negative": (put("limits.time", -1), "limits.time:", "(0, 3600]"),
    "workspace the wrong way round": (
        put("limits.workspace", {"x": [1, 0], "y": [-1, 1]}), "limits.workspace.x:", "lower < upper",
    ),
    "goal off the workspace": (
        put("limits.workspace", {"x": [0, 0.5], "y": [-1, 1]}), "goal:", "limits.workspace",
    ),
    "negative noise": (put("sensing.force_noise", -1), "sensing.force_noise:", "[0, 100]"),
    "too fast": (put("motion.speed", 0.3), "motion.speed:", "(0, 0.2]"),
    "contact above the object": (put("motion.contact_height", 0.2), "motion.contact_height:", "0.15 m"),
}  # fmt: skip


def refusal(*args: str) -> str:
    """Run ``pps`` in this process; return the one line that it refused with."""
    result = CliRunner().invoke(app, list(args))
    assert result.exit_code == 2, (result.stdout, result.stderr)
    assert result.stdout == ""
    lines = result.stderr.splitlines()
    assert len(lines) == 1, result.stderr
    assert "Traceback" not in result.stderr
    assert len(lines[0]) < 700
    return lines[0]


def pps(*args: str, **env: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from pushpressslide.cli import main; main()", *args]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **env}, check=False)


@pytest.mark.parametrize("case", WRONG, ids=lambda case: case.replace(" ", "-"))
def test_a_file_wrong_in_one_way_is_refused_by_file_field_and_what_is_allowed(
    case: str, tmp_path: Path
) -> None:
    change, field, allowed = WRONG[case]
    data = copy.deepcopy(GOOD)
    change(data)
    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump(data))
    line = refusal("run", str(file), "--engine", "planar", "--out", str(tmp_path / "out"))
    assert line.startswith(f"pps: {file}: ")
    assert field in line
    assert allowed in line
    assert not (tmp_path / "out").exists()


TEXTS = {
    "empty file": (b"", "empty"),
    "comments only": (b"# nothing\n", "empty"),
    "bad YAML": (b"name: a\nstart: {x: 1\n", "line 3: not valid YAML"),
    "tab": (b"name:\n\t- a\n", "line 2: not valid YAML"),
    "list": (b"- name: a\n", "the top level is a list"),
    "plain text": (b"hello\n", "the top level is a str"),
    "duplicate key": (b"name: a\nname: b\n", "line 2: not valid YAML: duplicate key 'name'"),
    "duplicate nested key": (
        b"start:\n  x: 1\n  y: 2\n  x: 3\n",
        "line 4: not valid YAML: duplicate key 'x'",
    ),
    "binary": (bytes(range(256)), "not UTF-8 text"),
    "zero bytes": (b"\0" * 100, "not valid YAML"),
    "two documents": (b"name: a\n---\nname: b\n", "line 2: not valid YAML"),
    "python object": (b"name: !!python/object:os.system {}\n", "line 1: not valid YAML"),
    "key that is a list": (b"? [a]\n: 1\n", "not valid YAML"),
    "impossible date": (b"name: 2020-99-99\n", "not valid YAML"),
    "nested too deeply": (b"[" * 20000, "not valid YAML"),
    "too long": (b"#" * 1_000_001, "longer than 1000000 bytes"),
    "alias without anchor": (b"name: *a\n", "line 1: not valid YAML"),
}


@pytest.mark.parametrize("case", TEXTS, ids=lambda case: case.replace(" ", "-"))
def test_a_file_that_is_no_mapping_in_yaml_is_refused_with_the_line(case: str, tmp_path: Path) -> None:
    content, expected = TEXTS[case]
    file = tmp_path / "task.yaml"
    file.write_bytes(content)
    line = refusal("select", str(file))
    assert line.startswith(f"pps: {file}: ")
    assert expected in line


def test_a_list_that_holds_itself_many_times_over_is_refused_at_once(tmp_path: Path) -> None:
    rows = ["a0: &a0 [x, x]"] + [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)]
    file = tmp_path / "task.yaml"
    file.write_text("\n".join([*rows, "name: *a11", ""]))
    assert "unknown field" in refusal("select", str(file))


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal("run", str(tmp_path / "none.yaml"))


def test_a_directory_is_refused(tmp_path: Path) -> None:
    assert "it is a directory" in refusal("run", str(tmp_path))


def test_an_unreadable_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def denied(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", denied)
    assert "Permission denied" in refusal("run", str(tmp_path / "task.yaml"))


def test_an_unknown_task_is_refused_with_the_nearest_shipped_name() -> None:
    line = refusal("run", "rear-push-lft")
    assert "did you mean 'rear-push-left'?" in line
    assert "rear-push-rear" in line


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("object.mass", "field.field=value"),
        ("=1", "field.field=value"),
        ("object..mass=1", "field.field=value"),
        ("object.mass=[1", "not valid YAML"),
        ("object.mass=heavy", "object.mass: 'heavy' is not allowed"),
        ("objct.mass=1", "did you mean 'object'?"),
        ("robots.1.model=panda", "an index from 0 to 0"),
        ("robots.first.model=panda", "an index from 0 to 0"),
        ("name.first=a", "a value without fields"),
    ],
)
def test_a_bad_override_is_refused(override: str, expected: str) -> None:
    assert expected in refusal("run", "rear-push-rear", "--set", override)


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["run", "rear-push-rear", "--engine", "bullet"], "'--engine'"),
        (["run", "rear-push-rear", "--mode", "rear_pull"], "did you mean 'rear_push'?"),
        (["run", "rear-push-rear", "--seed", "-1"], "'--seed'"),
        (["run", "rear-push-rear", "--seed", "one"], "'--seed'"),
        (["run", "rear-push-rear", "--engine", "planar", "--live"], "--live is not allowed"),
        (["run", "rear-push-rear", "--speed", "1"], "--speed"),
        (["run"], "TASK"),
        (["rn"], "'rn'"),
        (["sweep", "rear-push-rear"], "--samples"),
        (["sweep", "rear-push-rear", "--samples", "0"], "--samples"),
        (["report"], "DIR"),
    ],
)
def test_a_wrong_option_is_refused(args: list[str], expected: str) -> None:
    assert expected in refusal(*args)


def test_a_folder_that_holds_a_result_is_refused_unless_forced(tmp_path: Path) -> None:
    (tmp_path / "result.json").write_text("{}")
    assert "--force" in refusal("run", "rear-push-rear", "--out", str(tmp_path))


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "--out" in refusal("run", "rear-push-rear", "--out", str(tmp_path / "file"))
    assert "--out" in refusal("run", "rear-push-rear", "--out", str(tmp_path / "file" / "below"))


@pytest.mark.parametrize(
    "args",
    [
        ["run", "nothing-of-the-kind"],
        ["run", "rear-push-rear", "--set", "object.mass=0", "--json"],
        ["plan", "rear-push-rear", "--engine"],
        ["select", "/"],
        ["report", "/nonexistent"],
    ],
)
def test_the_process_refuses_with_status_two_and_one_line(args: list[str]) -> None:
    done = pps(*args, PPS_TRACEBACK="")
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert "Traceback" not in done.stderr


def test_the_file_that_the_wrong_ones_are_made_from_is_right(tmp_path: Path) -> None:
    from pushpressslide.pipeline.task_file import load_task

    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump(GOOD))
    assert load_task(file).name == "cube"
