"""The fields of docs/task-file.md and docs/task-fields.csv, made from the schema.

Renew them with ``python -m pushpressslide.taskfile.docs docs/task-file.md``.
"""

from __future__ import annotations

import csv
import io
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


TITLES = ("field", "allowed", "default", "meaning")


def _rows(fields: Mapping[str, Field], path: str) -> Iterator[tuple[str, ...]]:
    """Yield a row for every field: name, allowed values, default and meaning."""
    for key, field in fields.items():
        name = path + key
        inner = field.kind.fields or {}
        words = field.kind.words.replace(f" with the fields {', '.join(inner)}", "")
        yield name, words, _default(field.absent), field.meaning
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
    return json.dumps(default)


def every_field() -> str:
    """Table of all fields as comma-separated values."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(TITLES)
    table.writerows(_rows(SCHEMA.fields or {}, ""))
    return text.getvalue()


def _sections() -> Iterator[str]:
    """Yield the rows of a table of the file's sections."""
    yield "| section | meaning | its fields |"
    yield "|---|---|---|"
    for name, field in (SCHEMA.fields or {}).items():
        inner = ", ".join(f"`{key}`" for key in field.kind.fields or {})
        yield f"| `{name}` | {field.meaning} | {inner} |"


def with_table(page: str) -> str:
    """Page with its generated table of sections renewed.

    Raises ValueError for a page without the two marks.
    """
    head, start, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not start or not end:
        raise ValueError(f"the page lacks {BEGIN!r} or {END!r}")
    table = "\n".join(_sections())
    return f"{head}{BEGIN}\n\n{table}\n\n{END}{tail}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    write_whole(target, with_table(target.read_text(encoding="utf-8")))
    write_whole(target.with_name("task-fields.csv"), every_field())
