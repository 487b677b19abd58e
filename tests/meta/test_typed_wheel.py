"""Types of the installed wheel: a user's file is checked strictly against it."""

import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
USERS = """
from typing import Any, assert_type

import numpy as np
from numpy.typing import NDArray

import pushpressslide as pps

task = pps.load_task("rear-push-rear", ["motion.speed=0.03"])
assert_type(task, pps.Task)
body = pps.Object(pps.Box((0.1, 0.1, 0.1)), 1.0, center_of_mass=(0.0, 0.0))
assert_type(body.mass, float)
choices = pps.select(task)
assert_type(choices, list[pps.Choice])
assert_type(choices[0].time, float | None)
plan = pps.plan(task, choices[0])
assert_type(plan, pps.Plan)
record = pps.run(plan, engine="planar")
assert_type(record.success, bool | None)
assert_type(record.arrays["time"], NDArray[np.float64])
push = pps.modes.rear_push.allocator(plan.contacts, task.contact_friction)
assert_type(push(2.0, 0.3, 0.0).margin, float)
try:
    pps.check_task(task)
except pps.PushPressSlideError as error:
    print(error)
"""
WRONG = """
import pushpressslide as pps

pps.plan(3)
pps.load_task("rear-push-rear").gaol
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of an environment that holds the wheel, and finds what it needs in
    this one.
    """
    folder = tmp_path_factory.mktemp("wheel")
    build = (sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder)
    subprocess.run(build, check=True, cwd=ROOT, capture_output=True)
    venv.create(folder / "environment")
    (packages,) = (folder / "environment").glob("lib/python*/site-packages")
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(packages)
    needed = packages / "needed.pth"
    needed.write_text(f"{sysconfig.get_paths()['purelib']}\n")
    return folder / "environment" / "bin" / "python"


def checked(python: Path, text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Check a file of a user with mypy, in a folder of the user's own."""
    file = folder / "mine.py"
    file.write_text(text)
    command = (sys.executable, "-m", "mypy", "--strict", "--python-executable", python)
    return subprocess.run(
        [*map(str, command), file.name],
        check=False,
        capture_output=True,
        text=True,
        cwd=folder,
    )


@pytest.mark.long
def test_a_user_s_file_is_strictly_typed(installed: Path, tmp_path: Path) -> None:
    done = checked(installed, USERS, tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.long
def test_what_is_wrong_in_a_user_s_file_is_found(
    installed: Path, tmp_path: Path
) -> None:
    done = checked(installed, WRONG, tmp_path)
    assert done.returncode == 1
    assert "mine.py:4" in done.stdout
    assert 'has no attribute "gaol"' in done.stdout


@pytest.mark.long
@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("0*.py")))
def test_the_examples_are_typed_for_a_user(
    path: Path, installed: Path, tmp_path: Path
) -> None:
    done = checked(installed, path.read_text(encoding="utf-8"), tmp_path)
    assert done.returncode == 0, done.stdout
