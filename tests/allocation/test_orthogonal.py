"""Two pushes at right angles: feasibility and centres of turning (docs/mechanics.md,
section 6).
"""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.allocation import orthogonal, published
from pushpressslide.core.pose import cross
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_edges, cone_margin

D = 0.1
RHO = 0.08
K = RHO**2 / D
POINTS = ((-D, 0.0), (0.0, D))
NORMALS = ((1.0, 0.0), (0.0, -1.0))
frictions = st.floats(0.1, 0.99)
sizes = st.just(0.0) | st.floats(1e-6, 10.0)  # [N]


def wrench_of_edges(mu, k):
    rays = [ray for n in NORMALS for ray in cone_edges(n, mu)]
    fx, fy = (sum(a * ray[i] for a, ray in zip(k, rays, strict=True)) for i in range(2))
    tau = sum(
        a * cross(POINTS[i // 2], ray)
        for i, (a, ray) in enumerate(zip(k, rays, strict=True))
    )
    return fx, fy, tau


@given(frictions, st.tuples(sizes, sizes, sizes, sizes))
def test_whatever_the_cones_give_is_feasible_and_allocated_inside_them(mu, k):
    wrench = wrench_of_edges(mu, k)
    assert orthogonal.feasibility(*wrench, D, mu).spare >= -1e-9
    forces = orthogonal.forces(*wrench, D, mu)
    assert wrench_of_forces(POINTS, forces)[:3] == pytest.approx(wrench, abs=1e-9)
    for force, normal in zip(forces, NORMALS, strict=True):
        assert cone_margin(force, normal, mu) >= -1e-9


@pytest.mark.parametrize(
    ("wrench", "condition"),
    [
        ((-1.0, -2.0, 0.0), "contact B"),
        ((2.0, 1.0, 0.0), "contact L"),
        ((1.0, -1.0, 0.9 * D), "left"),
        ((1.0, -1.0, -0.9 * D), "right"),
    ],
)
def test_the_condition_that_decides_is_named(wrench, condition):
    result = orthogonal.feasibility(*wrench, D, 0.5)
    assert not result.feasible
    assert condition in result.condition


@given(st.floats(1.01, 1.9), *[st.floats(-5.0, 5.0)] * 3)
def test_with_friction_above_one_every_wrench_is_possible(mu, fx, fy, t):
    assert orthogonal.feasibility(fx, fy, t * D, D, mu).feasible
    low, high = orthogonal.friction_interval(fx, fy, t * D, D, mu)
    assert low <= high
    for force, normal in zip(
        orthogonal.forces(fx, fy, t * D, D, mu), NORMALS, strict=True
    ):
        assert cone_margin(force, normal, mu) >= -1e-9


@given(frictions, st.tuples(sizes, sizes, sizes, sizes))
def test_every_centre_of_turning_is_in_its_region_and_none_is_closer_than_the_least_radius(
    mu, k
):
    wrench = wrench_of_edges(mu, k)
    if abs(wrench[2]) > 1e-6:
        center = orthogonal.turning_center(*wrench, RHO)
        rounding = math.copysign(1e-9 * (1.0 + math.hypot(*center)), wrench[2])
        moved = (center[0] + rounding, center[1] + rounding)
        assert orthogonal.can_turn_about(moved, wrench[2] > 0.0, D, mu, RHO)
        assert math.hypot(*center) >= orthogonal.least_turning_radius(D, mu, RHO) * (
            1.0 - 1e-9
        )


@given(frictions, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.booleans())
def test_an_object_can_be_turned_about_just_the_points_of_the_region(mu, x, y, left):
    sign = 1.0 if left else -1.0
    tau = sign * 1.0
    wrench = (y * tau / RHO**2, -x * tau / RHO**2, tau)
    spare = orthogonal.feasibility(*wrench, D, mu).spare
    if abs(spare) > 1e-6:
        assert orthogonal.can_turn_about((x, y), left, D, mu, RHO) == (spare > 0.0)


@given(frictions)
def test_the_corners_are_where_one_contact_alone_turns_the_object(mu):
    for left in (True, False):
        corners = orthogonal.turning_corners(D, mu, RHO, left)
        alone = [
            wrench_of_edges(mu, [float(i == j) for j in range(4)]) for i in range(4)
        ]
        centers = [
            orthogonal.turning_center(*w, RHO) for w in alone if (w[2] > 0.0) == left
        ]
        assert len(centers) == 2
        for corner, center in zip(sorted(corners), sorted(centers), strict=True):
            assert center == pytest.approx(corner)


@given(frictions)
def test_the_least_radius_is_reached_between_the_corners(mu):
    (ax, ay), (bx, by) = orthogonal.turning_corners(D, mu, RHO, True)
    middle = (0.5 * (ax + bx), 0.5 * (ay + by))
    assert math.hypot(*middle) == pytest.approx(
        orthogonal.least_turning_radius(D, mu, RHO)
    )
    assert orthogonal.can_turn_about(
        (1.001 * middle[0], 1.001 * middle[1]), True, D, mu, RHO
    )
    assert not orthogonal.can_turn_about(
        (0.999 * middle[0], 0.999 * middle[1]), True, D, mu, RHO
    )


@pytest.mark.parametrize(
    ("mu", "near", "far", "d_min", "d_max"),
    [(0.3, 2.79, 4.33, 10.1, 12.1), (0.5, 1.67, 3.0, 3.0, 5.0)],
)
def test_distances_beside_a_translation_and_the_papers(mu, near, far, d_min, d_max):
    assert orthogonal.translation_radii(D, mu, RHO) == pytest.approx(
        (near * K, far * K), rel=3e-3
    )
    assert published.unicycle_distances(D, mu, RHO) == pytest.approx(
        (d_min * K, d_max * K), rel=3e-3
    )


@given(frictions)
def test_beside_a_force_along_x_both_extreme_centres_turn_right_and_along_y_left(mu):
    """The paper has one of each."""
    radii = orthogonal.translation_radii(D, mu, RHO)
    # friction of the balancing contact
    for limit, radius in ((1.0, radii[0]), (-1.0, radii[1])):
        along_x = ((1.0, mu), (limit * mu * mu, -mu))
        along_y = ((mu, -limit * mu * mu), (-mu, -1.0))
        for forces, left in ((along_x, False), (along_y, True)):
            for force, normal in zip(forces, NORMALS, strict=True):
                assert cone_margin(force, normal, mu) == pytest.approx(0.0, abs=1e-12)
            wrench = wrench_of_forces(POINTS, forces)
            assert (wrench.fy if forces is along_x else wrench.fx) == pytest.approx(
                0.0, abs=1e-12
            )
            assert (wrench.tau > 0.0) == left
            center = orthogonal.turning_center(wrench.fx, wrench.fy, wrench.tau, RHO)
            assert math.hypot(*center) == pytest.approx(radius)


@given(frictions, st.floats(0.0, 2.0))
def test_beside_a_force_along_x_the_nearest_centre_is_the_nearer_of_the_two(mu, t):
    near, _ = orthogonal.translation_radii(D, mu, RHO)
    if t > 1e-3:
        radius = RHO**2 / (t * D)
        if abs(radius / near - 1.0) > 1e-9:
            assert orthogonal.feasibility(1.0, 0.0, -t * D, D, mu).feasible == (
                radius > near
            )


@given(frictions)
def test_the_single_arm_tracking_points_are_on_the_border_of_the_regions(mu):
    """The paper says that they are out of reach: K (1, +-1/mu), with the other arm at
    rest.
    """
    for left, y in ((True, K / mu), (False, -K / mu)):
        s = 1.0 + 1e-9
        moved = (K * s, y * s) if left else (K / s, y * s)
        assert orthogonal.can_turn_about(moved, left, D, mu, RHO)


@given(*[st.floats(-5.0, 5.0)] * 3, st.sampled_from([0.2, 0.7, 1.0, 1.3]))
def test_the_interval_of_friction_is_empty_just_where_a_wrench_is_impossible(
    fx, fy, t, mu
):
    spare = orthogonal.feasibility(fx, fy, t * D, D, mu).spare
    assume(abs(spare) > 1e-6)
    low, high = orthogonal.friction_interval(fx, fy, t * D, D, mu)
    assert (low <= high) == (spare > 0.0)
