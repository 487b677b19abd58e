"""The table of fields in docs/task-file.md, made from the schema.

Renew it by ``python -m pushpressslide.taskfile.docs docs/task-file.md``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pushpressslide.core.field_spec import REQUIRED
from pushpressslide.core.whole_file import write_whole
from pushpressslide.taskfile.kinds import Field
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.shapes import NAMES

BEGIN = "<!-- fields: begin (generated) -->"
END = "<!-- fields: end -->"


def _rows(fields: Mapping[str, Field], path: str) -> Iterator[str]:
    """Yield the row of every field: name, what is allowed, default and meaning."""
    for key, field in fields.items():
        name = path + key
        inner = field.kind.fields or {}
        words = field.kind.words.replace(f" with the fields {', '.join(inner)}", "")
        yield f"| `{name}` | {words} | {_default(field.absent)} | {field.meaning} |"
        if "list" in words:
            name += "[i]"
        again = (path == "obstacles[i]." and key in NAMES) or (path and key == "motion")
        if not again:  # an obstacle's shape and a leg's motion: the same fields again
            yield from _rows(inner, f"{name}.")


def _default(default: Any) -> str:
    if default in ({}, []):
        return "optional"
    if default is REQUIRED:
        return "required"
    return f"`{json.dumps(default)}`"


def with_table(page: str) -> str:
    """Return a page with its generated table renewed.

    Raises ValueError for a page without the two marks.
    """
    head, start, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not start or not end:
        raise ValueError(f"the page lacks {BEGIN!r} or {END!r}")
    titles = ["| field | allowed | default | meaning |", "|---|---|---|---|"]
    table = "\n".join([*titles, *_rows(SCHEMA.fields or {}, "")])
    return f"{head}{BEGIN}\n\n{table}\n\n{END}{tail}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    write_whole(target, with_table(target.read_text(encoding="utf-8")))
