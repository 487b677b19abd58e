"""Identification of the virtual axle during the motion, against motions made by the
model.
"""

import math
import random

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Sensing
from pushpressslide.core.twist_path import integrate
from pushpressslide.identification.online import (
    WINDOW,
    WINDOW_WAY,
    AxleEstimate,
    AxleIdentifier,
    AxleState,
    window_of,
)
from pushpressslide.mechanics.press_axle import Press

DT = 0.004


def seen(
    axle: float,
    reach: float,
    drag: float,
    angle: float,
    predicted: AxleEstimate,
    lever: float,
    noise=0.0,
):
    """Parameters identified over 3 s of a steady turn about an axle, with matching
    force and motion.
    """
    rng = random.Random(0)
    identifier = AxleIdentifier(0.3, predicted, lever)
    state = AxleState()
    pose = Pose2(0.1, 0.2, 0.5)
    v = 0.03
    w = v * math.tan(angle) / math.copysign(reach, lever)
    # the axle moves along the heading axis at v: the CoM is ``axle`` behind it
    along = v
    across = -w * axle
    c = math.cos(0.3)
    s = math.sin(0.3)
    rate = (c * along - s * across, s * along + c * across, w)
    size = drag / math.sqrt(
        1.0 + abs(lever) / predicted.effective_wheelbase * math.sin(angle) ** 2
    )
    force = (size * math.cos(0.3 + angle), size * math.sin(0.3 + angle))
    for k in range(round(3.0 / DT)):
        measured = Pose2(
            pose.x + rng.gauss(0, noise), pose.y + rng.gauss(0, noise), pose.yaw
        )
        state = identifier.step(state, k * DT, measured, force)
        pose = integrate(pose, rate, DT)
    return identifier.identified(state)


@pytest.mark.parametrize("lever", [0.05, -0.05])
def test_axle_reach_and_drag_are_found(lever: float) -> None:
    predicted = AxleEstimate(axle=-0.4, effective_wheelbase=0.5, drag=3.0)
    found = seen(-0.05, 0.15, 4.0, math.radians(50.0), predicted, lever)
    assert found is not None
    assert found.axle == pytest.approx(-0.05, abs=0.01)
    assert found.effective_wheelbase == pytest.approx(0.15, rel=0.1)
    assert found.drag == pytest.approx(4.0, rel=0.05)


def test_a_prediction_that_is_not_contradicted_stands() -> None:
    predicted = AxleEstimate(axle=-0.05, effective_wheelbase=0.2, drag=3.0)
    assert seen(-0.09, 0.2, 3.0, math.radians(50.0), predicted, 0.05) is None


def test_straight_motion_says_nothing() -> None:
    predicted = AxleEstimate(axle=-0.4, effective_wheelbase=0.5, drag=3.0)
    assert seen(-0.05, 0.15, 4.0, math.radians(0.2), predicted, 0.05) is None


def test_estimates_stay_within_bounds() -> None:
    predicted = AxleEstimate(axle=-0.4, effective_wheelbase=0.01, drag=3.0)
    found = seen(0.3, 0.5, 60.0, math.radians(60.0), predicted, 0.05)
    assert found is not None
    assert found.axle <= -0.4 + 6.0 * 0.01 + 1e-12
    assert found.effective_wheelbase <= 0.06 + 1e-12
    assert found.drag <= 18.0 + 1e-9


def test_rho_of_an_exciting_motion_is_the_exact_models() -> None:
    """At 60 degrees the axle of the paper's bar gives rho^2 / d from the moved centre
    of pressure.
    """
    press = Press(
        ObjectModel(Box((0.6, 0.2, 0.1)), 0.3, (0.0, 0.0)), 0.3, (0.2, 0.0), 8.0
    )
    angle = math.radians(60.0)
    ahead, reach = press.steered(angle, backward=False)
    axle = press.cop[0] + ahead
    found = seen(
        axle, reach, 3.3, angle, AxleEstimate(-0.5, 0.6, 3.3), press.lever, noise=2e-4
    )
    assert found is not None
    exact = math.sqrt(reach * press.lever)
    got = math.sqrt(found.effective_wheelbase * press.lever)
    assert got == pytest.approx(exact, rel=0.1)
    assert found.axle == pytest.approx(axle, abs=0.02)


def at_rest_under(force: float, state: AxleState | None = None) -> AxleState:
    """State of the identifier after an object has rested for 2 s under a ``force`` [N]."""
    predicted = AxleEstimate(axle=-0.1, effective_wheelbase=0.15, drag=3.0)
    identifier = AxleIdentifier(0.0, predicted, 0.05)
    state = state or AxleState()
    for k in range(round(2.0 / DT)):
        state = identifier.step(state, k * DT, Pose2(), (force, 0.0))
    return state


def test_what_holds_an_object_that_rests_is_at_least_the_force_on_it() -> None:
    assert at_rest_under(3.6).drag == pytest.approx(3.6)


def test_a_rest_under_less_than_what_was_believed_says_nothing() -> None:
    assert at_rest_under(2.5).drag is None
    # nor does it take back what was seen
    assert at_rest_under(2.5, AxleState(drag=4.0)).drag == 4.0


def test_a_window_is_as_long_as_the_noise_asks_and_no_shorter_than_without() -> None:
    assert window_of(Sensing(), 0.05, 0.1) == WINDOW
    noisy = Sensing(position_noise=5e-4, yaw_noise=0.01)
    assert window_of(noisy, 0.05, 0.02) == pytest.approx(WINDOW_WAY * 5e-4 / 0.05)
    # with a long lever it is the yaw that is seen worse
    assert window_of(noisy, 0.05, 0.1) == pytest.approx(WINDOW_WAY * 1e-3 / 0.05)
