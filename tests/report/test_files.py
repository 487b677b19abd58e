"""A run on disk is read back unchanged, or not at all."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core import whole_file
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Restart
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.files import (
    load_run,
    record_from_bytes,
    record_to_bytes,
    save_run,
)
from pushpressslide.report.metrics import result
from pushpressslide.report.plan_files import (
    choices_from_dict,
    plan_from_dict,
    plan_to_dict,
    write_plans,
)
from pushpressslide.report.stages import StageRun

NEEDS = Refusal("load", "needs 60 N, limits.normal_force is 40 N")
REFUSED = Choice("press_slide", refusal=NEEDS)
PASSED = Choice("press_slide", refusal=Refusal(SKIPPED, "not evaluated"))


def save(run, folder):
    choices = (run.choice, REFUSED, PASSED)
    stage = StageRun.alone(replace(run.record, plan=run.plan), choices)
    figures = result(run.task, run.plan, run.record)
    save_run(folder, run.task, [stage], run.record, figures)
    return folder


def same_record(a, b):
    assert set(a.arrays) == set(b.arrays)
    for name, values in a.arrays.items():
        np.testing.assert_array_equal(values, b.arrays[name], err_msg=name)
    for field in (
        "reason",
        "reason_text",
        "engine",
        "seed",
        "wall_time",
        "modes",
        "meta",
    ):
        assert getattr(a, field) == getattr(b, field), field


def test_a_record_survives_its_file(arm_run):
    force = arm_run.record.arrays["measured_force"].copy()
    force[3] = np.nan
    record = arm_run.with_arrays(measured_force=force).record
    same_record(record, record_from_bytes(record_to_bytes(record), record.plan))


def test_the_same_record_gives_the_same_bytes(run):
    assert record_to_bytes(run.record) == record_to_bytes(run.record)


def test_a_plan_survives_its_file(run):
    data = json.loads(
        json.dumps(
            plan_to_dict(run.plan, (run.choice, REFUSED, PASSED)), allow_nan=False
        )
    )
    plan = plan_from_dict(data, run.task)
    assert plan == run.plan
    assert choices_from_dict(data) == (run.choice, REFUSED, PASSED)


def test_a_plan_of_two_segments_survives_its_file(pressed):
    data = json.loads(
        json.dumps(
            plan_to_dict(pressed.plan, (pressed.choice, REFUSED)), allow_nan=False
        )
    )
    plan = plan_from_dict(data, pressed.task)
    assert plan == pressed.plan
    assert [type(segment.path) for segment in plan.segments] == [ArcPath, TwistPath]
    assert choices_from_dict(data) == (pressed.choice, REFUSED)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (
            lambda data: data["segments"][0]["drive"].update(point=[0.0]),
            "shorter|longer",
        ),
        (lambda data: data.update(segments=[]), "a plan without segments"),
    ],
)
def test_a_plan_with_a_part_too_few_is_refused(pressed, change, what):
    data = plan_to_dict(pressed.plan)
    change(data)
    with pytest.raises(ValueError, match=what):
        plan_from_dict(data, pressed.task)


def test_a_saved_run_of_two_segments_gives_the_same_figures_again(pressed, tmp_path):
    back = load_run(save(pressed, tmp_path / "run"))
    assert back.plan.segments[1].path == pressed.plan.segments[1].path
    assert result(back.task, back.plan, back.record, {}) == result(
        pressed.task, pressed.plan, pressed.record, {}
    )


def test_a_saved_run_gives_the_same_figures_again(run, tmp_path):
    back = load_run(save(run, tmp_path / "run"))
    same_record(run.record, back.record)
    assert back.plan.segments[0].path == run.plan.segments[0].path
    assert back.choices[1:] == (REFUSED, PASSED)
    assert result(back.task, back.plan, back.record, {}) == result(
        run.task, run.plan, run.record, {}
    )
    assert back.result == json.loads(json.dumps(result(run.task, run.plan, run.record)))


@pytest.mark.parametrize(
    "name", ["task.yaml", "plan.json", "record.npz", "result.json"]
)
def test_a_folder_that_lacks_a_file_is_refused_with_the_files_name(run, tmp_path, name):
    folder = save(run, tmp_path / "run")
    (folder / name).unlink()
    with pytest.raises(PushPressSlideError, match=name):
        load_run(folder)


@pytest.mark.parametrize("name", ["plan.json", "record.npz", "result.json"])
def test_a_damaged_file_is_refused_with_the_files_name(run, tmp_path, name):
    folder = save(run, tmp_path / "run")
    data = (folder / name).read_bytes()
    (folder / name).write_bytes(data[: len(data) // 2])
    with pytest.raises(PushPressSlideError, match=name):
        load_run(folder)


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(PushPressSlideError, match="no such folder"):
        load_run(tmp_path / "nowhere")


def test_a_run_that_was_cut_off_while_saving_never_looks_whole(
    run, tmp_path, monkeypatch
):
    folder = save(run, tmp_path / "run")
    replaced = []

    def stop_at_the_record(source, target):
        if str(target).endswith("record.npz"):
            raise OSError("disk full")
        replaced.append(target)
        return put(source, target)

    put = os.replace
    monkeypatch.setattr(whole_file.os, "replace", stop_at_the_record)
    with pytest.raises(OSError, match="disk full"):
        save(run, folder)
    assert replaced
    assert not (folder / "result.json").exists()
    assert not list(folder.glob(".*.part*"))
    with pytest.raises(PushPressSlideError, match=r"result\.json"):
        load_run(folder)


def test_a_failed_write_leaves_the_old_file_alone(tmp_path, monkeypatch):
    path = write_whole(tmp_path / "a" / "file.txt", "old")
    monkeypatch.setattr(
        whole_file.os, "replace", lambda *_: (_ for _ in ()).throw(OSError("no"))
    )
    with pytest.raises(OSError, match="no"):
        write_whole(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in path.parent.iterdir()] == ["file.txt"]


def test_write_plans_leaves_data_and_picture(run, tmp_path):
    stage = StageRun.alone(run.record, (run.choice, REFUSED))
    data, picture = write_plans(run.task, [stage], tmp_path)
    (stored,) = json.loads(data.read_text())["stages"]
    assert stored["choices"][1]["reason"] == REFUSED.reason
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_run_of_another_schema_is_refused_with_its_file_named_once(run, tmp_path):
    folder = save(run, tmp_path / "run")
    path = folder / "plan.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "schema": 1}))
    with pytest.raises(
        PushPressSlideError, match="schema 1, this version reads 7 and 8"
    ) as refused:
        load_run(folder)
    assert str(refused.value).count("plan.json") == 1


def test_plans_of_the_version_before_that_stand_in_each_other_are_read(run, tmp_path):
    folder = save(run, tmp_path / "run")
    restart = Restart(
        WorldState({OBJECT: Pose2(0.45, 0.0, 0.1)}), 0, (0.0, 0.0), 0.3, None
    )
    task = run.plan.task
    plan = run.plan
    for _ in range(2):
        task = task.resumed(restart)
        plan = plan.followed(Plan(task, plan.segments, restart))
    older = None
    for data in map(plan_to_dict, reversed((replace(plan, later=()), *plan.later))):
        del data["later"]
        older = {**data, "again": older}
    older |= {"schema": 7, "task": run.task.name}
    (folder / "plan.json").write_text(json.dumps(older))
    assert load_run(folder).plan == plan
