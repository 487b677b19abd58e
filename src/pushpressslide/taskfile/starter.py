"""The task file written by ``pps new``: a minimal task, with all other fields as
comments with their defaults.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator

from pushpressslide.core.field_spec import REQUIRED
from pushpressslide.taskfile.kinds import Field
from pushpressslide.taskfile.schema import SCHEMA

WIDTH = 88
BEGIN = """\
# A task: `pps plan {file}` shows what would be done, `pps run {file}` does it.
# Lengths in metres, masses in kilograms, forces in newtons, times in seconds; angles in
# degrees where a key says _deg. Poses are those of the object's own frame on the table.
# Where the rest is said: docs/task-file.md.

name: {name}
description: a box is brought to the other side of the table

object:
  shape: {{box: [0.14, 0.10, 0.06]}} # length, width, height; or prism, cylinder, mesh, ...
  mass: 0.8
start: {{x: 0.50, y: 0.20, yaw_deg: 0}}
goal: {{x: 0.55, y: -0.20, yaw_deg: 60}}

robots:
  - {{model: panda}} # or iiwa7, hand (a tip without an arm), or a model of your own

# What follows with a "# " may be left out; take that away to change a default.
"""
GIVEN = frozenset({"name", "description", "object", "start", "goal", "robots"})
"""Sections at the beginning of the file, which are complete."""
STATED = {"support": ("friction", 0.3), "contact": ("friction", 0.7)}
"""Fields of other sections that a new file contains, with their values."""


def starter(name: str, file: str) -> str:
    """Text of a new task file ``file`` for a task ``name``."""
    lines = [BEGIN.format(name=name, file=file)]
    for key, field in (SCHEMA.fields or {}).items():
        if key not in GIVEN:
            lines += ["", *_commented(key, field)]
    return "\n".join(lines) + "\n"


def _commented(key: str, field: Field) -> Iterator[str]:
    """Yield the lines of one field of the file, as comments."""
    inner = field.kind.fields
    yield from _words(field.meaning, "## ")
    if inner is None or field.absent != {}:
        yield from _words(f"takes {field.kind.words}", "## ")
        yield f"# {key}: {json.dumps(field.absent)}"
        return
    stated, value = STATED.get(key, ("", None))
    yield f"{key}:" if stated else f"# {key}:"
    for name, part in inner.items():
        if part.absent is REQUIRED:
            continue
        yield from _words(f"{part.meaning}; {part.kind.words}", "#   ## ")
        if name == stated:
            yield f"  {name}: {value}"
            continue
        default = "{}" if part.absent == {} else json.dumps(part.absent)
        yield f"#   {name}: {default}"


def _words(text: str, before: str) -> list[str]:
    """Text wrapped into lines that start with ``before``."""
    return textwrap.wrap(text, WIDTH, initial_indent=before, subsequent_indent=before)
