"""Without Drake everything works except Drake runs, which say how to install it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import pushpressslide

SOURCE = Path(pushpressslide.__file__).parent
ABSENT = "import sys; sys.modules['pydrake'] = None; "
"""Makes Drake a package that is not installed."""
INSTALLS = "pip install 'pushpressslide[drake]'"


def python(code: str, *args: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run code in a Python that lacks Drake."""
    return subprocess.run(
        [sys.executable, "-c", ABSENT + code, *args],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(SOURCE.parent)},
    )


def pps(*args: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command without Drake."""
    return python("from pushpressslide.cli import main; main()", *args, folder=folder)


@pytest.mark.parametrize(
    "args",
    [
        ("run", "rear-push-rear"),
        ("run", "swap"),
        ("run", "rear-push-rear", "--live"),
        ("select", "rear-push-rear", "--joints"),
        ("sweep", "rear-push-rear", "--samples", "2"),
    ],
)
def test_what_needs_drake_says_how_to_install_it(
    args: tuple[str, ...], tmp_path: Path
) -> None:
    done = pps(*args, folder=tmp_path)
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith("pps: engine drake: ")
    assert INSTALLS in line
    assert not list((tmp_path / "runs").glob("*/*"))


def test_a_task_is_planned_and_run_on_the_planar_engine(tmp_path: Path) -> None:
    near = "goal={x: 0.482, y: 0.209, yaw_deg: -52.7}"
    out = ("--out", str(tmp_path / "out"))
    args = ("rear-push-rear", "--set", near, "--json", *out)
    assert pps("select", *args, folder=tmp_path).returncode == 0
    assert pps("plan", *args, "--force", folder=tmp_path).returncode == 0
    done = pps("run", *args, "--force", "--engine", "planar", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["success"]
    assert (tmp_path / "out" / "report.html").is_file()
    assert pps("report", str(tmp_path / "out"), folder=tmp_path).returncode == 0


def test_every_module_outside_sim_is_imported(tmp_path: Path) -> None:
    names = []
    for path in SOURCE.rglob("*.py"):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        with_drake = parts[0] == "sim" or parts[:2] == ("view", "drake")
        if not with_drake and parts[-1] not in ("__init__", "__main__"):
            names.append(".".join(parts))
    code = """
from importlib import import_module
for name in sys.argv[1:]:
    import_module(f"pushpressslide.{name}")
"""
    done = python(code, *names, folder=tmp_path)
    assert len(names) > 200
    assert done.returncode == 0, done.stderr


def test_in_python_it_is_an_error_of_ours_and_of_an_import(tmp_path: Path) -> None:
    code = """
import pushpressslide as pps
task = pps.load_task("rear-push-rear")
try:
    pps.run(task)
except pps.PushPressSlideError as error:
    print(isinstance(error, ImportError), error)
"""
    done = python(code, folder=tmp_path)
    assert done.stdout.startswith("True engine drake: "), done.stderr
    assert INSTALLS in done.stdout
