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
    assert high.tipping_margin(0.0) < 0.0
    assert high.tipping_margin(math.pi) > high.tipping_margin(0.0)
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
    """A press on a box of any proportions, in half the cases with its centre of mass
    aside, and a force angle.
    """
    size = (rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.4), rng.uniform(0.02, 0.3))
    off = 0.2 if rng.random() < 0.5 else 0.0
    centre = (off * rng.uniform(-0.5, 0.5) * size[0], off * rng.uniform(-0.5, 0.5))
    centre = (centre[0], centre[1] * size[1])
    body = ObjectModel(Box(size), rng.uniform(0.3, 5.0), centre)
    contact = (rng.uniform(-0.35, 0.35) * size[0], rng.uniform(-0.35, 0.35) * size[1])
    press = Press(body, rng.uniform(0.1, 0.6), contact, rng.uniform(3.0, 40.0))
    return press, rng.uniform(-3.0, 3.0)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)
NODES = 0.5 + 0.5 * NODES
WEIGHTS = 0.5 * WEIGHTS
GRADES = 0.4 ** np.arange(24)


def base_of(press: Press) -> np.ndarray:
    """The corners of the base, from the centre of mass."""
    x, y, _ = press.body.shape.size
    signs = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return 0.5 * signs * (x, y) - np.array(press.body.center_of_mass)


def pressed_part(corners: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """The part of a convex polygon where plane[0] + plane[1:] . r > 0."""
    out = []
    for here, there in zip(corners, np.roll(corners, -1, 0), strict=True):
        one = plane[0] + plane[1:] @ here
        other = plane[0] + plane[1:] @ there
        if one > 0.0:
            out.append(here)
        if (one > 0.0) != (other > 0.0):
            out.append(here + one / (one - other) * (there - here))
    return np.array(out)


def load_and_moments(corners: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """Of max(0, plane[0] + plane[1:] . r), by middles of the sides of triangles."""
    part = pressed_part(corners, plane)
    if len(part) < 3:
        return np.zeros(3)
    a, b, c = part[0], part[1:-1], part[2:]
    u, v = (b - a).T, (c - a).T
    areas = 0.5 * (u[0] * v[1] - u[1] * v[0])
    middles = 0.5 * np.array([a + b, b + c, c + a])  # (3, n, 2)
    loads = areas / 3.0 * (plane[0] + middles @ plane[1:])
    return np.array([loads.sum(), *np.einsum("mn,mni->i", loads, middles)])


def pressure_about(corners: np.ndarray, cop: np.ndarray) -> np.ndarray:
    """The plane of unit load whose centre is ``cop``, by a general solver: along the
    way from the centroid.
    """
    area = load_and_moments(corners, np.array([1.0, 0.0, 0.0]))
    middle = area[1:] / area[0]
    scale = np.abs(corners - middle).max()
    unit = (corners - middle) / scale
    size = load_and_moments(unit, np.array([1.0, 0.0, 0.0]))[0]
    way = (cop - middle) / scale
    # each step leaves four fifths of the distance to the base's edge
    edge = (0.5 * np.ptp(unit, axis=0) / np.maximum(np.abs(way), 1e-9)).min()
    steps = math.ceil(math.log(1.0 - 1.0 / edge) / math.log(0.8)) + 1
    shares = edge * (1.0 - (1.0 - 1.0 / edge) ** (np.arange(1, steps + 1) / steps))
    plane = np.array([1.0, 0.0, 0.0])
    for share in shares:
        wanted = size * np.array([1.0, *(share * way)])
        found = optimize.root(
            lambda p, w=wanted: load_and_moments(unit, p) - w, plane, tol=1e-13
        )
        plane = found.x
    assert np.abs(found.fun).max() < 1e-10 * size
    slope = plane[1:] / scale
    return np.array([plane[0] - slope @ middle, *slope]) / (size * scale**2)


def friction_about(part: np.ndarray, plane: np.ndarray, center: np.ndarray):
    """Force and moment about the origin, over mu, that turn the base to the left about
    ``center``.

    They are sums over Gauss points in triangles between the centre and parts of the
    edges. The parts get smaller towards the foot of the perpendicular.
    """
    steps = np.roll(part, -1, 0) - part
    squares = (steps * steps).sum(axis=1)
    starts = part[squares > 0.0]
    steps = steps[squares > 0.0]
    ahead = ((center - starts) * steps).sum(axis=1) / squares[squares > 0.0]
    foot = np.clip(ahead, 0.0, 1.0)[:, None]
    ends = np.broadcast_to((0.0, 1.0), (len(foot), 2))
    cuts = [ends, foot - foot * GRADES, foot + (1.0 - foot) * GRADES]
    cuts = np.sort(np.concatenate(cuts, axis=1), axis=1)
    size = np.diff(cuts, axis=1)[..., None]
    share = (cuts[:, :-1, None] + size * NODES)[..., None]
    arms = starts[:, None, None] + share * steps[:, None, None] - center
    areas = (
        arms[..., 0] * steps[:, 1, None, None] - arms[..., 1] * steps[:, 0, None, None]
    )
    areas = (areas * size * WEIGHTS).ravel()
    arm = arms.reshape(-1, 2)
    reach = np.linalg.norm(arm, axis=1)
    way = arm / reach[:, None]
    # along the ray the direction of sliding is the same, and p is linear: exact
    level = plane[0] + plane[1:] @ center
    slope = arm @ plane[1:]
    loads = areas * (level / 2.0 + slope / 3.0)
    outer = areas * (level / 3.0 + slope / 4.0)
    force = np.array([-(loads @ way[:, 1]), loads @ way[:, 0]])
    spin = outer @ reach
    return np.array([*force, spin + center[0] * force[1] - center[1] * force[0]])


def axle_by_search(press: Press, angle: float) -> float | None:
    """The axle [m], by a general solver for the centre of rotation and the sliding
    force together. None if the pressure leaves the base, so that the object tips.
    """
    corners = base_of(press)
    u = np.array(press.along(angle))
    cop = np.array(press.cop)
    contact = np.array(press.contact)
    height = press.body.shape.height
    moment = contact[0] * u[1] - contact[1] * u[0]
    about_cop = moment - (cop[0] * u[1] - cop[1] * u[0])
    turn = math.copysign(1.0, about_cop)
    length = press.body.shape.circumradius

    def slid(ratio: float, start: np.ndarray) -> tuple[np.ndarray, float]:
        """The centre of rotation of a force that has moved the pressure by its
        ``ratio`` to the load, and the ratio that slides the object.
        """
        plane = pressure_about(corners, cop + height * ratio * u)
        part = pressed_part(corners, plane)

        def force(center):
            """Along the wrench, across it, and the moment that is left over."""
            friction = turn * press.friction * friction_about(part, plane, center)
            along = friction[:2] @ u
            across = u[0] * friction[1] - u[1] * friction[0]
            return along, across, (friction[2] - along * moment) / length

        for share in (1.0, 0.5, 2.0, 0.25, 4.0):  # it may stop short of the root
            near = cop + share * (start - cop)
            found = optimize.root(lambda c: force(c)[1:], near, tol=1e-13)
            if np.abs(found.fun).max() < 1e-9 * press.friction:
                break
        assert np.abs(found.fun).max() < 1e-9 * press.friction
        return found.x, force(found.x)[0]

    center = cop + 0.25 * length**2 / about_cop * np.array([-u[1], u[0]])
    last = 0.0
    # nearer to the base's edge a general solver finds no pressure
    room = 0.4995 * np.array(press.body.shape.size[:2])
    start = cop + press.body.center_of_mass
    most = ((np.sign(u) * room - start) / (height * u)).min()
    for ratio in np.linspace(0.0, press.friction, 13)[1:]:
        center, slides = slid(min(ratio, most), center)
        if slides <= min(ratio, most):
            break
        if ratio >= most:
            return None
        last = ratio
    least = optimize.brentq(
        lambda r: slid(r, center)[1] - r, last, min(ratio, most), xtol=1e-11
    )
    center, _ = slid(least, center)
    return float((center - cop) @ press.axis + cop @ press.axis)


def assert_axles_agree(cases: int, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(cases):
        press, angle = drawn(rng)
        wanted = axle_by_search(press, angle)
        if wanted is None:
            with pytest.raises(ValueError, match="outline"):
                press.axle(angle)
        else:
            assert press.axle(angle) == pytest.approx(wanted, abs=1e-6), (press, angle)


def test_the_axle_is_that_of_an_independent_search() -> None:
    assert_axles_agree(10, seed=4)


@pytest.mark.long
def test_the_axle_is_that_of_an_independent_search_in_240_cases() -> None:
    assert_axles_agree(240, seed=5)


def test_planning_steers_about_the_exact_axle() -> None:
    rng = random.Random(7)
    for _ in range(20):
        press, angle = drawn(rng)
        angle = min(abs(angle), 1.4)
        for backward in (False, True):
            sides = [math.pi - a if backward else a for a in (angle, -angle)]
            try:
                axles = [press.axle(side) for side in sides]
            except ValueError:
                continue
            ahead, _ = press.steered(angle, backward)
            place = np.array(press.cop) @ press.axis + ahead
            assert place == pytest.approx(np.mean(axles), abs=1e-9)


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
    assert press.tipping_margin(angle) < -0.1
    assert press.axle(angle) == pytest.approx(axle_by_search(press, angle), abs=1e-5)
