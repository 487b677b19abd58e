"""The task file as a JSON Schema, for editors and for programs that write task files."""

from __future__ import annotations

from typing import Any

from pushpressslide.taskfile.schema import SCHEMA


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of the plain data of a task file.

    It holds types, ranges, names and defaults. What fields must satisfy together, such
    as bodies that do not overlap, only loading a task checks.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A task of pushpressslide",
        **SCHEMA.json,
    }
