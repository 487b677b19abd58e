"""Success by true poses, and what the controller knows of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from pushpressslide.core.sensing import Sensing
from pushpressslide.report.metrics import result
from pushpressslide.report.page import verdict
from pushpressslide.report.page_tables import figures_table

BIASED = Sensing(position_bias=(0.0, 0.004), position_noise=1e-3)
LOOK = {"last_look": {"pose": [0.0, 0.0, 0.0], "spread": [0.0, 0.0]}}


def figures(run: Any, off: float, reason: str, **meta: Any) -> dict[str, Any]:
    """Figures of a run that ends ``off`` [m] from its goal, along the world's y."""
    pose = run.record.arrays["object_pose"] + (0.0, off, 0.0)
    moved = run.with_arrays(object_pose=pose)
    record = replace(moved.record, reason=reason, reason_text="seen", meta=meta)
    return result(moved.task, moved.plan, record, {})


@pytest.fixture
def biased(run: Any) -> Any:
    return replace(run, task=replace(run.task, sensing=BIASED))


@pytest.mark.parametrize(("off", "reached"), [(0.009, True), (0.011, False)])
def test_exact_poses_verify_what_is_true(run: Any, off: float, reached: bool) -> None:
    out = figures(run, off, "goal_reached")
    assert (out["success"], out["verified"]) == (reached, reached)
    assert out["error_beside_bias"] is None


@pytest.mark.parametrize(
    ("off", "reached"),
    [(-0.0139, True), (-0.0141, False), (0.0059, True), (0.0061, False)],
)
def test_a_bias_of_the_camera_is_subtracted(
    biased: Any, off: float, reached: bool
) -> None:
    out = figures(biased, off, "goal_reached", **LOOK)
    assert out["success"] is reached
    assert out["verified"] is True
    assert out["final_position_error"] == pytest.approx(abs(off))
    assert out["error_beside_bias"]["position"] == pytest.approx(abs(off + 0.004))
    assert "without the camera's bias" in out["reason"]["text"]


@pytest.mark.parametrize("code", ["not_verified", "goal_missed"])
@pytest.mark.parametrize(("off", "reached"), [(0.005, True), (0.02, False)])
def test_a_run_that_is_not_verified_may_be_a_success(
    biased: Any, code: str, off: float, reached: bool
) -> None:
    out = figures(biased, off, code, **LOOK)
    assert (out["success"], out["verified"]) == (reached, False)
    assert out["reason"]["code"] == code
    assert "from the goal" in out["reason"]["text"]


def test_a_run_that_stopped_is_no_success_wherever_it_ends(biased: Any) -> None:
    out = figures(biased, 0.0, "goal_missed")
    assert (out["success"], out["verified"]) == (False, False)


def test_without_truth_success_is_unknown(biased: Any) -> None:
    out = figures(biased, 0.02, "goal_reached", measured_only=True, **LOOK)
    assert (out["success"], out["verified"]) == (None, True)
    assert out["reason"]["code"] == "goal_reached"
    assert out["error_beside_bias"] is None


def test_the_page_says_what_is_true_and_what_is_known(biased: Any) -> None:
    assert "<strong>Goal reached</strong>" in verdict(
        figures(biased, 0.0, "goal_reached", **LOOK)
    )
    unsure = verdict(figures(biased, 0.0, "not_verified", **LOOK))
    assert "Goal reached, but not verified" in unsure
    assert 'class="verdict bad"' in unsure
    measured = figures(biased, 0.0, "goal_reached", measured_only=True, **LOOK)
    assert "Goal reached, as measured" in verdict(measured)


def test_the_page_says_that_the_bias_is_subtracted(run: Any, biased: Any) -> None:
    table = figures_table(figures(biased, -0.0139, "goal_reached", **LOOK))
    assert "nothing can see a constant bias" in table
    assert 'class="n ok">9.90 mm' in table
    assert 'class="n ">13.90 mm' in table
    assert "bias" not in figures_table(figures(run, 0.0, "goal_reached"))
