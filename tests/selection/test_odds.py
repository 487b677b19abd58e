"""Odds of plans over truths within the belief's errors."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import pushpressslide as pps
from pushpressslide.cli import app
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.selection.odds import Odds, odds

LEVEL = (
    "press-slide",
    "press-slide-pivot",
    "rear-push-rear",
    "parallel-push",
    "orthogonal-push",
    "bimanual-slide",
)
# no load but the planned one is allowed: the press cannot be made harder
WEAK_PRESS = ("limits.normal_force=9", "motion.press_force=8")


def odds_under(plan: Plan, seed: int = 0, **errors: float) -> Odds:
    """Odds of a plan whose belief may be wrong by ``errors``."""
    belief = replace(plan.task.belief, **errors)
    plan = replace(plan, task=replace(plan.task, belief=belief))
    return odds(plan.queries, plan.segments, seed)


@pytest.mark.parametrize("name", LEVEL)
def test_a_safe_plan_arrives_surely_if_the_belief_is_right(
    shipped_plan: Callable[[str], Plan], name: str
) -> None:
    assert odds_under(shipped_plan(name)).share == 1.0


def test_odds_of_a_press_with_little_margin_fall_with_the_friction_error() -> None:
    plan = pps.plan(pps.load_task("press-slide", list(WEAK_PRESS)))
    found = [odds_under(plan, friction_error=error) for error in (0.0, 0.4, 0.5)]
    assert found[0].share == 1.0
    assert found[0].share > found[1].share > found[2].share
    assert found[2].slip == found[2].truths - found[2].arrivals


def test_a_press_slips_for_the_truths_that_coulomb_says() -> None:
    plan = pps.plan(pps.load_task("press-slide", list(WEAK_PRESS)))
    task = plan.task
    load = plan.contacts[0].load
    scene = task.scene
    drag = scene.max_friction(load)
    use = drag / (scene.contact_friction * load)
    # the worst truth: more drag, less friction of the tip
    error = (1.0 - use) / (1.0 + use)
    assert odds_under(plan, friction_error=0.99 * error).share == 1.0
    assert odds_under(plan, friction_error=1.2 * error).slip > 0


def test_a_push_whose_axis_may_leave_its_cone_is_off_its_path(
    shipped_plan: Callable[[str], Plan],
) -> None:
    found = odds_under(shipped_plan("rear-push-rear"), center_error=0.06)
    assert found.off_path > 0.1 * found.truths


def test_a_seed_gives_its_odds_again_and_another_seed_others() -> None:
    plan = pps.plan(pps.load_task("press-slide", list(WEAK_PRESS)))
    first = odds_under(plan, friction_error=0.5)
    assert first == odds_under(plan, friction_error=0.5)
    assert first != odds_under(plan, seed=1, friction_error=0.5)


def test_a_slope_is_refused() -> None:
    task = pps.load_task("incline-slide")
    with pytest.raises(PushPressSlideError, match=r"support\.kind incline is not"):
        odds(task.queries(), ())


def test_the_command_states_the_odds_of_each_stage(tmp_path: Path) -> None:
    line = ["plan", "rear-push-rear", "--odds", "--json", "--out", str(tmp_path)]
    result = CliRunner().invoke(app, line)
    assert result.exit_code == 0, result.stderr
    (stage,) = json.loads(result.stdout)["stages"]
    assert stage["odds"]["share"] == 1.0
    assert stage["odds"]["truths"] == 500
    assert stage["odds"]["interval"] == pytest.approx((0.9924, 1.0), abs=1e-4)


def test_risk_puts_choices_with_poor_odds_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from pushpressslide.selection import odds as module

    def stated(queries: object, segments: tuple[str, ...]) -> Odds:
        """Odds that a choice's only segment names."""
        return Odds(100, 100 - int(segments[0]), 0, 0)

    monkeypatch.setattr(module, "odds", stated)
    task = pps.load_task("press-slide", ["motion.risk=0.1"])
    quickest_first = [
        Choice("press_slide", segments=(percent,), time=float(i))  # type: ignore[arg-type]
        for i, percent in enumerate(("70", "92", "100", "80"))
    ]
    ranked = module.ranked_by_odds(task.queries(), quickest_first)
    assert [choice.segments[0] for choice in ranked] == ["92", "100", "80", "70"]
    plain = pps.load_task("press-slide")
    assert module.ranked_by_odds(plain.queries(), quickest_first) == quickest_first
