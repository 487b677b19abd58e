"""Notebook displays of a plan, a record and a result: a picture, a page that plays, and
a table, without external resources.
"""

import json
import re
from dataclasses import replace
from html import unescape

import pytest

import pushpressslide as pps


@pytest.fixture(scope="module")
def record() -> pps.Record:
    return pps.run(pps.load_task("rear-push-rear"), engine="planar")


def test_a_plan_is_a_picture(record: pps.Record) -> None:
    shown = record.plan._repr_html_()
    assert shown.count('src="data:image/png;base64,iVBOR') == 1
    assert "rear_push; 13.3 s" in shown


def test_a_result_is_its_outcome_and_a_table_of_figures(record: pps.Record) -> None:
    result = pps.result(record)
    shown = result._repr_html_()
    assert "Goal reached" in shown
    error = 1e3 * result["final_position_error"]
    assert f">{error:.2f} mm<" in shown
    # still plain data
    assert json.loads(json.dumps(result))["success"] is True


def test_a_record_plays_its_run_inside_the_page(record: pps.Record) -> None:
    shown = record._repr_html_()
    (page,) = re.findall(r'<iframe srcdoc="(.*?)"', shown, re.DOTALL)
    inside = unescape(page)
    assert inside.startswith("<!doctype html>")
    assert "rear-push-rear" in inside
    assert not re.search(r"(src|href)=.https?://", inside)
    assert "Goal reached" in shown
    assert "<summary>Figures</summary>" in shown


def test_a_record_that_was_not_measured_shows_what_it_has(record: pps.Record) -> None:
    shown = replace(record, figures={})._repr_html_()
    assert "Record(goal_reached" in shown
    assert "<iframe" in shown
    assert "Figures" not in shown


def test_a_record_without_ticks_has_no_replay(record: pps.Record) -> None:
    empty = {name: values[:0] for name, values in record.arrays.items()}
    shown = replace(record, arrays=empty, figures={})._repr_html_()
    assert "<iframe" not in shown


def test_several_bodies_in_turn_have_no_replay_from_above() -> None:
    shown = pps.run(pps.load_task("swap"), engine="planar")._repr_html_()
    assert "Goal reached" in shown
    assert "<iframe" not in shown
