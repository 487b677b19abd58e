"""A console that does not know all letters shows others in their place."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}


def pps(*args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pushpressslide", *args],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **ASCII},
    )


def test_a_plan_into_a_folder_beyond_ascii_ends_as_usual(tmp_path: Path) -> None:
    out = tmp_path / "Ergebnisse-für-Ω"
    done = pps("plan", "rear-push-rear", "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "Ergebnisse-f" in done.stdout
    assert (out / "plan.json").is_file()


def test_a_run_into_a_folder_beyond_ascii_can_be_read(tmp_path: Path) -> None:
    out = tmp_path / "für-Ω"
    near = "goal={x: 0.482, y: 0.209, yaw_deg: -52.7}"
    task = ("rear-push-rear", "--set", near)
    done = pps("run", *task, "--engine", "planar", "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert "für-Ω" in json.loads((out / "result.json").read_text("utf-8"))["command"]


def test_json_stays_json_where_letters_are_unknown(tmp_path: Path) -> None:
    task = tmp_path / "task.yaml"
    shown = pps("show", "rear-push-rear")
    task.write_text(shown.stdout + "\n", encoding="utf-8")
    text = task.read_text("utf-8").replace("description:", "description: Würfel ", 1)
    task.write_text(text, encoding="utf-8")
    assert pps("show", str(task)).returncode == 0
    done = pps("plan", str(task), "--json", "--out", str(tmp_path / "Ω"))
    assert done.returncode == 0, done.stderr
    json.loads(done.stdout)


def test_a_refusal_beyond_ascii_is_one_line(tmp_path: Path) -> None:
    done = pps("plan", str(tmp_path / "Würfel.yaml"))
    assert done.returncode == 2
    assert done.stderr.startswith("pps: ")
    assert len(done.stderr.splitlines()) == 1
