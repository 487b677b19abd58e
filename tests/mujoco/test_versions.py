"""The oldest and the newest MuJoCo that pyproject.toml allows push an object to its
goal.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PUSH = """
import json
import sys

import mujoco
import pushpressslide as pps

task = pps.load_task("rear-push-rear", {"robots.0.interface": sys.argv[1]})
record = pps.run(task, engine="mujoco")
facts = {"mujoco": record.meta["mujoco"], "path": mujoco.__file__}
facts["success"] = record.success
print(json.dumps(facts | {"error": record.figures["final_position_error"]}))
"""


def lower_bound() -> str:
    """Return the oldest version that the extra ``mujoco`` allows."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    wanted = " ".join(project["optional-dependencies"]["mujoco"])
    found = re.search(r"mujoco>=([\d.]+)", wanted)
    assert found is not None
    return found[1]


def install(requirements: list[str], folder: Path) -> None:
    """Install packages into a folder, without what they require."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps"]
    command += ["--disable-pip-version-check", "--target", str(folder), *requirements]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or ["no message"]
        pytest.skip(f"pip cannot fetch {' '.join(requirements)}: {lines[-1]}")


def parts(folder: Path) -> list[str]:
    """Return requirements of the packages that MuJoCo in a folder is split into."""
    wanted = [
        requirement
        for found in distributions(path=[str(folder)])
        for requirement in found.requires or ()
    ]
    return [one for one in wanted if one.startswith("mujoco-") and "extra" not in one]


@pytest.fixture(scope="module", params=["oldest", "newest"])
def library(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, str]:
    """Folder with a MuJoCo, and its version."""
    folder = tmp_path_factory.mktemp(request.param)
    oldest = request.param == "oldest"
    install([f"mujoco=={lower_bound()}" if oldest else "mujoco"], folder)
    rest = parts(folder)
    if rest:
        install(rest, folder)
    versions = {one.name: one.version for one in distributions(path=[str(folder)])}
    return folder, versions["mujoco"]


@pytest.mark.long
@pytest.mark.parametrize("interface", ["torque", "position"])
def test_an_allowed_version_pushes_to_the_goal(
    library: tuple[Path, str], interface: str
) -> None:
    folder, version = library
    others = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    path = os.pathsep.join([str(folder), *filter(None, others)])
    done = subprocess.run(
        [sys.executable, "-c", PUSH, interface],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout.splitlines()[-1])
    assert facts["mujoco"] == version
    assert Path(facts["path"]).is_relative_to(folder)
    assert facts["success"]
    assert facts["error"] < 3e-3


def test_the_lower_bound_is_a_version() -> None:
    assert len(lower_bound().split(".")) == 3
