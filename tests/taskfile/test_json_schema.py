"""The JSON Schema of a task file allows what the reader allows, field by field."""

import copy
import json
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import pytest
import yaml

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.json_schema import json_schema
from pushpressslide.taskfile.load import dump_task, load_task, shipped_tasks
from pushpressslide.taskfile.place import Place
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.yaml_text import read_yaml

TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "boolean": (bool,),
    "integer": (int,),
    "number": (int, float),
    "null": (type(None),),
}
ANNOTATIONS = {"$schema", "title", "description", "default"}


def valid(schema: Mapping[str, Any], value: Any) -> bool:
    """Return whether a value meets a JSON Schema, for the keywords that ours has."""
    return all(
        check(schema, key, value)
        for key in schema
        if key not in ANNOTATIONS | {"items"}
    )


def check(schema: Mapping[str, Any], key: str, value: Any) -> bool:
    wanted = schema[key]
    match key:
        case "type":
            is_flag = isinstance(value, bool) and wanted != "boolean"
            return isinstance(value, TYPES[wanted]) and not is_flag
        case "enum":
            return value in wanted
        case "not":
            return not valid(wanted, value)
        case "anyOf" | "oneOf":
            count = sum(valid(part, value) for part in wanted)
            return count == 1 if key == "oneOf" else count > 0
        case "pattern":
            return not isinstance(value, str) or bool(re.search(wanted, value))
        case "minimum" | "exclusiveMinimum" | "maximum" | "exclusiveMaximum":
            return not isinstance(value, int | float) or bounded(key, wanted, value)
        case "minItems" | "maxItems":
            return not isinstance(value, list) or listed(schema, value)
        case "required":
            return not isinstance(value, dict) or set(wanted) <= set(value)
        case "properties":
            return not isinstance(value, dict) or all(
                valid(part, value[name])
                for name, part in wanted.items()
                if name in value
            )
        case "additionalProperties":
            return not isinstance(value, dict) or set(value) <= set(
                schema["properties"]
            )
    raise AssertionError(f"unknown keyword {key}")


def bounded(key: str, bound: float, value: float) -> bool:
    return {
        "minimum": value >= bound,
        "exclusiveMinimum": value > bound,
        "maximum": value <= bound,
        "exclusiveMaximum": value < bound,
    }[key]


def listed(schema: Mapping[str, Any], value: list[Any]) -> bool:
    enough = schema["minItems"] <= len(value) <= schema.get("maxItems", math.inf)
    return enough and all(valid(schema["items"], item) for item in value)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    items: Any = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def changed(data: Any, path: tuple[Any, ...], value: object) -> Any:
    out = copy.deepcopy(data)
    holder = out
    for key in path[:-1]:
        holder = holder[key]
    holder[path[-1]] = value
    return out


@pytest.mark.parametrize("name", shipped_tasks())
def test_every_shipped_task_and_its_dump_meet_the_schema(name: str) -> None:
    schema = json_schema()
    assert valid(schema, read_yaml(shipped_tasks()[name]))
    assert valid(schema, yaml.safe_load(dump_task(load_task(name))))


def test_the_schema_is_plain_json_of_the_draft_that_it_names() -> None:
    schema = json_schema()
    assert json.loads(json.dumps(schema)) == schema
    assert schema["$schema"].endswith("2020-12/schema")


@pytest.mark.parametrize("name", ["tool-use", "press-fit", "pivot-and-move"])
def test_schema_and_reader_refuse_the_same_values(name: str) -> None:
    schema = json_schema()
    data = read_yaml(shipped_tasks()[name])
    values: list[object] = [None, True, "x", "../x", -1, 0, 0.3, 1e9, [], [1, 2], {}]
    refused = 0
    for path in places(data):
        if (
            "shape" in path or "box" in path
        ):  # exactly one of them is given: a later check of the reader
            continue
        for value in values:
            wrong = changed(data, path, value)
            try:
                SCHEMA.read(wrong, Place("test"))
            except TaskError:
                refused += 1
                assert not valid(schema, wrong), (path, value)
            else:
                assert valid(schema, wrong), (path, value)
    assert refused > 100


@pytest.mark.parametrize(
    "shape",
    [
        {},
        {"box": None},
        {"box": [0.1, 0.1, 0.1], "cylinder": {"radius": 0.1, "height": 0.1}},
    ],
)
def test_a_shape_that_is_none_or_two_does_not_meet_the_schema(shape: object) -> None:
    data = read_yaml(shipped_tasks()["rear-push-left"])
    assert not valid(json_schema(), changed(data, ("object", "shape"), shape))
    one = {"cylinder": {"radius": 0.1, "height": 0.1}, "box": None}
    assert valid(json_schema(), changed(data, ("object", "shape"), one))
