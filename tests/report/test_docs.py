"""The documents name every field and every array."""

from pathlib import Path

import pytest

from pushpressslide.core.record import Record
from pushpressslide.report.metrics import result

DOCS = Path(__file__).parents[2] / "docs"


def keys(value):
    for name, inner in value.items():
        yield name
        if isinstance(inner, dict) and name != "bodies":
            yield from keys(inner)


def test_every_field_of_the_result_is_documented(arm_run):
    text = (DOCS / "results.md").read_text("utf-8")
    missing = [
        n
        for n in keys(result(arm_run.task, arm_run.plan, arm_run.record))
        if f"`{n}`" not in text
    ]
    assert not missing


def test_every_array_of_the_record_is_documented(arm_run):
    text = (DOCS / "results.md").read_text("utf-8")
    general = {"body_post": "body_<name>"}
    names = [general.get(n, n.replace("_0", "_<i>")) for n in arm_run.record.arrays]
    shown = ("`{}`", 'arrays["{}"]')  # in a table or in a program
    assert not [n for n in names if not any(s.format(n) in text for s in shown)]


@pytest.mark.parametrize(
    "name", ["reason", "engine", "seed", "wall_time", "modes", "meta", "reason_text"]
)
def test_every_other_field_of_a_record_is_documented(name):
    assert name in Record.__slots__
    assert f"`{name}`" in (DOCS / "results.md").read_text("utf-8")
