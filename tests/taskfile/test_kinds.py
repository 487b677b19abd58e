"""The values that a field accepts agree with its JSON Schema."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile import kinds
from pushpressslide.taskfile.place import Place

PLACE = Place("a.yaml", "mass")
ENDS = {"[0, 2]": (True, True), "(0, 2]": (False, True), "[0, 2)": (True, False)}


def taken(kind: kinds.Kind, value: object) -> bool:
    """Return whether ``kind`` reads ``value``."""
    try:
        kind.read(value, PLACE)
    except TaskError:
        return False
    return True


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("within", ENDS)
def test_an_end_in_a_round_bracket_is_open(within: str, whole: bool) -> None:
    kind = kinds.number("", within, whole=whole)
    assert (taken(kind, 0), taken(kind, 2)) == ENDS[within]
    assert taken(kind, 1)
    assert not taken(kind, -1)
    assert not taken(kind, 3)


@pytest.mark.parametrize("within", ENDS)
def test_the_schema_has_the_same_ends(within: str) -> None:
    schema = kinds.number("m", within).json
    assert ("minimum" in schema, "maximum" in schema) == ENDS[within]
    assert ("exclusiveMinimum" in schema) != ("minimum" in schema)
    assert ("exclusiveMaximum" in schema) != ("maximum" in schema)


@pytest.mark.parametrize(
    "value", [True, "1", None, math.nan, math.inf, 10**400, [1.0], {}]
)
def test_no_number_of_a_range_is_anything_else(value: object) -> None:
    assert not taken(kinds.number("m", "[-1e300, 1e300]"), value)


def test_a_whole_number_has_no_fraction_and_stays_whole() -> None:
    kind = kinds.number("", "[0, inf)", whole=True)
    assert not taken(kind, 1.0)
    assert isinstance(kind.read(3, PLACE), int)
    assert isinstance(kinds.number("", "[0, inf)").read(3, PLACE), float)


def test_the_first_wrong_field_of_a_section_is_the_one_refused() -> None:
    mass = kinds.Field(kinds.number("kg", "(0, 10]"), "mass")
    section = kinds.section({"first": mass, "second": mass}, dict)
    with pytest.raises(TaskError, match="first"):
        section.read({"first": -1.0}, PLACE)
    with pytest.raises(TaskError, match=r"second.*missing"):
        section.read({"first": 1.0}, PLACE)
    with pytest.raises(TaskError, match="unknown field"):
        section.read({"first": -1.0, "third": 1.0}, PLACE)


def test_a_section_encodes_what_it_decodes() -> None:
    angle = kinds.number("deg", "[-180, 180]")
    section = kinds.section(
        {"yaw_deg": kinds.Field(angle, "yaw")}, dict, lambda data: data
    )
    plain = section.read({"yaw_deg": 30}, PLACE)
    data = section.decode(plain)
    assert data == {"yaw": math.radians(30.0)}
    assert section.encode(data) == plain
