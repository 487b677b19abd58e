"""Identified values written into the text of a task file, with comments and layout
kept.
"""

from __future__ import annotations

from collections.abc import Mapping

import yaml

from pushpressslide.core.errors import TaskError
from pushpressslide.taskfile.load import task_from_data
from pushpressslide.taskfile.yaml_text import parse_yaml

KEY = "belief"


def with_belief(text: str, values: Mapping[str, float | None], source: str) -> str:
    """Text of a task file with ``values`` as fields of ``belief``, in the file's units.

    Existing fields get the new values, and missing fields are added. Raises TaskError
    if the text is not a valid task before or after the change.
    """
    data = parse_yaml(text, source)
    if not isinstance(data, dict):
        raise TaskError(source, "", source, "allowed: a mapping with a task's fields")
    written = text
    for name, value in values.items():
        shown = "null" if value is None else f"{value:.6g}"
        written = _with_field(written, name, shown, source)
    expected = {**data, KEY: {**(data.get(KEY) or {}), **dict(values)}}
    made = parse_yaml(written, source)
    if _rounded(made) != _rounded(expected):
        reason = "its layout cannot be edited; write belief on lines of its own"
        raise TaskError(source, KEY, data.get(KEY), reason)
    task_from_data(made, source)
    return written


def _rounded(data: object) -> object:
    """Plain data with numbers rounded to six digits for writing."""
    if isinstance(data, dict):
        return {key: _rounded(value) for key, value in data.items()}
    if isinstance(data, float):
        return float(f"{data:.6g}")
    return data


def _with_field(text: str, name: str, value: str, source: str) -> str:
    """Text of the file with one field of ``belief`` set."""
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    if not isinstance(root, yaml.MappingNode):
        raise TaskError(source, "", source, "allowed: a mapping with a task's fields")
    section = _value(root, KEY)
    if section is None:
        return _appended(text, root, f"{KEY}: {{{name}: {value}}}")
    if not isinstance(section, yaml.MappingNode):  # null or empty
        start, end = _span(section)
        gap = "" if text[:start].endswith((" ", "\n")) else " "
        return f"{text[:start]}{gap}{{{name}: {value}}}{text[end:]}"
    field = _value(section, name)
    if field is not None:
        start, end = _span(field)
        return f"{text[:start]}{value}{text[end:]}"
    return _inserted(text, section, f"{name}: {value}")


def _value(mapping: yaml.MappingNode, key: str) -> yaml.Node | None:
    """Node of a field's value."""
    for name, value in mapping.value:
        if name.value == key:
            node: yaml.Node = value
            return node
    return None


def _span(node: yaml.Node) -> tuple[int, int]:
    """Start and end index of a node in its text."""
    return node.start_mark.index, node.end_mark.index


def _appended(text: str, root: yaml.MappingNode, line: str) -> str:
    """Text with one more line at the end of its mapping."""
    if root.flow_style:
        return _inserted(text, root, line)
    whole = text if text.endswith("\n") else text + "\n"
    return f"{whole}{line}\n"


def _inserted(text: str, section: yaml.MappingNode, field: str) -> str:
    """Text with one more field at the end of a mapping."""
    if section.flow_style:
        end = _span(section)[1] - 1  # position of its brace
        filled = text[:end].rstrip()
        comma = ", " if section.value else ""
        return f"{filled}{comma}{field}{text[len(filled) :]}"
    first, _ = section.value[0]
    indent = " " * first.start_mark.column
    _, last = section.value[-1]
    line_end = text.find("\n", _last_index(last))
    if line_end < 0:
        return f"{text}\n{indent}{field}\n"
    return f"{text[:line_end]}\n{indent}{field}{text[line_end:]}"


def _last_index(node: yaml.Node) -> int:
    """Index after the last character of a value, without any blank lines or comments
    behind a block.
    """
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _last_index(last[1] if isinstance(last, tuple) else last)
    return max(_span(node)[1] - 1, _span(node)[0])
