"""``pps`` has the commands of the studies if they are installed."""

import fcntl
import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.cli.folders import LOCK
from pushpressslide.cli.installed import GROUP, PACKAGES
from pushpressslide_studies.bench.bench import BENCHMARKS
from pushpressslide_studies.cli import complete
from pushpressslide_studies.paper.experiments import AXLE, EXPERIMENTS


def pps(*args: str, folder: Path, **env: str) -> str:
    """Output of the command, run in a folder."""
    command = (sys.executable, "-m", "pushpressslide", *args)
    return subprocess.run(
        command,
        check=True,
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | env,
    ).stdout


def test_the_entry_points_are_the_commands_that_the_core_knows_of() -> None:
    assert {entry.name for entry in entry_points(group=GROUP)} == {*PACKAGES}


@pytest.mark.parametrize("command", sorted(PACKAGES))
def test_every_command_has_help(command: str) -> None:
    runner = CliRunner()
    result = runner.invoke(app, [command, "--help"])
    assert result.exit_code == 0, result.stderr
    assert "Usage" in result.stdout
    assert f"\n  {command} " in runner.invoke(app, ["--help"]).stdout


def test_the_names_are_those_of_the_package() -> None:
    assert list(complete.BENCHMARKS) == list(BENCHMARKS)
    assert list(complete.EXPERIMENTS) == [*EXPERIMENTS, AXLE]


@pytest.mark.parametrize(
    ("command", "names"),
    [("bench", complete.BENCHMARKS), ("reproduce", complete.EXPERIMENTS)],
)
def test_help_names_the_choices(command: str, names: list[str], tmp_path: Path) -> None:
    shown = pps(command, "-h", folder=tmp_path, COLUMNS="80")
    # a long name may be broken after its hyphen
    text = " ".join(shown.replace("-\n", "-").split()).replace("- ", "-")
    for name in names:
        assert name in text


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("pps bench st", ["sticking", "start"]),
        ("pps reproduce --only rear", ["rear-push"]),
        ("pps rep", ["report", "reproduce"]),
    ],
)
def test_the_shell_is_offered(line: str, expected: list[str], tmp_path: Path) -> None:
    words = {"COMP_WORDS": line, "COMP_CWORD": str(line.count(" "))}
    offered = pps(folder=tmp_path, _PPS_COMPLETE="complete_bash", **words)
    assert sorted(offered.split()) == sorted(expected)


@pytest.fixture
def locked_folder(tmp_path: Path) -> Iterator[Path]:
    """A folder of results that is locked."""
    folder = tmp_path / "out"
    folder.mkdir()
    with (folder / LOCK).open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


@pytest.mark.parametrize("words", [("bench", "start"), ("reproduce",), ("gym-pusht",)])
def test_a_folder_in_use_is_refused(
    words: tuple[str, ...], locked_folder: Path
) -> None:
    result = CliRunner().invoke(app, [*words, "--out", str(locked_folder)])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert "is writing in it" in line
