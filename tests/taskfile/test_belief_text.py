"""Identified values are written into a task file's text, and its comments stay."""

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.belief_text import with_belief
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data
from pushpressslide.taskfile.yaml_text import parse_yaml

TASK = """\
# weighed on Monday
name: lab-box
support: {kind: table, friction: 0.5}   # a guess
object:
  shape: {box: [0.16, 0.10, 0.08]}
  mass: 0.9    # kg
contact: {friction: 0.6}
start: {x: 0.45, y: -0.20, yaw_deg: 0}
goal: {x: 0.60, y: 0.10, yaw_deg: 20}
tolerance: {position: 0.01, yaw_deg: 2}
robots: [{model: hand, base: {x: 0, y: 0, z: 0.3, yaw_deg: 0}}]
"""
VALUES = {"support_friction": 0.31234567, "rho": None, "friction_error": 0.02}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", "belief: {support_friction: 0.312346, rho: null, friction_error: 0.02}\n"),
        (
            "belief: {}  # none\n",
            "belief: {support_friction: 0.312346, rho: null, friction_error: 0.02}  # none\n",
        ),
        (
            "belief:   # later\n",
            "belief: {support_friction: 0.312346, rho: null, friction_error: 0.02}   # later\n",
        ),
        (
            "belief: {rho: 0.06, mass: 0.8}  # old\n",
            "belief: {rho: null, mass: 0.8, support_friction: 0.312346, "
            "friction_error: 0.02}  # old\n",
        ),
        (
            "belief:\n  # by hand\n  rho: 0.06   # m\n  mass: 0.8  # kg\n\n# the end\n",
            "belief:\n  # by hand\n  rho: null   # m\n  mass: 0.8  # kg\n"
            "  support_friction: 0.312346\n  friction_error: 0.02\n\n# the end\n",
        ),
        (
            "belief:\n    center_of_mass:\n      - 0.0\n      - 0.01  # m\nseed_note: 1\n",
            None,
        ),
    ],
)
def test_the_fields_are_set_and_all_else_stays(before: str, after: str | None) -> None:
    if after is None:
        with pytest.raises(TaskError, match="seed_note"):
            with_belief(TASK + before, VALUES, "task.yaml")
        return
    written = with_belief(TASK + before, VALUES, "task.yaml")
    assert written == TASK + after
    belief = task_from_data(parse_yaml(written, "task.yaml"), "task.yaml").belief
    assert (belief.support_friction, belief.rho) == (0.312346, None)
    assert belief.friction_error == 0.02


def test_a_belief_in_the_middle_keeps_what_follows() -> None:
    head, tail = TASK.split("contact:")
    text = (
        f"{head}belief:\n  center_of_mass:\n    - 0.0\n    - 0.01  # m\ncontact:{tail}"
    )
    written = with_belief(text, VALUES, "task.yaml")
    assert "    - 0.01  # m\n  support_friction: 0.312346\n" in written
    assert written.endswith(TASK.split("contact:")[1])


@pytest.mark.parametrize("name", ["rear-push-rear", "press-slide", "swap"])
def test_a_shipped_task_takes_a_belief(name: str) -> None:
    text = dump_task(load_task(name))
    written = with_belief(text, VALUES, "task.yaml")
    belief = task_from_data(parse_yaml(written, "task.yaml"), "task.yaml").belief
    assert belief.support_friction == 0.312346


def test_a_value_that_a_task_cannot_have_is_refused() -> None:
    with pytest.raises(TaskError, match=r"belief\.rho"):
        with_belief(TASK, {"rho": -1.0}, "task.yaml")
    with pytest.raises(TaskError, match="line 1"):
        with_belief("a: [", {"rho": 0.1}, "task.yaml")
