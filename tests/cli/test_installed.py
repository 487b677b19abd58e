"""Commands of other packages are found by their entry points."""

import os
import subprocess
import sys
from importlib.metadata import EntryPoints
from pathlib import Path

import pytest

from pushpressslide.cli import app, installed

MODULE = '''
import typer


def greet(name: str, loud: bool = False) -> None:
    """Greet somebody."""
    typer.echo(name.upper() if loud else name)
'''


def pps(*args: str, packages: Path) -> subprocess.CompletedProcess[str]:
    """Run the command where the packages of a folder are installed too."""
    path = os.pathsep.join([str(packages), *filter(None, sys.path)])
    return subprocess.run(
        [sys.executable, "-m", "pushpressslide", *args],
        check=False,
        capture_output=True,
        text=True,
        cwd=packages,
        env=os.environ | {"PYTHONPATH": path},
    )


def install(packages: Path, *entries: str) -> None:
    """Leave the metadata of a package that has some commands."""
    (packages / "greeting.py").write_text(MODULE)
    metadata = packages / "greeting-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: greeting\n")
    lines = (f"[{installed.GROUP}]", *entries, "")
    (metadata / "entry_points.txt").write_text("\n".join(lines))


def test_a_command_of_another_package_is_one_of_pps(tmp_path: Path) -> None:
    install(tmp_path, "greet = greeting:greet")
    done = pps("greet", "you", "--loud", packages=tmp_path)
    assert (done.stdout, done.returncode) == ("YOU\n", 0), done.stderr
    assert "Greet somebody." in pps("--help", packages=tmp_path).stdout
    assert "mean 'greet'" in pps("gret", packages=tmp_path).stderr


def test_a_command_of_ours_stays_ours(tmp_path: Path) -> None:
    install(tmp_path, "modes = greeting:greet")
    assert "rear_push" in pps("modes", packages=tmp_path).stdout


@pytest.mark.parametrize("place", ["greeting:missing", "missing:greet"])
def test_one_that_cannot_be_imported_is_one_line(place: str, tmp_path: Path) -> None:
    install(tmp_path, f"greet = {place}")
    done = pps("greet", packages=tmp_path)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert f"pps: greet: {place} cannot be imported" in line


@pytest.mark.parametrize("name", sorted(installed.PACKAGES))
def test_a_known_command_says_what_brings_it(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(installed, "entries", EntryPoints)
    assert app([name, "--out", "x"], standalone_mode=False) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == (
        f"pps: {name}: pushpressslide-studies is not installed; "
        "pip install pushpressslide-studies"
    )
