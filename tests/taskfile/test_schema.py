"""The tree of fields is that of the data: each field once, and none forgotten."""

import math
from dataclasses import dataclass, field, fields
from typing import Any

import pytest

from pushpressslide.core import task
from pushpressslide.core.errors import TaskError
from pushpressslide.core.field_spec import REQUIRED, field_spec, setting
from pushpressslide.taskfile import schema
from pushpressslide.taskfile.kinds import Kind, degrees, nullable, number
from pushpressslide.taskfile.place import Place

DERIVED = {
    "Limits.planned_share",
    "Robot.base_yaw",  # within base
    "Task.dares",
    "Task.source",
    "ToolUse.body",  # within goal
    "ToolUse.goal",
    "ToolUse.straight",
}
SECTIONS = (
    task.Belief,
    task.Leg,
    task.Limits,
    task.Motion,
    task.ObjectModel,
    task.Obstacle,
    task.Opening,
    task.Robot,
    task.Sensing,
    task.Support,
    task.Task,
    task.Tolerance,
    task.ToolUse,
)


@pytest.mark.parametrize("section", SECTIONS)
def test_every_field_of_the_data_says_what_the_file_has_of_it(section: Any) -> None:
    silent = {
        f"{section.__name__}.{field.name}"
        for field in fields(section)
        if "entry" not in field.metadata
    }
    assert silent <= DERIVED


@dataclass(frozen=True)
class Crane:
    """Data that no task has: a new field needs its dataclass alone."""

    height: float = field(metadata=field_spec("of the hook", "m", "(0, 3]"))
    swing: float = setting(math.radians(5.0), "of the load", "deg", "[0, 90)")
    lamp: bool = setting(False, "whether it is on")
    load: tuple[float, float] | None = setting(None, "where it is", "m", "[-1, 1]")


def crane() -> Kind:
    return schema._section(Crane)


def test_a_field_is_read_decoded_and_written_from_its_metadata_alone() -> None:
    plain = crane().read({"height": 2, "load": [0, 1]}, Place("file"))
    assert plain == {"height": 2.0, "swing_deg": 5.0, "lamp": False, "load": (0.0, 1.0)}
    data = crane().decode(plain)
    assert data == Crane(2.0, math.radians(5.0), False, (0.0, 1.0))
    assert crane().encode(data) == {**plain, "load": [0.0, 1.0]}


@pytest.mark.parametrize(
    ("plain", "message"),
    [
        ({}, "file: height: None is not allowed; it is missing; allowed: a finite"),
        ({"height": 0}, "height: 0 is not allowed; allowed: a finite number [m] in (0"),
        ({"height": 1, "swing_deg": 90}, "swing_deg: 90 is not allowed; allowed: a"),
        ({"height": 1, "lamp": 0}, "lamp: 0 is not allowed; allowed: true or false"),
        ({"height": 1, "lod": 0}, "lod: 'lod' is not allowed; unknown field; did you"),
        ({"height": 1, "load": [0, 2]}, "load[1]: 2 is not allowed; allowed: a finite"),
    ],
)
def test_a_refusal_says_file_field_value_and_what_is_allowed(
    plain: dict[str, Any], message: str
) -> None:
    with pytest.raises(TaskError) as error:
        crane().read(plain, Place("file"))
    assert message in str(error.value)


def test_a_section_may_be_left_out_exactly_if_none_of_its_fields_is_needed() -> None:
    assert crane().absent is REQUIRED
    assert schema._section(task.Motion).absent == {}
    assert nullable(crane()).absent is None


@pytest.mark.parametrize(
    "value", [float("nan"), float("inf"), 10**400, True, "1", None]
)
def test_what_is_no_finite_number_is_refused(value: object) -> None:
    with pytest.raises(TaskError, match="a finite number"):
        number("m", "[0, 1]").read(value, Place("file", "x", "a finite number"))


@pytest.mark.parametrize(
    ("within", "ends"), [("[0, 1]", 2), ("(0, 1]", 1), ("(0, 1)", 0)]
)
def test_an_end_of_a_range_belongs_to_it_if_its_bracket_is_square(
    within: str, ends: int
) -> None:
    accepted = 0
    for value in (0, 1):
        try:
            accepted += number("", within).read(value, Place("file")) == value
        except TaskError:
            continue
    assert accepted == ends


@pytest.mark.parametrize("angle", [0.0, 30.0, 33.3, -179.99, 1e-7, 123.456789])
def test_degrees_give_the_radians_back(angle: float) -> None:
    assert degrees(math.radians(angle)) == pytest.approx(angle, abs=1e-12)
    assert math.radians(degrees(math.radians(angle))) == math.radians(angle)
