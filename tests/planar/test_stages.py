"""Several bodies on the planar engine: stages one after the other without a reset."""

from __future__ import annotations

import json
import math
import shutil
import zipfile
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task
from pushpressslide.jobs.monitor import Output
from pushpressslide.jobs.run import run_task
from pushpressslide.jobs.stages import StageOptions, StageRunner
from pushpressslide.jobs.tiers import drawn_world
from pushpressslide.report.files import load_run
from pushpressslide.report.metrics import result as measure
from pushpressslide.report.page import write_report
from pushpressslide.report.stages import StageRun
from pushpressslide.taskfile.load import load_task

SWAP = load_task("swap")
OLDER = Path(__file__).parent.parent / "older_runs"


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    """Return the result of a run of the swap, and its folder."""
    folder = tmp_path_factory.mktemp("swap")
    return run_task(SWAP, engine="planar", out=Output(folder)), folder


def stages_of(task: Task) -> tuple[StageRunner, list[StageRun]]:
    runner = StageRunner(task, StageOptions("planar"))
    return runner, list(runner.run())


def test_every_body_ends_at_its_goal(finished: tuple[dict[str, Any], Path]) -> None:
    result, _ = finished
    assert result["success"]
    assert result["reason"]["code"] == "goal_reached"
    assert [stage["reached"] for stage in result["stages"]] == [True] * 3
    worst = max(body["position_error"] for body in result["bodies"].values())
    assert result["final_position_error"] == worst < 0.002
    assert result["final_yaw_error"] < math.radians(0.5)
    assert result["bodies"]["other-cube"]["displacement"] == pytest.approx(
        0.2, abs=2e-3
    )


def test_nothing_jumps_from_a_stage_to_the_next(
    finished: tuple[dict[str, Any], Path],
) -> None:
    _, folder = finished
    arrays = load_run(folder).record.arrays
    (last,) = np.nonzero(np.diff(arrays["stage"]))
    assert len(last) == 2
    for name in ("pose_object", "pose_other-cube", "tip_position"):
        step = np.abs(arrays[name][last + 1] - arrays[name][last])
        assert step.max() <= 1e-9, name
    assert np.diff(arrays["time"]) == pytest.approx(0.004)


def test_the_object_pose_is_that_of_the_body_of_the_stage(
    finished: tuple[dict[str, Any], Path],
) -> None:
    result, folder = finished
    arrays = load_run(folder).record.arrays
    for number, stage in enumerate(result["stages"]):
        own = arrays["stage"] == number
        assert (
            arrays["object_pose"][own] == arrays[f"pose_{stage['body']}"][own]
        ).all()


def test_times_of_the_stages_follow_each_other(
    finished: tuple[dict[str, Any], Path],
) -> None:
    result, _ = finished
    times = [stage["time"] for stage in result["stages"]]
    for (_, end), (begin, _) in pairwise(times):
        assert begin == pytest.approx(end + 0.004)
    spans = [end - begin for begin, end in times]
    assert result["duration"] == pytest.approx(sum(spans))


def test_a_run_comes_back_from_its_folder(
    finished: tuple[dict[str, Any], Path],
) -> None:
    result, folder = finished
    back = load_run(folder)
    assert back.result == result
    assert back.task == SWAP
    assert back.begun == back.stages
    assert [run.reached for run in back.begun] == [True] * 3
    for number, (run, stage) in enumerate(
        zip(back.begun, result["stages"], strict=True)
    ):
        assert run.stage.body == stage["body"]
        assert list(run.record.modes) == stage["modes"]
        assert run.record.seed == number
        assert run.choices


def test_the_record_of_a_stage_is_cut_out_of_that_of_the_run(
    finished: tuple[dict[str, Any], Path],
) -> None:
    _, folder = finished
    _, runs = stages_of(SWAP)
    for cut, run in zip(load_run(folder).begun, runs, strict=True):
        assert cut.plan == run.plan
        assert cut.state.poses == run.state.poses
        assert cut.record.reason == run.record.reason
        assert set(cut.record.arrays) == set(run.record.arrays)
        for name, values in run.record.arrays.items():
            if not name.startswith("tick_"):
                found = cut.record.arrays[name]
                atol = 1e-12 if name == "time" else 0.0
                np.testing.assert_allclose(found, values, 0.0, atol, err_msg=name)


def test_figures_of_a_stage_are_those_of_its_record(
    finished: tuple[dict[str, Any], Path],
) -> None:
    result, folder = finished
    for run, stage in zip(load_run(folder).begun, result["stages"], strict=True):
        again = measure(run.plan.task, run.plan, run.record)
        for name in ("path_rms_error", "max_normal_force", "contacts", "planned"):
            assert json.loads(json.dumps(again[name])) == stage["figures"][name], name


@pytest.mark.parametrize("name", ["plan.json", "record.npz", "result.json"])
def test_a_damaged_run_in_stages_is_refused_with_its_file(
    finished: tuple[dict[str, Any], Path], tmp_path: Path, name: str
) -> None:
    _, folder = finished
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    path = copy / name
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(PushPressSlideError, match=name):
        load_run(copy)


def test_the_page_shows_every_stage(finished: tuple[dict[str, Any], Path]) -> None:
    _, folder = finished
    page = (folder / "report.html").read_text("utf-8")
    for number in (1, 2, 3):
        assert f"Stage {number}: " in page
        assert (folder / "plots" / f"stage-{number}-path.png").is_file()
        assert (folder / f"plan-{number}.png").is_file()
    assert "other-cube" in page


@pytest.mark.long
def test_the_same_run_gives_the_same_record() -> None:
    first, second = (pps.run(SWAP, engine="planar") for _ in range(2))
    for name, values in first.arrays.items():
        if not name.startswith("tick_"):
            assert np.array_equal(values, second.arrays[name], equal_nan=True), name


def test_a_body_that_is_not_where_it_was_planned_is_planned_for_anew() -> None:
    """The object starts off by more than the tolerance, and is moved second."""
    off = replace(SWAP.start, x=0.012, y=0.0)
    beyond = replace(SWAP.goals[1], pose=replace(SWAP.goals[1].pose, x=0.45, y=-0.25))
    task = replace(SWAP, goals=(SWAP.goals[0], beyond), start_error=off)
    runner, runs = stages_of(task)
    assert runner.lacking is None
    assert [run.stage.body for run in runs] == ["other-cube", "object"]
    assert [run.anew for run in runs] == [False, True]
    assert [run.reached for run in runs] == [True, True]


def test_a_stage_that_fails_ends_the_run(tmp_path: Path) -> None:
    """There is time for the first two stages only."""
    task = replace(SWAP, limits=replace(SWAP.limits, time=17.0))
    result = run_task(task, engine="planar", out=Output(tmp_path))
    assert not result["success"]
    assert result["reason"]["code"] == "time_limit"
    assert [stage["reached"] for stage in result["stages"]] == [True, False, False]
    assert result["stages"][2]["time"] is None
    back = load_run(tmp_path)
    assert len(back.begun) == 2
    assert len(back.stages) == 3


def test_a_run_that_stops_between_stages_keeps_those_that_have_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran = StageRunner._run

    def killed(self: StageRunner, number: int) -> StageRun | None:
        if number == 1:
            raise KeyboardInterrupt
        return ran(self, number)

    monkeypatch.setattr(StageRunner, "_run", killed)
    with pytest.raises(KeyboardInterrupt):
        run_task(SWAP, engine="planar", out=Output(tmp_path))
    assert not (tmp_path / "result.json").exists()
    with np.load(tmp_path / "record.npz") as stored:
        assert (stored["stage"] == 0.0).all()
    stages = json.loads((tmp_path / "plan.json").read_text())["stages"]
    assert ["began" in stage for stage in stages] == [True, False, False]


@pytest.mark.parametrize("stages", [1, 3])
def test_a_folder_of_the_version_before_is_read(stages: int, tmp_path: Path) -> None:
    """Older folders have no list of stages in a run of one, and those of several lie in
    folders of their own.
    """
    name = "rear-push-rear" if stages == 1 else "swap"
    with zipfile.ZipFile(OLDER / f"{name}.zip") as stored:
        stored.extractall(tmp_path)
    back = load_run(tmp_path)
    assert len(back.begun) == len(back.result["stages"]) == stages
    assert [run.reached for run in back.begun] == [True] * stages
    page = write_report(tmp_path).read_text("utf-8")
    assert "Goal reached" in page
    assert ("Stage 3: " in page) == (stages == 3)


def test_a_body_that_is_believed_otherwise_reaches_its_goal() -> None:
    other = replace(SWAP.obstacles[0], believed_friction=0.2, believed_mass=0.6)
    _, runs = stages_of(replace(SWAP, obstacles=(other,)))
    own = next(run for run in runs if run.stage.body == "other-cube")
    assert own.plan.task.scene.support.friction == 0.2
    assert own.plan.task.support.friction == 0.3
    assert own.reached


def test_a_stage_keeps_the_centre_of_mass_that_it_was_planned_with() -> None:
    """What an earlier one has told of friction is used; the true centre is not known."""
    world = drawn_world(load_task("swap", ["truth=tier3"]), 0, "planar")
    runner = StageRunner(world, StageOptions("planar"))
    first = runner.planned[0]
    body = first.stage.body
    told = replace(first.solution.plan.task.belief, support_friction=0.77)
    runner._learnt[body] = replace(told, center_of_mass=None, center_error=0.0)
    belief = runner._as_it_is(first).task.belief
    planned = first.solution.plan.task.belief
    assert belief.support_friction == 0.77
    assert belief.center_of_mass == planned.center_of_mass is not None
    assert belief.center_error == planned.center_error
