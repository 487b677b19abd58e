"""Ctrl-C or a request to terminate at any time: status 130, one line, finished results
are kept, and no file is incomplete.

The process interrupts itself at a chosen point, so that nothing depends on the speed of
the machine.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pushpressslide.report.files import load_run

PRESS = "import os, signal\ndef press(): os.kill(os.getpid(), signal.SIGINT)\n"
TERM = "def press(): os.kill(os.getpid(), signal.SIGTERM)\n"
BOTH = pytest.mark.parametrize("press", ["", TERM], ids=["SIGINT", "SIGTERM"])
AFTER = """
def pressed_after(function, calls=1):
    left = [calls]
    def wrapped(*args, **kwargs):
        answer = function(*args, **kwargs)
        left[0] -= 1
        if left[0] == 0:
            press()
        return answer
    return wrapped
"""
# a tenth of a metre along the path to the task's own goal
NEAR = ("--set", "goal={x: 0.482, y: 0.209, yaw_deg: -52.7}")
RECORDER = "from pushpressslide.control.recording import Recorder"
MAIN = "\nif __name__ == '__main__':\n    from pushpressslide.cli import main\n    main()\n"


def pps(folder: Path, patch: str, *args: str) -> subprocess.CompletedProcess[str]:
    """Run ``pps`` in a process whose code is patched; a file, so that a sweep's workers
    can start from it.
    """
    indented = "".join(f"    {line}\n" for line in [*patch.splitlines(), "pass"])
    script = folder / "patched.py"
    script.write_text(
        PRESS + AFTER + "\nif __name__ == '__main__':\n" + indented + MAIN
    )
    return subprocess.run(
        [sys.executable, script, *args], capture_output=True, text=True, check=False
    )


def check(done: subprocess.CompletedProcess[str]) -> str:
    assert done.returncode == 130, (done.stdout, done.stderr)
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith("pps: interrupted")
    return line


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.rglob("*") if path.is_file()}


@BOTH
@pytest.mark.parametrize("command", ["run", "plan"])
def test_while_planning_nothing_is_left(
    command: str, press: str, tmp_path: Path
) -> None:
    patch = (
        f"{press}import pushpressslide.selection.solve as r\n"
        "r._selected = pressed_after(r._selected)"
    )
    out = tmp_path / "out"
    check(pps(tmp_path, patch, command, "rear-push-rear", "--out", str(out)))
    assert not (tmp_path / "out").exists()


@BOTH
@pytest.mark.parametrize("engine", ["planar", "drake"])
def test_while_simulating_the_record_so_far_is_kept_whole(
    engine: str, press: str, tmp_path: Path
) -> None:
    add = "Recorder.add = pressed_after(Recorder.add, 100)"
    patch = f"{press}{RECORDER}\n{add}"
    out = tmp_path / "out"
    line = check(
        pps(
            tmp_path,
            patch,
            "run",
            "rear-push-rear",
            "--engine",
            engine,
            "--out",
            str(out),
        )
    )
    assert str(out) in line
    run = load_run(out)
    assert len(run.record.arrays["time"]) == 100
    assert run.result["reason"]["code"] == run.record.reason == "interrupted"
    assert not run.result["success"]
    assert names(out) == {"task.yaml", "plan.json", "record.npz", "result.json"}


@BOTH
def test_while_writing_pages_record_and_result_are_kept(
    press: str, tmp_path: Path
) -> None:
    patch = (
        f"{press}import pushpressslide.view.planar.replay as r\n"
        "r.write_replay = pressed_after(r.write_replay)"
    )
    out = tmp_path / "out"
    check(
        pps(
            tmp_path,
            patch,
            "run",
            "rear-push-rear",
            *NEAR,
            "--engine",
            "planar",
            "--out",
            str(out),
        )
    )
    assert load_run(out).result["success"]
    assert "report.html" not in names(out)
    assert not [name for name in names(out) if ".part" in name]


def test_a_run_over_an_older_one_leaves_none_of_its_pages(tmp_path: Path) -> None:
    out = tmp_path / "out"
    run = ("run", "rear-push-rear", *NEAR, "--engine", "planar", "--force")
    assert pps(tmp_path, "", *run, "--out", str(out), "--quiet").returncode == 0
    assert "report.html" in names(out)
    patch = f"{RECORDER}\nRecorder.add = pressed_after(Recorder.add, 10)"
    check(pps(tmp_path, patch, *run, "--out", str(out)))
    assert names(out) == {"task.yaml", "plan.json", "record.npz", "result.json"}


def test_an_error_that_ctrl_c_turned_into_is_still_an_interruption(
    tmp_path: Path,
) -> None:
    patch = """
import pushpressslide.selection.solve as r
def selected(empty, enough):
    try:
        press()
        while True: pass
    except KeyboardInterrupt:
        raise ImportError("initialization failed")
r._selected = selected
"""
    check(pps(tmp_path, patch, "run", "rear-push-rear", "--out", str(tmp_path / "out")))


@pytest.mark.parametrize("signal", ["SIGINT", "SIGTERM"])
def test_a_sweep_keeps_its_finished_samples_and_goes_on(
    signal: str, tmp_path: Path
) -> None:
    patch = (
        "import pushpressslide.jobs.rows as r\n"
        f"def press(): os.kill(os.getpid(), signal.{signal})\n"
        "r.Rows.add = pressed_after(r.Rows.add)"
    )
    out = tmp_path / "out"
    options = f"sweep rear-push-rear --samples 2 --engine planar --jobs 1 --out {out}"
    sweep = options.split()
    check(pps(tmp_path, patch, *sweep))
    assert names(out) == {"rows.jsonl"}
    assert len((out / "rows.jsonl").read_text().splitlines()) == 1
    if signal == "SIGTERM":
        return  # what is kept is the same, and so is going on from it
    done = pps(tmp_path, "", *sweep, "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["drawn"] == 2
    assert len((out / "rows.jsonl").read_text().splitlines()) == 2
