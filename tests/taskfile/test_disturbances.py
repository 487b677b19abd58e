"""Refusals of knocks, in one line that names the field."""

from __future__ import annotations

import pytest
import yaml

from pushpressslide.core.errors import TaskError
from pushpressslide.core.knock import Ball, Knock, Push
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data

PUSH = "push: {force: [5, 0], duration: 0.3}"
REFUSED = {
    "two beginnings": (f"{{time: 1, share: 0.2, {PUSH}}}", r"\[0\]: .* time or share"),
    "no beginning": (f"{{{PUSH}}}", r"\[0\]: .* time or share"),
    "no cause": ("{time: 1}", r"\[0\]: .* ball or push"),
    "two causes": (f"{{time: 1, ball: {{}}, {PUSH}}}", r"\[0\]: .* ball or push"),
    "two balls": (
        "{time: 1, ball: {}}, {time: 9, ball: {}}",
        r"\[1\]\.ball: .* one ball",
    ),
    "no force": ("{time: 1, push: {duration: 1}}", r"\[0\]\.push\.force"),
    "past the goal": ("{share: 1.5, ball: {}}", r"\[0\]\.share: 1\.5"),
}


@pytest.mark.parametrize(("knocks", "message"), REFUSED.values(), ids=list(REFUSED))
def test_a_knock_is_refused_by_its_field(knocks: str, message: str) -> None:
    with pytest.raises(TaskError, match=r"disturbances" + message):
        load_task("rear-push-rear", [f"disturbances=[{knocks}]"])


def test_knocks_are_refused_with_several_goals() -> None:
    with pytest.raises(TaskError, match=r"disturbances: .* goals"):
        load_task("swap", [f"disturbances=[{{time: 1, {PUSH}}}]"])


def test_knocks_are_written_and_read() -> None:
    knocks = f"[{{share: 0.4, ball: {{side: right}}}}, {{time: 1, {PUSH}}}]"
    task = load_task("rear-push-rear", [f"disturbances={knocks}"])
    assert task.disturbances == (
        Knock(share=0.4, ball=Ball("right")),
        Knock(time=1.0, push=Push((5.0, 0.0), 0.3)),
    )
    again = task_from_data(yaml.safe_load(dump_task(task)), "again")
    assert again.disturbances == task.disturbances
