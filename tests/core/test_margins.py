"""Table of margins: reasons and units of all margins, and the distances that follow
from them.
"""

import ast
import inspect
import math
from dataclasses import fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core import margins
from pushpressslide.core.margins import ARM, ArmMargins

SPEEDS = st.floats(0.005, 0.2)
LENGTHS = st.floats(0.0, 2.0)


def undocumented(body: list[ast.stmt]) -> list[str]:
    """Return the names assigned in ``body`` without a text below them."""
    out = []
    for i, node in enumerate(body):
        if not isinstance(node, ast.Assign | ast.AnnAssign):
            continue
        below = body[i + 1] if i + 1 < len(body) else None
        value = below.value if isinstance(below, ast.Expr) else None
        if not (isinstance(value, ast.Constant) and isinstance(value.value, str)):
            out.append(ast.unparse(node))
    return out


def test_every_margin_has_its_reason() -> None:
    module = ast.parse(inspect.getsource(margins))
    arm = next(node for node in module.body if isinstance(node, ast.ClassDef))
    assert arm.name == "ArmMargins"
    assert undocumented(module.body) == []
    assert undocumented(arm.body) == []


def test_every_margin_of_the_arm_has_a_unit_and_is_positive() -> None:
    for one in fields(ARM):
        assert one.metadata["unit"] in ("m", "s", "N", "m/s", "N/m", "1/s", "1")
        assert getattr(ARM, one.name) > 0.0


@given(LENGTHS, SPEEDS, st.floats(0.0, 0.5))
def test_a_look_ahead_is_never_shorter_than_the_arm_corrects(
    length: float, speed: float, least: float
) -> None:
    found = ARM.look_ahead(length, speed, least)
    assert found >= ARM.shortest(speed)
    assert found <= max(ARM.longest_look_ahead, ARM.shortest(speed))


def test_a_look_ahead_is_a_share_of_the_length_where_the_arm_allows_it() -> None:
    assert ARM.look_ahead(0.2, 0.05) == pytest.approx(0.07)
    assert ARM.look_ahead(0.2, 0.05, min_length=0.09) == pytest.approx(0.09)
    assert ARM.look_ahead(math.inf, 0.05) == ARM.longest_look_ahead


def test_a_slow_arm_looks_farther_ahead() -> None:
    slow = ArmMargins(response=1.6)
    assert slow.look_ahead(0.01, 0.05) == 2.0 * ARM.look_ahead(0.01, 0.05)


@given(st.floats(0.01, 1.0), st.floats(0.01, 1.0), st.floats(0.2, 5.0))
def test_what_a_plan_may_take_scales_with_the_object(
    left: float, radius: float, k: float
) -> None:
    way = margins.longest(margins.DETOUR, left, radius)
    assert margins.longest(margins.DETOUR, k * left, k * radius) == pytest.approx(
        k * way
    )
    assert way > left


def test_a_press_is_lost_sooner_than_a_push() -> None:
    assert ARM.loss_time("top") < ARM.loss_time("side")
