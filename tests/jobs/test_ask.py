"""Top-level Python functions: tasks are checked, and folders are read."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import pushpressslide as pps
from pushpressslide.report.files import save_run
from pushpressslide.report.stages import StageRun

TASK = pps.load_task("rear-push-rear")


def run_of(task: Any) -> pps.Record:
    return pps.run(task, engine="planar")


@pytest.mark.parametrize("ask", [pps.select, pps.plan, run_of])
@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"modes": ("push",)}, "modes"),
        ({"contact_friction": 3.0}, "contact.friction"),
        ({"object": replace(TASK.object, shape=pps.Box((20.0, 0.1, 0.1)))}, "box"),
    ],
)
def test_a_task_that_a_file_could_not_say_is_refused(
    ask: Callable[[Any], object], changes: dict[str, Any], field: str
) -> None:
    with pytest.raises(pps.TaskError, match=field):
        ask(replace(TASK, **changes))


@pytest.mark.parametrize("ask", [pps.select, pps.plan, run_of])
def test_what_is_no_task_is_refused_in_one_line(ask: Callable[[Any], object]) -> None:
    with pytest.raises(pps.TaskError, match="task: 3 is not allowed; allowed: a Task"):
        ask(3)


def test_a_finished_run_is_read_and_reported_by_the_name_of_its_folder(
    tmp_path: Path,
) -> None:
    record = pps.run(TASK, engine="planar")
    stages = [StageRun.alone(record)]
    save_run(tmp_path, record.plan.task, stages, record, record.figures)
    run = pps.load_run(str(tmp_path))
    assert run.record.success
    assert "\n" not in repr(run)
    assert len(repr(run)) < 300
    for folders in (str(tmp_path), tmp_path, [str(tmp_path)]):
        assert pps.report(folders) == tmp_path / "report.html"
    page = pps.report(tmp_path, out=str(tmp_path / "own.html"))
    assert page == tmp_path / "own.html"


def test_report_is_a_function_whatever_was_imported() -> None:
    import pushpressslide.report.page

    assert callable(pps.report)
    assert pushpressslide.report.page.write_report.__doc__


def test_an_object_and_an_arm_say_no_more_than_in_a_file() -> None:
    corner = ((0.0, 0.0), (0.2, 0.0), (0.0, 0.1))
    body = pps.Object(pps.Prism(corner, height=0.05), mass=1.0)
    assert body.center_of_mass == pytest.approx((0.2 / 3.0, 0.1 / 3.0))
    own = pps.Object(body.shape, mass=1.0, center_of_mass=(0.05, 0.02))
    assert own.center_of_mass == (0.05, 0.02)
    assert pps.Robot("panda").base == (0.0, 0.0, 0.0)
