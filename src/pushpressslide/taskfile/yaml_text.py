"""YAML text to plain data, strictly: no duplicate keys, no file that is not text,
errors with their line.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import Any

import yaml

from pushpressslide.core.errors import TaskError

MAX_BYTES = 1_000_000
"""Longest task file that is read [bytes]."""


class _Loader(yaml.SafeLoader):
    """Safe loader that refuses duplicate keys and reads 1e-3 as a number (PyYAML alone
    makes it text).
    """

    def construct_mapping(
        self, node: yaml.MappingNode, deep: bool = False
    ) -> dict[Hashable, Any]:
        seen: set[Hashable] = set()
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, Hashable) and key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"duplicate key {key!r}", key_node.start_mark
                )
            seen.add(key if isinstance(key, Hashable) else None)
        return super().construct_mapping(node, deep=deep)


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?\.[0-9]+|[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+"),
    list("-+.0123456789"),
)


def parse_yaml(text: str, source: str) -> Any:
    """Return the plain data of one YAML document.

    Raises:
        TaskError: text that is not YAML, a duplicate key, a value that YAML cannot
        hold; with its line.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f"line {mark.line + 1}: " if mark is not None else ""
        raise TaskError(
            source,
            "",
            text,
            f"{line}not valid YAML: {_flat(error.problem or 'syntax')}",
        ) from None
    except (yaml.YAMLError, ValueError) as error:
        raise TaskError(source, "", text, f"not valid YAML: {_flat(error)}") from None
    except RecursionError:
        raise TaskError(source, "", text, "not valid YAML: nested too deeply") from None


def _flat(message: object) -> str:
    return " ".join(str(message).split())[:160]


def read_yaml(path: Path) -> dict[Any, Any]:
    """Return the top-level mapping of a YAML file.

    Raises:
        TaskError: a file that is missing, a directory, unreadable, too long, not UTF-8
        text, empty, not
            YAML, or whose top level is not a mapping.
    """
    source = str(path)
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise TaskError(
            source, "", source, "no such file; allowed: the path of a YAML file"
        ) from None
    except IsADirectoryError:
        raise TaskError(
            source, "", source, "it is a directory; allowed: the path of a YAML file"
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise TaskError(
            source, "", source, f"cannot be read ({_flat(reason)})"
        ) from None
    if len(data) > MAX_BYTES:
        raise TaskError(
            source,
            "",
            source,
            f"longer than {MAX_BYTES} bytes; allowed: a YAML task file",
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TaskError(
            source,
            "",
            source,
            f"not UTF-8 text (byte {error.start}); allowed: a YAML file",
        ) from None
    parsed = parse_yaml(text, source)
    if parsed is None:
        raise TaskError(
            source,
            "",
            source,
            "the file is empty; allowed: a mapping with the fields of a task",
        )
    if not isinstance(parsed, dict):
        raise TaskError(
            source,
            "",
            source,
            f"the top level is a {type(parsed).__name__}; allowed: a mapping with a "
            "task's fields",
        )
    return parsed


def apply_overrides(data: dict[Any, Any], overrides: Sequence[str]) -> None:
    """Set fields of ``data`` in place.

    Each override is ``a.b=c``; list items are named by index, as in
    ``robots.0.model=iiwa7``.

    Raises:
        TaskError: an override without ``=``, an empty name, a value that is not YAML,
        an index out of range.
    """
    for override in overrides:
        source = f"--set {_flat(override)[:80]}"
        path, equals, text = override.partition("=")
        keys = [key.strip() for key in path.split(".")]
        if not equals or not all(keys):
            raise TaskError(
                source,
                "",
                override,
                "allowed: field.field=value, such as limits.time=30",
            )
        value = parse_yaml(text, source)
        place: Any = data
        for i, key in enumerate(keys):
            last = i == len(keys) - 1
            name = ".".join(keys[: i + 1])
            if isinstance(place, list):
                if not key.isdecimal() or int(key) >= len(place):
                    raise TaskError(
                        source,
                        name,
                        key,
                        f"allowed: an index from 0 to {len(place) - 1}",
                    )
                index: Any = int(key)
            elif isinstance(place, dict):
                index = key
                if not last and place.get(key) is None:
                    place[key] = {}
            else:
                raise TaskError(
                    source, name, key, f"{'.'.join(keys[:i])} is a value without fields"
                )
            if last:
                place[index] = value
            else:
                place = place[index]
