"""Many truths of one plan at once, compared with planar-engine runs without replans."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide.batch.fast import without_numba
from pushpressslide.cli import app
from pushpressslide.control import placement
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.pose import Pose2
from pushpressslide.jobs.batched import (
    batched,
    batched_rows,
    drawn_truths,
    planned,
    truths_of,
)
from pushpressslide.jobs.sampling import varied_task
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.kernels.path_run import ARRIVED, LEFT_FACE
from pushpressslide.planar.engine import run
from pushpressslide.taskfile.load import load_task

MOVE = 2.0  # the phase of a record in which the arms push
NEAR = 3e-4  # [m] of the final places
NEAR_YAW = math.radians(0.15)
NEAR_PATH = 2e-3  # [m] of the largest distance from the path


class Unchanging(placement.Replanner):
    """A replanner that keeps the plan."""

    def replan(self, *args, **kwargs):
        return ()

    def improve(self, *args, **kwargs):
        return None

    def retry(self, *args, **kwargs):
        return ()


def truths_about(task):
    """Return tasks with other frictions, masses, starts and centres of mass."""
    drawn = [varied_task(task, index, 0) for index in range(3)]
    centers = ((0.0, 0.008), (0.01, -0.005))
    moved = [
        replace(
            sample,
            object=replace(sample.object, center_of_mass=center),
            contact_friction=0.9 * task.contact_friction,
            start_error=Pose2(0.0, 0.01, 0.05),
        )
        for sample, center in zip(drawn, centers, strict=False)
    ]
    return [replace(sample, sensing=task.sensing) for sample in (*drawn, *moved)]


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
def test_final_poses_are_those_of_the_planar_engine_without_new_plans(
    name, monkeypatch
):
    monkeypatch.setattr(placement, "Replanner", Unchanging)
    task = load_task(name)
    task = replace(task, motion=replace(task.motion, recoveries=0))
    plan = planned(task)
    samples = truths_about(task)
    found = batched(plan, truths_of(samples))
    errors, times = [], []
    for i, sample in enumerate(samples):
        arrays = run(replace(plan, task=sample)).arrays
        x, y, yaw = arrays["object_pose"][-1].tolist()
        assert math.dist((x, y), found.poses[i, :2]) < NEAR
        turned = math.remainder(yaw - found.poses[i, 2], 2.0 * math.pi)
        assert abs(turned) < NEAR_YAW
        moving = arrays["phase"] == MOVE
        errors.append(math.dist((x, y), task.goal.position))
        off = np.abs(arrays["tracking_error"][moving, 1]).max()
        assert abs(off - found.off_path[i]) < NEAR_PATH
        times.append(task.motion.control_period * np.count_nonzero(moving))
    assert max(errors) > 5e-3  # by the centres of mass
    assert np.corrcoef(errors, found.position_errors)[0, 1] > 0.999
    assert np.allclose(times, found.times, atol=0.02)


def test_compiled_and_interpreted_runs_are_the_same():
    task = load_task("rear-push-rear")
    plan = planned(task)
    truths = drawn_truths(task, 0, 4)
    first = batched(plan, truths, 3)
    with without_numba():
        second = batched(plan, truths, 3)
    assert np.abs(first.poses - second.poses).max() < 1e-9
    assert (first.ends == second.ends).all()
    more = batched(plan, drawn_truths(task, 0, 6), 3)  # a sample's noise is its own
    assert np.abs(first.poses - more.poses[:4]).max() < 1e-9
    other = batched(plan, truths, 4)
    assert np.abs(first.poses - other.poses).max() > 1e-6  # of other noise


def test_a_tip_that_leaves_the_face_misses():
    task = load_task("rear-push-rear")
    aside = replace(task, contact_friction=0.02, start_error=Pose2(0.0, 0.04, 0.3))
    found = batched(planned(task), truths_of([task, aside]))
    assert found.ends.tolist() == [ARRIVED, LEFT_FACE]
    assert found.reached.tolist() == [True, False]
    rows = list(batched_rows(task, 0, found))
    assert [row["reason"] for row in rows] == ["goal_reached", "the tip left the face"]


def test_a_sweep_in_one_batch_writes_the_rows_of_a_sweep(tmp_path):
    task = load_task("rear-push-rear")
    options = SweepOptions(samples=5, seed=2, batched=True)
    summary = sweep(task, options, tmp_path)
    assert summary["engine"] == "batched"
    assert summary["drawn"] == summary["attempted"] == 5
    assert summary["time_per_sample"] > 0.0
    lines = (tmp_path / "rows.jsonl").read_text().splitlines()
    rows = [json.loads(line) for line in lines]
    assert [row["index"] for row in rows] == list(range(5))
    assert rows[0]["task"] == varied_task(task, 0, 2).name
    assert {row["status"] for row in rows} <= {"reached", "missed"}
    sweep(task, options, tmp_path)  # finished rows stay
    assert len((tmp_path / "rows.jsonl").read_text().splitlines()) == 5


@pytest.mark.parametrize("name", ["press-slide", "parallel-push"])
def test_other_plans_are_refused(name):
    plan = planned(load_task(name))
    truths = truths_of([plan.task])
    with pytest.raises(PushPressSlideError, match="--batched: a plan of "):
        batched(plan, truths)


REFUSED = {
    (
        "--vary",
        "tasks",
    ): "pps: --vary: 'tasks' is not allowed with --batched; allowed: 'truth'",
    (
        "--sample-time",
        "2",
    ): "pps: --sample-time: 2.0 is not allowed with --batched; allowed: 0.0",
}


@pytest.mark.parametrize("words", REFUSED)
def test_options_without_a_batch_are_refused_in_one_line(words, tmp_path):
    command = ["sweep", "rear-push-rear", "--samples", "3", "--batched"]
    out = ["--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, [*command, *out, *words])
    assert result.exit_code == 2
    assert result.stderr.strip() == REFUSED[words]
