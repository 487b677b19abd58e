"""The shell completes the package's names; no list of names is out of date."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pushpressslide.cli import complete
from pushpressslide.modes import MODES
from pushpressslide.taskfile.load import shipped_tasks


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


def completed(line: str, folder: Path) -> list[str]:
    """Completions that bash offers for the last word of a line."""
    words = line.split(" ")
    return pps(
        folder=folder,
        _PPS_COMPLETE="complete_bash",
        COMP_WORDS=line,
        COMP_CWORD=str(len(words) - 1),
    ).split()


def test_the_names_are_those_of_the_package() -> None:
    assert complete.mode_names() == sorted(MODES)
    assert complete.tasks("")[: len(shipped_tasks())] == list(shipped_tasks())


def test_a_task_is_a_shipped_one_a_yaml_file_or_a_folder_on_the_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("pivot-of-mine.yaml", "pivot.txt", "more/mine.yml"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    shipped = ["pivot", "pivot-and-move"]
    assert complete.tasks("piv") == [*shipped, "pivot-of-mine.yaml"]
    assert complete.tasks("more") == ["more/"]
    assert complete.tasks("more/") == ["more/mine.yml"]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("pps run rear-push-l", ["rear-push-left"]),
        ("pps show swa", ["swap"]),
        ("pps plan post --mode press_s", ["press_slide"]),
        ("pps run post --engine ", ["drake", "mujoco", "planar"]),
    ],
)
def test_the_shell_is_offered(line: str, expected: list[str], tmp_path: Path) -> None:
    assert sorted(completed(line, tmp_path)) == sorted(expected)


def test_completion_is_installed_by_the_command(tmp_path: Path) -> None:
    home = {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    pps("--install-completion", "bash", folder=tmp_path, **home)
    assert "_PPS_COMPLETE" in pps("--show-completion", "bash", folder=tmp_path, **home)
    assert "pps.sh" in (tmp_path / ".bashrc").read_text()


@pytest.mark.parametrize(
    ("command", "names"),
    [
        ("run", complete.mode_names()),
        ("run", ("drake|mujoco|planar", "generated|drake_models")),
    ],
)
def test_help_names_the_choices(command: str, names: list[str], tmp_path: Path) -> None:
    shown = pps(command, "-h", folder=tmp_path, COLUMNS="80")
    # a long name may be broken after its hyphen
    text = " ".join(shown.replace("-\n", "-").split()).replace("- ", "-")
    for name in names:
        assert name in text
