"""The virtual axle of one press: exact against closed forms, and the paper's formula
with its sign slip.
"""

import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

from pushpressslide.core.task import Box, Cylinder, ObjectModel
from pushpressslide.mechanics import virtual_axle
from pushpressslide.mechanics.limit_surface import exact_wrenches
from pushpressslide.mechanics.press_axle import Press

LENGTH = 0.6
WIDTH = 0.2
loads = st.floats(2.0, 20.0)


def bar(
    load: float = 8.0, height: float = 0.1, contact=(0.2, 0.0), mu: float = 0.3
) -> Press:
    body = ObjectModel(Box((LENGTH, WIDTH, height)), 0.3, (0.0, 0.0))
    return Press(body, mu, contact, load)


def variance(cop: float) -> float:
    """Of the pressure along the bar (docs/mechanics.md, 1.2)."""
    if cop <= LENGTH / 6.0:
        return LENGTH**2 / 12.0 - cop**2
    return 0.5 * (0.5 * LENGTH - cop) ** 2


@given(loads, st.floats(0.02, 0.12), st.sampled_from([(0.0, 1.0), (math.pi, -1.0)]))
def test_near_straight_motion_has_the_closed_form_with_height(
    load, height, way
) -> None:
    angle, sign = way
    thing = bar(load, height)
    shifted = thing.cop[0] + sign * height * thing.friction
    expected = shifted - variance(abs(shifted)) / thing.lever
    assert thing.axle(angle) == pytest.approx(expected, abs=2e-4)


@given(loads, st.floats(0.1, 1.5))
def test_without_height_pulling_and_pushing_turn_about_the_same_axle(
    load, angle
) -> None:
    thing = bar(load)
    assert thing.axle(angle, 0.0) == pytest.approx(
        thing.axle(math.pi - angle, 0.0), abs=1e-6
    )


@given(st.floats(0.1, 3.0), st.floats(-3.0, 3.0))
def test_the_axle_goes_with_the_contact_round_a_cylinder(angle, bearing) -> None:
    body = ObjectModel(Cylinder(0.2, 0.05), 1.0, (0.0, 0.0))
    ahead = Press(body, 0.3, (0.1, 0.0), 8.0)
    turned = Press(body, 0.3, (0.1 * math.cos(bearing), 0.1 * math.sin(bearing)), 8.0)
    assert turned.axle(angle) == pytest.approx(ahead.axle(angle), abs=1e-3)


@given(loads)
def test_the_paper_is_off_by_twice_the_centre_of_pressure(load) -> None:
    thing = bar(load)
    assert thing.paper_printed() + thing.paper_axle() == pytest.approx(
        2.0 * thing.cop[0]
    )
    assert thing.paper_axle() == pytest.approx(thing.cop[0] - 0.36 * 0.1 / thing.lever)


def test_the_axle_of_near_straight_sliding_is_the_closed_form() -> None:
    """docs/mechanics.md, section 4: +0.034 m forward, -0.198 m backward from the CoM."""
    for backward, wanted in ((False, 0.034), (True, -0.198)):
        ahead, reach = bar().steered(0.0, backward)
        assert bar().cop[0] + ahead == pytest.approx(wanted, abs=5e-4)
        near, nearly = bar().steered(math.radians(2.0), backward)
        assert near == pytest.approx(ahead, abs=1e-3)
        assert nearly == pytest.approx(reach, rel=0.02)


def test_the_pivot_is_off_the_axis_to_the_side_of_the_force() -> None:
    left = bar().pivot(True)
    right = bar().pivot(False)
    assert left[1] > 0.02
    assert right == pytest.approx((left[0], -left[1]), abs=1e-6)


def test_drag_at_the_top_of_a_high_object_leaves_its_base() -> None:
    high = Press(
        ObjectModel(Box((0.1, 0.1, 0.2)), 1.0, (0.0, 0.0)), 0.4, (0.03, 0.0), 10.0
    )
    assert high.room(0.0) < 0.0
    assert high.room(math.pi) > high.room(0.0)
    with pytest.raises(ValueError, match="outline"):
        high.steered(math.radians(20.0), backward=False)


def test_a_drag_that_tips_the_object_is_refused() -> None:
    with pytest.raises(ValueError, match="outline of the base"):
        bar(height=0.6).axle(0.0)


@pytest.mark.parametrize(
    ("fields", "words"),
    [({"load": 0.0}, "load 0.0 N"), ({"contact": (0.0, 0.0)}, "at the CoM")],
)
def test_no_press_and_no_lever_are_refused(fields, words) -> None:
    with pytest.raises(ValueError, match=words):
        bar(**fields)


def drawn(rng: random.Random) -> tuple[Press, float]:
    """A press on a box of any proportions, and a force angle."""
    size = (rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.4), rng.uniform(0.02, 0.3))
    centre = (rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02))
    body = ObjectModel(Box(size), rng.uniform(0.3, 5.0), centre)
    contact = (rng.uniform(-0.35, 0.35) * size[0], rng.uniform(-0.35, 0.35) * size[1])
    press = Press(body, rng.uniform(0.1, 0.6), contact, rng.uniform(3.0, 40.0))
    return press, rng.uniform(-3.0, 3.0)


def slide_by_search(press: Press, ratio: float, angle: float) -> tuple[float, float]:
    """Return the force over the load that slides the object whose pressure a force of
    ``ratio`` times the load has moved, and the axle [m]. By a general minimiser: of all
    twists on which the force does unit power, the one of least friction power.
    """
    ux, uy = press.along(angle)
    shift = press.body.shape.height * ratio
    cop = np.array(press.cop) + shift * np.array([ux, uy])
    samples = press.pressure(tuple(cop))
    arm = np.array(press.contact) - cop
    moment = arm[0] * uy - arm[1] * ux
    scale = press.body.shape.circumradius
    force = np.array([ux, uy, moment / scale])
    unit = force / np.linalg.norm(force)
    basis = np.linalg.svd(unit[None])[2][1:]
    start = unit / np.linalg.norm(force)

    def power(z):
        nu = start + z @ basis
        twist = np.array([[nu[0], nu[1], nu[2] / scale]])
        wrench = exact_wrenches(samples, press.friction, twist)[0]
        wrench[2] /= scale
        return wrench @ nu, basis @ wrench

    found = optimize.minimize(
        power, np.zeros(2), jac=True, method="BFGS", options={"gtol": 1e-11}
    )
    vx, vy, w = (start + found.x @ basis) / (1.0, 1.0, scale)
    back = np.array(press.cop) - cop
    v = np.array([vx - w * back[1], vy + w * back[0]])
    ex, ey = press.axis
    distance = (v[1] * ex - v[0] * ey) / w
    place = np.array(press.cop) - distance * np.array([ex, ey])
    return found.fun / samples.total_load, place @ (ex, ey)


def axle_by_search(press: Press, angle: float) -> float | None:
    """Return the axle [m] at the least force that slides the object: first where a row
    of forces brackets it, then by Brent's method. None where it tips before.
    """
    last = 0.0
    for ratio in np.linspace(0.0, press.friction, 25)[1:]:
        try:
            slides, _ = slide_by_search(press, ratio, angle)
        except ValueError:
            return None
        if slides <= ratio * (1.0 + 1e-12):
            break
        last = ratio
    least = optimize.brentq(
        lambda r: slide_by_search(press, r, angle)[0] - r, last, ratio, xtol=1e-9
    )
    return slide_by_search(press, least, angle)[1]


def assert_axles_agree(cases: int, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(cases):
        press, angle = drawn(rng)
        wanted = axle_by_search(press, angle)
        if wanted is not None:
            # far axles are directions: relative there
            assert press.axle(angle) == pytest.approx(wanted, abs=1e-5, rel=1e-5), (
                press,
                angle,
            )


def test_the_axle_is_that_of_an_independent_search() -> None:
    assert_axles_agree(15, seed=4)


@pytest.mark.long
def test_the_axle_is_that_of_an_independent_search_in_300_cases() -> None:
    assert_axles_agree(300, seed=5)


def near_tipping() -> tuple[Press, float]:
    """A box whose base lifts to a strip under the drag."""
    body = ObjectModel(Box((0.1991, 0.1823, 0.2172)), 3.836, (0.0, 0.0))
    return Press(body, 0.4913, (0.04784, 0.0), 25.19), 0.8498


def test_the_axle_near_tipping_is_that_of_the_force_that_slides() -> None:
    press, angle = near_tipping()
    assert press.axle(angle) == pytest.approx(0.0442, abs=5e-5)
    assert press.axle(angle) == pytest.approx(axle_by_search(press, angle), abs=1e-5)


def test_the_axle_does_not_depend_on_the_tolerance_of_its_iteration(
    monkeypatch,
) -> None:
    rng = random.Random(6)
    cases = [near_tipping()] + [drawn(rng) for _ in range(60)]
    axles = []
    for press, angle in cases:
        try:
            axles.append(press.axle(angle))
        except ValueError:
            axles.append(math.nan)
    monkeypatch.setattr(virtual_axle, "SETTLED", 0.1 * virtual_axle.SETTLED)
    judged = 0
    for (press, angle), axle in zip(cases, axles, strict=True):
        if math.isnan(axle):
            with pytest.raises(ValueError, match="outline"):
                press.axle(angle)
        else:
            judged += 1
            assert press.axle(angle) == pytest.approx(axle, abs=1e-5)
    assert judged > 40


def test_an_object_that_slides_before_it_tips_has_an_axle() -> None:
    """Full drag would take the centre of pressure off the base; a turn needs less."""
    body = ObjectModel(Box((0.2, 0.2, 0.28)), 1.0, (0.0, 0.0))
    press = Press(body, 0.4, (0.08, 0.0), 6.0)
    angle = 0.5 * math.pi
    assert press.room(angle) < -0.1
    assert press.axle(angle) == pytest.approx(axle_by_search(press, angle), abs=1e-5)
