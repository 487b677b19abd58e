"""Strict reading of YAML to plain data: no duplicate keys, text files only, and errors
with their lines.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from pushpressslide.core.errors import TaskError

MAX_BYTES = 1_000_000
"""Largest size [bytes] of a task file."""


class _Loader(yaml.SafeLoader):
    """Safe loader that refuses duplicate keys, and reads 1e-3 as a number (PyYAML by
    itself reads it as text).
    """

    def construct_mapping(
        self, node: yaml.MappingNode, deep: bool = False
    ) -> dict[Hashable, Any]:
        """Mapping without duplicate keys. Raises on a key that occurs twice."""
        seen: set[Hashable] = set()
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                continue  # refused by the base class
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"duplicate key {key!r}", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep=deep)


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?\.[0-9]+|[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+"),
    list("-+.0123456789"),
)


def _unusable(source: str, reason: str) -> TaskError:
    return TaskError(source, "", source, reason)


def _flat(message: object) -> str:
    return " ".join(str(message).split())[:160]


def parse_yaml(text: str, source: str) -> Any:
    """Plain data of one YAML document.

    Raises:
        TaskError: text that is not YAML, a duplicate key, a value that YAML cannot
        hold; with its line.
    """
    line = ""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        fault = _flat(error.problem or "syntax")
        line = f"line {mark.line + 1}: " if mark else ""
    except (yaml.YAMLError, ValueError) as error:
        fault = _flat(error)
    except RecursionError:
        fault = "nested too deeply"
    raise _unusable(source, f"{line}not valid YAML: {fault}")


def read_yaml(path: Path) -> dict[Any, Any]:
    """Top-level mapping of a YAML file.

    Raises:
        TaskError: a file that cannot be read, is too long, is not UTF-8 text or not
        YAML, and one whose top level is not a mapping.
    """
    source = str(path)
    data = _content(path)
    if len(data) > MAX_BYTES:
        reason = f"longer than {MAX_BYTES} bytes; allowed: a YAML task file"
        raise _unusable(source, reason)
    try:
        parsed = parse_yaml(data.decode("utf-8-sig"), source)
    except UnicodeDecodeError as error:
        reason = f"not UTF-8 text (byte {error.start}); allowed: a YAML file"
        raise _unusable(source, reason) from None
    if parsed is None:
        reason = "the file is empty; allowed: a mapping with the fields of a task"
        raise _unusable(source, reason)
    if not isinstance(parsed, dict):
        top = f"the top level is a {type(parsed).__name__}"
        raise _unusable(source, f"{top}; allowed: a mapping with a task's fields")
    return parsed


def _content(path: Path) -> bytes:
    """Content of a file, truncated one byte beyond the allowed size."""
    allowed = "allowed: the path of a YAML file"
    try:
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        reason = f"no such file; {allowed}"
    except IsADirectoryError:
        reason = f"it is a directory; {allowed}"
    except (OSError, ValueError) as error:
        reason = f"cannot be read ({_flat(getattr(error, 'strerror', None) or error)})"
    raise _unusable(str(path), reason)


Overrides = Mapping[str, Any] | Sequence[str]
"""Fields and values: a mapping, or texts ``field=value`` with the value as YAML."""


def apply_overrides(data: dict[Any, Any], overrides: Overrides) -> None:
    """Set fields of ``data`` in place.

    List items are named by index, as in ``robots.0.model``.

    Raises:
        TaskError: overrides of another form, an empty name, a value that is not YAML,
        an index out of range.
    """
    for path, value in _pairs(overrides):
        source = f"override {_flat(path)[:80]}"
        keys = [key.strip() for key in path.split(".")]
        if not all(keys):
            raise _unusable(source, OVERRIDE)
        holder: Any = data
        for i, key in enumerate(keys[:-1]):
            index = _index(holder, keys[: i + 1], source)
            if isinstance(holder, dict) and holder.get(key) is None:
                holder[key] = {}
            holder = holder[index]
        holder[_index(holder, keys, source)] = value


OVERRIDE = "allowed: field.field=value, such as limits.time=30"


def _pairs(overrides: Any) -> Iterator[tuple[str, Any]]:
    """Yield dotted names of fields with their values. Raises TaskError."""
    if isinstance(overrides, str):
        overrides = [overrides]
    if isinstance(overrides, Mapping):
        yield from ((str(path), value) for path, value in overrides.items())
        return
    texts = list(overrides) if isinstance(overrides, Iterable) else [overrides]
    for override in texts:
        source = f"override {_flat(override)[:80]}"
        path, equals, text = str(override).partition("=")
        if not equals:
            raise _unusable(source, OVERRIDE)
        yield path, parse_yaml(text, source)


def _index(holder: Any, keys: Sequence[str], source: str) -> Any:
    """Last of ``keys`` as an index of its list or mapping."""
    *outer, key = keys
    name = ".".join(keys)
    if isinstance(holder, dict):
        return key
    if not isinstance(holder, list):
        reason = f"{'.'.join(outer)} is a value without fields"
        raise TaskError(source, name, key, reason)
    if not key.isdecimal() or int(key) >= len(holder):
        allowed = f"allowed: an index from 0 to {len(holder) - 1}"
        raise TaskError(source, name, key, allowed)
    return int(key)
