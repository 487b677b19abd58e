"""Files that hold no task, wrong overrides and wrong options are refused like wrong
fields.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Refusal = Callable[..., str]


def pps(*args: str, **env: str) -> subprocess.CompletedProcess[str]:
    command = [
        sys.executable,
        "-c",
        "from pushpressslide.cli import main; main()",
        *args,
    ]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **env}, check=False
    )


TEXTS = {
    "empty file": (b"", "empty"),
    "comments only": (b"# nothing\n", "empty"),
    "bad YAML": (b"name: a\nstart: {x: 1\n", "line 3: not valid YAML"),
    "tab": (b"name:\n\t- a\n", "line 2: not valid YAML"),
    "list": (b"- name: a\n", "the top level is a list"),
    "plain text": (b"hello\n", "the top level is a str"),
    "duplicate key": (
        b"name: a\nname: b\n",
        "line 2: not valid YAML: duplicate key 'name'",
    ),
    "duplicate nested key": (
        b"start:\n  x: 1\n  y: 2\n  x: 3\n",
        "line 4: not valid YAML: duplicate key 'x'",
    ),
    "binary": (bytes(range(256)), "not UTF-8 text"),
    "zero bytes": (b"\0" * 100, "not valid YAML"),
    "two documents": (b"name: a\n---\nname: b\n", "line 2: not valid YAML"),
    "python object": (
        b"name: !!python/object:os.system {}\n",
        "line 1: not valid YAML",
    ),
    "key that is a list": (b"? [a]\n: 1\n", "not valid YAML"),
    "impossible date": (b"name: 2020-99-99\n", "not valid YAML"),
    "nested too deeply": (b"[" * 20000, "not valid YAML"),
    "too long": (b"#" * 1_000_001, "longer than 1000000 bytes"),
    "alias without anchor": (b"name: *a\n", "line 1: not valid YAML"),
}


@pytest.mark.parametrize("case", TEXTS, ids=lambda case: case.replace(" ", "-"))
def test_a_file_that_is_no_mapping_in_yaml_is_refused_with_the_line(
    case: str, tmp_path: Path, refusal: Refusal
) -> None:
    content, expected = TEXTS[case]
    file = tmp_path / "task.yaml"
    file.write_bytes(content)
    line = refusal("select", str(file))
    assert line.startswith(f"pps: {file}: ")
    assert expected in line


def test_a_list_that_holds_itself_many_times_over_is_refused_at_once(
    tmp_path: Path, refusal: Refusal
) -> None:
    rows = ["a0: &a0 [x, x]"] + [
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)
    ]
    file = tmp_path / "task.yaml"
    file.write_text("\n".join([*rows, "name: *a11", ""]))
    assert "unknown field" in refusal("select", str(file))


def test_a_missing_file_is_refused(tmp_path: Path, refusal: Refusal) -> None:
    assert "no such file" in refusal("run", str(tmp_path / "none.yaml"))


def test_a_directory_is_refused(tmp_path: Path, refusal: Refusal) -> None:
    assert "it is a directory" in refusal("run", str(tmp_path))


def test_an_unreadable_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refusal: Refusal
) -> None:
    def denied(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", denied)
    assert "Permission denied" in refusal("run", str(tmp_path / "task.yaml"))


def test_an_unknown_task_is_refused_with_the_nearest_shipped_name(
    refusal: Refusal,
) -> None:
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
def test_a_bad_override_is_refused(
    override: str, expected: str, refusal: Refusal
) -> None:
    assert expected in refusal("run", "rear-push-rear", "--set", override)


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["run", "rear-push-rear", "--engine", "bullet"], "'--engine'"),
        (["run", "rear-push-rear", "--mode", "rear_pull"], "did you mean 'rear_push'?"),
        (["run", "rear-push-rear", "--seed", "-1"], "'--seed'"),
        (["run", "rear-push-rear", "--seed", "one"], "'--seed'"),
        (
            ["run", "rear-push-rear", "--engine", "planar", "--live"],
            "--live is not allowed",
        ),
        (["run", "rear-push-rear", "--speed", "1"], "--speed"),
        (["run"], "TASK"),
        (["rn"], "'rn'"),
        (["sweep", "rear-push-rear"], "--samples"),
        (["sweep", "rear-push-rear", "--samples", "0"], "--samples"),
        (["report"], "DIR"),
    ],
)
def test_a_wrong_option_is_refused(
    args: list[str], expected: str, refusal: Refusal
) -> None:
    assert expected in refusal(*args)


def test_a_folder_that_holds_a_result_is_refused_unless_forced(
    tmp_path: Path, refusal: Refusal
) -> None:
    (tmp_path / "result.json").write_text("{}")
    assert "--force" in refusal("run", "rear-push-rear", "--out", str(tmp_path))


def test_a_folder_that_cannot_be_made_is_refused(
    tmp_path: Path, refusal: Refusal
) -> None:
    (tmp_path / "file").write_text("")
    assert "--out" in refusal("run", "rear-push-rear", "--out", str(tmp_path / "file"))
    assert "--out" in refusal(
        "run", "rear-push-rear", "--out", str(tmp_path / "file" / "below")
    )


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that ``pps run`` has written."""
    folder = tmp_path_factory.mktemp("run")
    near = "goal={x: 0.482, y: 0.209, yaw_deg: -52.7}"
    where = ("--force", "--quiet", "--out", str(folder))
    args = ("--set", near, "--engine", "planar", *where)
    assert pps("run", "rear-push-rear", *args).returncode == 0
    return folder


OLD_PATH = {"start": [0.45, 0.0, 0.0], "pieces": [[0.0, 0.2]]}
OLD_CHOICE = {
    "mode": "rear_push",
    "feasible": True,
    "reason": "behind, 20 mm to the left",
    "contacts": [],
    "path_length": 0.2,
    "time": 9.0,
    "friction_margin": 0.3,
    "parameters": {"rho": 0.05, "push_force": 3.0},
    "path": OLD_PATH,
    "goal": None,
    "leg": 0,
    "judged": True,
    "following": None,
}
OLD_STRETCH = {
    "path": OLD_PATH,
    "profile": {"length": 0.2, "speed": 0.05, "acceleration": 0.1},
    "X_BV": [0.05, 0.0, 0.0],
}
OLD_PLAN = {
    "schema": 3,
    "task": "rear-push-rear",
    "grasps": [{"choice": OLD_CHOICE, "stretches": [OLD_STRETCH]}],
    "choices": [OLD_CHOICE],
}


def test_a_folder_with_a_plan_of_schema_three_is_refused_by_its_schema(
    run_folder: Path, tmp_path: Path, refusal: Refusal
) -> None:
    folder = shutil.copytree(run_folder, tmp_path / "old")
    (folder / "plan.json").write_text(json.dumps(OLD_PLAN))
    (folder / "report.html").unlink()
    line = refusal("report", str(folder))
    assert str(folder / "plan.json") in line
    assert "schema 3, this version reads 7 and 8" in line
    assert "run the task again" in line
    # beside a folder that can be read too
    assert line == refusal("report", str(run_folder), str(folder))
    assert not (folder / "report.html").exists()


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


@pytest.mark.parametrize("command", ["plan", "run"])
def test_an_arm_too_late_for_a_press_is_refused_with_the_figures(
    command: str, refusal: Refusal
) -> None:
    servo = ("interface=position", "lag=0.2", "delay=0.05")
    sets = [word for one in servo for word in ("--set", f"robots.0.{one}")]
    line = refusal(command, "press-slide", *sets)
    assert "after 0.254 s" in line
    assert "a press allows at most" in line
