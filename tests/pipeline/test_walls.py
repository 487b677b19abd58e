"""Walls in the task file: what they say, what must fit together, and that a dumped one loads to the same."""

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.pipeline.task_file import dump_task, load_task, task_from_data
from pushpressslide.pipeline.task_yaml import read_yaml


def test_the_shipped_wall_is_where_its_file_says_and_loads_again(tmp_path) -> None:
    task = load_task("press-fit")
    support = task.support
    assert support.frame == SupportFrame.of_wall((0.86, 0.0, 0.81), 3.141592653589793)
    assert support.opening is not None
    assert (support.opening.size, support.opening.depth) == ((0.83, 0.28), 0.15)
    assert task.bases[0] == pytest.approx((0.5, -0.61, 0.86))  # the left arm: to the left, below, in front
    path = tmp_path / "again.yaml"
    path.write_text(dump_task(task))
    data = read_yaml(path)
    assert task_from_data(data, "again") == task


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("support.pose=null", r"support\.pose.*it is missing"),
        ("support.opening.depth=0.25", r"support\.opening\.depth.*less than the object's height"),
        ("support.opening.size=[0.79, 0.28]", r"goal.*outline is within it"),
        ("obstacles=[]", r"start.*it would fall before the arms press it"),
        ("start.y=-0.02", r"start.*on a ledge"),
        ("obstacles.0.movable=true", r"obstacles\[0\]\.movable.*it would fall"),
        ("start={x: 0, y: 0, yaw_deg: 90}", r"start.*lies in support\.opening"),
        ("support.opening.depth=-1", r"support\.opening\.depth"),
    ],
)
def test_what_does_not_fit_is_refused(override, says) -> None:
    with pytest.raises(TaskError, match=says):
        load_task("press-fit", [override])
