"""A second process draws the second half of a film; without it all is drawn here."""

import os
import pickle
import subprocess
import sys

import av
import numpy as np
import pytest

from pushpressslide.core.errors import SimulationError
from pushpressslide.view.drake import second_half as halves
from pushpressslide.view.drake.run_film import FilmedRun, write_video
from pushpressslide.view.drake.second_half import second_half

SIZE = (160, 90)
SCRIPT = """
import pickle, sys
from pathlib import Path
from pushpressslide.view.drake.run_film import write_video
from pushpressslide.view.drake.second_half import second_half

print("once", flush=True)
with open(sys.argv[1], "rb") as file:
    run = pickle.load(file)
out = Path(sys.argv[2])
with second_half(run, out) as later:
    drawn = later.packets()
    write_video(run, out, later)
print(later.first, len(drawn))
"""


@pytest.fixture
def filmed(arm_run, monkeypatch):
    monkeypatch.setattr(halves, "_cpus", lambda: 2)
    return FilmedRun(arm_run.plan, arm_run.record, size=SIZE)


def film(run, out, later=None):
    """Frames of a film, and the time [s] of each."""
    try:
        write_video(run, out, later)
    except SimulationError as error:
        pytest.skip(str(error))
    with av.open(str(out)) as file:
        frames = list(file.decode(video=0))
    times = [frame.time for frame in frames]
    return [frame.to_ndarray(format="rgb24") for frame in frames], times


def test_a_film_in_two_halves_is_the_one_drawn_alone(filmed, tmp_path):
    alone, times = film(filmed, tmp_path / "alone.mp4")
    out = tmp_path / "run.mp4"
    with second_half(filmed, out) as later:
        assert later.packets()
        both, meanwhile = film(filmed, out, later)
    assert later.first == len(alone) // 2
    assert len(alone) == len(both) == len(filmed.ticks(out))
    assert meanwhile == pytest.approx(times)
    apart = [
        np.abs(a - b.astype(float)).mean() for a, b in zip(alone, both, strict=True)
    ]
    assert max(apart) < 2.0
    assert np.abs(both[0].astype(float) - both[-1]).mean() > 2.0 * max(apart)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["alone.mp4", "run.mp4"]


@pytest.mark.parametrize(
    "command",
    [
        (sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"),
        (sys.executable, "-c", "raise SystemExit(3)"),
        ("/no/such/python",),
    ],
)
def test_a_process_that_fails_or_cannot_start_is_made_up_for(
    filmed, tmp_path, monkeypatch, command
):
    monkeypatch.setattr(halves, "COMMAND", command)
    out = tmp_path / "run.mp4"
    with second_half(filmed, out) as later:
        frames, times = film(filmed, out, later)
    assert len(frames) == len(filmed.ticks(out))
    assert times == pytest.approx([0.04 * k for k in range(len(times))])


def test_a_run_that_no_other_process_can_read_is_filmed_alone(filmed, tmp_path):
    filmed.record.meta["own"] = lambda: None
    try:
        with second_half(filmed, tmp_path / "run.mp4") as later:
            assert later is None
    finally:
        del filmed.record.meta["own"]


def test_no_second_process_on_one_cpu_for_a_short_film_or_another_format(
    filmed, tmp_path, monkeypatch
):
    monkeypatch.setattr(halves, "COMMAND", None)  # an error if it were started
    with second_half(filmed, tmp_path / "run.webp") as later:
        assert later is None
    short = FilmedRun(filmed.plan, filmed.record, rate=1.0)
    with second_half(short, tmp_path / "run.mp4") as later:
        assert later is None
    monkeypatch.setattr(halves, "_cpus", lambda: 1)
    with second_half(filmed, tmp_path / "run.mp4") as later:
        assert later is None


def test_the_process_ends_with_the_block(filmed, tmp_path):
    with second_half(filmed, tmp_path / "run.mp4") as later:
        (process, _) = later.packets.args
        assert process.poll() is None
    assert process.poll() is not None


@pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="on one CPU")
def test_a_script_without_a_guard_runs_once(filmed, tmp_path):
    film(filmed, tmp_path / "here.mp4")  # skips if nothing can be rendered
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    given = tmp_path / "run.pickle"
    given.write_bytes(pickle.dumps(filmed))
    done = subprocess.run(
        [sys.executable, script, given, tmp_path / "run.mp4"],
        capture_output=True,
        text=True,
        check=True,
    )
    count = len(filmed.ticks(tmp_path / "run.mp4"))
    first = count // 2
    assert done.stdout.split() == ["once", str(first), str(count - first)]
