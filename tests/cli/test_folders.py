"""A folder of results is written by one command at a time. A failed write is reported
in one line with the files that are left.
"""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app, folders
from pushpressslide.cli.folders import LOCK, hold, leave_folders, results_folder
from pushpressslide.core import whole_file
from pushpressslide.core.errors import PushPressSlideError

Refusal = Callable[..., str]
NEAR = "goal={x: 0.482, y: 0.209, yaw_deg: -52.7}"  # 0.1 m ahead
RUN = ("run", "rear-push-rear", "--engine", "planar", "--set", NEAR)
HOLDER = """
import sys, time
from pathlib import Path
from pushpressslide.cli.folders import hold
hold(Path(sys.argv[1]))
print("held", flush=True)
time.sleep(600)
"""


@pytest.fixture
def holder(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that writes in the folder ``out``."""
    command = [sys.executable, "-c", HOLDER, str(tmp_path / "out")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


@pytest.mark.parametrize(
    "words",
    [
        RUN,
        (*RUN, "--force"),
        ("plan", "rear-push-rear"),
        ("select", "rear-push-rear"),
        ("sweep", "rear-push-rear", "--samples", "1", "--force"),
        ("identify", "."),
    ],
)
def test_a_folder_in_use_is_refused_by_every_command(
    words: tuple[str, ...],
    holder: subprocess.Popen[str],
    tmp_path: Path,
    refusal: Refusal,
) -> None:
    line = refusal(*words, "--out", str(tmp_path / "out"))
    assert f"process {holder.pid} is writing in it" in line
    assert str(tmp_path / "out") in line
    assert "give another folder" in line


def test_a_report_of_a_folder_in_use_is_refused(
    holder: subprocess.Popen[str], tmp_path: Path, refusal: Refusal
) -> None:
    assert f"process {holder.pid}" in refusal("report", str(tmp_path / "out"))


def test_a_killed_process_holds_no_folder_and_leaves_no_halves(
    holder: subprocess.Popen[str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    (out / "plots").mkdir()
    (out / "plots" / ".path.png.1.part.png").write_text("half")
    (out / "rows.jsonl").write_text("whole")
    os.kill(holder.pid, signal.SIGKILL)
    holder.wait()
    hold(out)
    assert (out / LOCK).read_text() == f"{os.getpid()}\n"
    leave_folders()
    assert [path.name for path in out.rglob("*") if path.is_file()] == ["rows.jsonl"]


def test_a_folder_that_was_made_and_left_empty_is_removed(tmp_path: Path) -> None:
    results_folder(tmp_path / "a" / "b", "run", False)
    assert (tmp_path / "a" / "b" / LOCK).is_file()
    leave_folders()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")
@pytest.mark.parametrize("words", [RUN, ("plan", "post"), ("select", "post")])
def test_a_folder_that_cannot_be_made_is_refused(
    words: tuple[str, ...], refusal: Refusal
) -> None:
    line = refusal(*words, "--out", "/proc/pps")
    assert "--out: '/proc/pps' is not allowed; allowed: a folder that can" in line


def test_a_new_file_that_cannot_be_written_is_refused(refusal: Refusal) -> None:
    line = refusal("new", "/proc/pps.yaml")
    assert "/proc/pps.yaml: it cannot be written (" in line


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Return a function that lets the disk be full from a file of a name on."""

    def fill(name: str) -> None:
        def flush(path: Path) -> None:
            if f".{name}." in path.name:
                raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(whole_file, "_flush", flush)

    return fill


@pytest.mark.parametrize(
    ("name", "left"),
    [
        ("task.yaml", "nothing"),
        ("record.npz", "plan.json, task.yaml"),
        ("report.html", "result.json"),
        ("plan.png", "record.npz, result.json, task.yaml"),
    ],
)
def test_a_full_disk_is_told_with_what_is_left(
    name: str, left: str, full: Callable[[str], None], tmp_path: Path, refusal: Refusal
) -> None:
    full(name)
    out = tmp_path / "out"
    line = refusal(*RUN, "--out", str(out))
    assert f"{name}: it cannot be written (No space left on device)" in line
    kept = line.partition(f"whole in {out}: ")[2]
    assert left in kept
    assert not list(out.rglob(".*"))


def test_an_error_of_the_disk_from_elsewhere_is_no_internal_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, refusal: Refusal
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "/tmp/x")

    monkeypatch.setattr("pushpressslide.jobs.run.run_task", fail)
    line = refusal(*RUN, "--out", str(tmp_path / "out"))
    assert "/tmp/x: it cannot be written" in line


def test_the_lock_is_gone_after_a_command(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["select", "rear-push-rear", "--out", str(out)]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert [path.name for path in out.iterdir()] == ["select.json"]


def test_where_the_file_system_has_no_locks_a_folder_is_used_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def flock(file: int, how: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(folders.fcntl, "flock", flock)
    assert hold(tmp_path) == tmp_path
    leave_folders()


def test_a_folder_without_permission_is_told_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> int:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(folders.os, "open", fail)
    with pytest.raises(PushPressSlideError, match="Permission denied"):
        hold(tmp_path)
