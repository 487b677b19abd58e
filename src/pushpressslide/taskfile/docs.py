"""The table of fields in docs/task-file.md, made from the schema.

Renew it by ``python -m pushpressslide.taskfile.docs docs/task-file.md``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

from pushpressslide.taskfile.field import REQUIRED, Field
from pushpressslide.taskfile.schema import MOTION, SCHEMA

BEGIN = "<!-- fields: begin (generated) -->"
END = "<!-- fields: end -->"


def _rows(field: Field, path: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, what is allowed, default and meaning of every field below ``field``."""
    for key, inner in (field.fields or {}).items():
        name = f"{path}.{key}" if path else key
        if inner.default is REQUIRED:
            default = "required"
        elif inner.fields and inner.default in ({}, []):
            default = "optional"
        else:
            default = f"`{json.dumps(inner.default)}`"
        words = (
            inner.allowed.split(" with the fields")[0]
            if inner.fields
            else inner.allowed
        )
        words += " or null" if inner.fields and inner.default is None else ""
        yield name, words, default, inner.help
        if not (path and inner.fields is MOTION):  # in a leg: the same fields again
            yield from _rows(inner, name + ("[i]" if inner.kind == "sections" else ""))


def field_table() -> str:
    """Return the Markdown table of every field of a task file."""
    lines = ["| field | allowed | default | meaning |", "|---|---|---|---|"]
    lines += [
        f"| `{name}` | {words} | {default} | {help} |"
        for name, words, default, help in _rows(SCHEMA, "")
    ]
    return "\n".join(lines)


def with_table(page: str) -> str:
    """Return a page with its generated table renewed; raises ValueError for a page
    without the two marks.
    """
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the page lacks {BEGIN!r} or {END!r}")
    return f"{head}{BEGIN}\n\n{field_table()}\n\n{END}{tail}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(with_table(target.read_text(encoding="utf-8")), encoding="utf-8")
