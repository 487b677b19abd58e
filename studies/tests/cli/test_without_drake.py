"""Without Drake the studies name the commands that need it, and run the others."""

import os
import subprocess
import sys
from pathlib import Path

import pushpressslide_studies

SOURCE = Path(pushpressslide_studies.__file__).parent
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
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def test_the_experiments_say_how_to_install_it(tmp_path: Path) -> None:
    code = "from pushpressslide.cli import main; main()"
    done = python(code, "reproduce", "--only", "rear-push", folder=tmp_path)
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith("pps: engine drake: ")
    assert INSTALLS in line
    assert not list((tmp_path / "runs").glob("*/*"))


def test_every_module_outside_sim_is_imported(tmp_path: Path) -> None:
    names = []
    for path in SOURCE.rglob("*.py"):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        if parts[0] != "sim" and parts[-1] != "__init__":
            names.append(".".join(parts))
    code = """
from importlib import import_module
for name in sys.argv[1:]:
    import_module(f"pushpressslide_studies.{name}")
"""
    done = python(code, *names, folder=tmp_path)
    assert len(names) > 50
    assert done.returncode == 0, done.stderr


def test_a_benchmark_names_what_is_missing_and_goes_on(tmp_path: Path) -> None:
    code = """
from pushpressslide_studies.bench.contestants import press_contestants, push_contestants
for contestants in (push_contestants(0), press_contestants(0)):
    print(contestants["Drake"], len(contestants["closed form"]) > 100)
"""
    done = python(code, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"not installed: {INSTALLS} True"] * 2
