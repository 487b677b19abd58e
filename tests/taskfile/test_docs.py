"""The documentation of the task file is the schema."""

from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from pushpressslide.core.task import Motion
from pushpressslide.taskfile.docs import every_field, with_table
from pushpressslide.taskfile.load import task_from_data
from pushpressslide.taskfile.schema import SCHEMA

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "task-file.md"
RENEW = "renew it: python -m pushpressslide.taskfile.docs docs/task-file.md"


def test_the_table_of_sections_is_that_of_the_schema() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert with_table(text) == text, RENEW


def test_the_table_of_fields_is_that_of_the_schema() -> None:
    text = (DOCS / "task-fields.csv").read_text(encoding="utf-8")
    assert every_field() == text, RENEW


def test_every_field_of_a_motion_is_in_the_schema() -> None:
    assert SCHEMA.fields is not None
    assert set(SCHEMA.fields["motion"].kind.fields or ()) == {
        field.name for field in fields(Motion)
    }


def test_the_example_of_the_page_loads() -> None:
    example = PAGE.read_text(encoding="utf-8").split("```yaml\n")[1].split("```")[0]
    assert task_from_data(yaml.safe_load(example), "example").name == "rear-push-rear"


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="lacks"):
        with_table("# A page")
