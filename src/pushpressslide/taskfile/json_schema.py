"""The task file as a JSON Schema, for editors and for programs that write task files."""

from __future__ import annotations

from typing import Any

from pushpressslide.taskfile.schema import SCHEMA


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the plain data of a task file.

    It contains types, ranges, names and defaults. Conditions between fields, for
    example that bodies do not overlap, are checked only when a task is loaded.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A task of pushpressslide",
        **SCHEMA.json,
    }
