"""Former task fields that now belong to a run's execution: accepted if they state the
default of every run.
"""

from pathlib import Path
from typing import Any

import pytest
import yaml

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.gone import GONE
from pushpressslide.taskfile.load import load_written_task

USUAL = {name: usual for name, (usual, _) in GONE.items()}


def saved(folder: Path, task: str, **motion: Any) -> Path:
    """A task's file with fields of motion as older versions wrote them."""
    data = yaml.safe_load(pps.dump_task(pps.load_task(task)))
    data["motion"].update(motion)
    for leg in data["legs"] or []:
        leg["motion"].update(motion)
    path = folder / "task.yaml"
    path.write_text(yaml.safe_dump(data))
    return path


@pytest.mark.parametrize("task", ["press-slide", "pivot-and-move"])
def test_a_file_with_their_defaults_is_the_same_task(task: str, tmp_path: Path) -> None:
    old = pps.load_task(saved(tmp_path, task, **USUAL))
    assert pps.dump_task(old) == pps.dump_task(pps.load_task(task))


@pytest.mark.parametrize(
    ("field", "value", "place"),
    [
        ("velocity_servo", False, "Execution(servo=False)"),
        ("joint_tracking", 1, "Execution(joint_stiffness=10.0)"),
        ("force_gain", 0.97, "Execution(force_gain=...)"),
        ("fixed_target", True, "FixedTarget"),
    ],
)
def test_another_value_is_refused_with_its_new_place(
    field: str, value: object, place: str, tmp_path: Path
) -> None:
    path = saved(tmp_path, "press-slide", **{field: value})
    with pytest.raises(TaskError) as raised:
        pps.load_task(path)
    assert raised.value.field == f"motion.{field}"
    assert raised.value.value == value
    assert place in str(raised.value)
    with pytest.raises(TaskError, match=f"motion.{field}"):
        pps.load_task("press-slide", [f"motion.{field}={value}"])


@pytest.mark.parametrize("first", range(len(GONE)))
def test_of_several_fields_the_first_of_the_table_is_named(
    first: int, tmp_path: Path
) -> None:
    names = list(GONE)[first:]
    path = saved(tmp_path, "press-slide", **dict.fromkeys(names, "another"))
    with pytest.raises(TaskError) as raised:
        pps.load_task(path)
    assert raised.value.field == f"motion.{names[0]}"


def test_a_field_of_a_leg_is_named_with_its_leg(tmp_path: Path) -> None:
    data = yaml.safe_load(pps.dump_task(pps.load_task("pivot-and-move")))
    data["legs"][-1]["motion"]["force_gain"] = 0.97
    path = tmp_path / "task.yaml"
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(TaskError) as raised:
        pps.load_task(path)
    assert raised.value.field == f"legs[{len(data['legs']) - 1}].motion.force_gain"


def test_the_task_of_a_run_that_is_over_is_read_whatever_it_says(
    tmp_path: Path,
) -> None:
    path = saved(tmp_path, "press-slide", velocity_servo=False, force_gain=0.97)
    assert load_written_task(path).motion == pps.load_task("press-slide").motion
