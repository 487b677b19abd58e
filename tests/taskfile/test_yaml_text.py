"""YAML text to plain data, strictly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.yaml_text import (
    MAX_BYTES,
    apply_overrides,
    parse_yaml,
    read_yaml,
)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("a: 1\nb: 2\na: 3", "line 3: not valid YAML: duplicate key 'a'"),
        ("null: 1\nnull: 2", "line 2: not valid YAML: duplicate key None"),
        ("null: 1\n? [a]\n: 2", "not valid YAML: found unhashable key"),
        ("? {a: 1}\n: 2", "line 1: not valid YAML: found unhashable key"),
        ("a: [1", "line 1: not valid YAML: "),
        ("a: 2026-13-45", "not valid YAML: "),
        ("[" * 5000, "not valid YAML: nested too deeply"),
    ],
)
def test_text_that_is_no_plain_data_is_refused_in_one_line(
    text: str, fault: str
) -> None:
    with pytest.raises(TaskError) as refused:
        parse_yaml(text, "here")
    message = str(refused.value)
    assert message.startswith("here: ")
    assert fault in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "number"),
    [("1e-3", 1e-3), ("-2E+2", -200.0), (".5", 0.5), ("+.5e1", 5.0), ("3", 3)],
)
def test_numbers_are_read_as_people_write_them(text: str, number: float) -> None:
    parsed = parse_yaml(text, "here")
    assert parsed == number
    assert type(parsed) is type(number)


def test_keys_of_a_merged_mapping_may_be_said_again() -> None:
    text = "a: &a {x: 1, y: 2}\nb: {<<: *a, x: 3}"
    assert parse_yaml(text, "here")["b"] == {"x": 3, "y": 2}


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (b"", "the file is empty"),
        (b"- 1", "the top level is a list"),
        (b"a: \xff", "not UTF-8 text (byte 3)"),
        (b"#" * (MAX_BYTES + 1), "longer than"),
    ],
)
def test_a_file_that_is_no_mapping_is_refused(
    tmp_path: Path, data: bytes, fault: str
) -> None:
    path = tmp_path / "task.yaml"
    path.write_bytes(data)
    with pytest.raises(TaskError) as refused:
        read_yaml(path)
    assert str(refused.value).startswith(f"{path}: {fault}")


def test_a_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    path = tmp_path / "task.yaml"
    path.write_bytes("\ufeffname: a".encode())
    assert read_yaml(path) == {"name": "a"}


@pytest.mark.parametrize(
    ("override", "changed"),
    [
        ("a.x=5", {"a": {"x": 5}, "b": [{"c": 2}]}),
        ("b.0.c=[1, 2]", {"a": {"x": 1}, "b": [{"c": [1, 2]}]}),
        ("n.m=1e-3", {"a": {"x": 1}, "b": [{"c": 2}], "n": {"m": 1e-3}}),
        ("a = null", {"a": None, "b": [{"c": 2}]}),
    ],
)
def test_an_override_changes_one_field(override: str, changed: dict[str, Any]) -> None:
    data: dict[Any, Any] = {"a": {"x": 1}, "b": [{"c": 2}]}
    apply_overrides(data, [override])
    assert data == changed


@pytest.mark.parametrize(
    ("override", "fault"),
    [
        ("a.x", "allowed: field.field=value"),
        ("a..x=1", "allowed: field.field=value"),
        ("b.1.c=1", "allowed: an index from 0 to 0"),
        ("b.first.c=1", "allowed: an index from 0 to 0"),
        ("a.x.y=1", "a.x is a value without fields"),
        ("a.x=[", "not valid YAML"),
    ],
)
def test_an_override_that_fits_nothing_is_refused(override: str, fault: str) -> None:
    with pytest.raises(TaskError, match="override") as refused:
        apply_overrides({"a": {"x": 1}, "b": [{"c": 2}]}, [override])
    assert fault in str(refused.value)
