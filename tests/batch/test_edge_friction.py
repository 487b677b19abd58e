"""Friction under polygons in closed form: equal to the integral over the base for any
centre of rotation, in Python and compiled.
"""

import math
from functools import cache

import numpy as np
import pytest

from pushpressslide.batch import fast
from pushpressslide.batch.exact_surface import ExactSurface
from pushpressslide.batch.rows import answers, spread
from pushpressslide.batch.support import exact_support, polygon_support
from pushpressslide.core.task import Box, Cylinder, Prism
from pushpressslide.geometry.quadrature import polygon_rule
from pushpressslide.kernels.edge_friction import (
    far_center_friction,
    near,
    polygon_friction,
)
from pushpressslide.kernels.exact_surface import sampled_friction
from pushpressslide.kernels.support_friction import CREEP
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.limit_surface import exact_wrenches
from pushpressslide.mechanics.pressure import rectangle_pressure
from pushpressslide.planar.polygon_friction import friction_under

ELL = ((0.0, 0.0), (0.2, 0.0), (0.2, 0.05), (0.05, 0.05), (0.05, 0.2), (0.0, 0.2))
CASES = {
    "box": (Box((0.2, 0.12, 0.06)), (0.0, 0.0)),
    "box, loaded aside": (Box((0.2, 0.12, 0.06)), (0.012, -0.008)),
    "box, lifted": (Box((0.2, 0.12, 0.06)), (0.05, 0.02)),
    "bar, lifted": (Box((0.6, 0.1, 0.1)), (0.2, 0.004)),
    "triangle": (
        Prism(((-0.1, -0.08), (0.12, -0.06), (0.0, 0.11)), 0.1),
        (0.005, 0.003),
    ),
    "ell": (Prism(ELL, 0.1), (0.0, 0.0)),
    "ell, lifted": (Prism(ELL, 0.1), (0.035, 0.01)),
}
SAGITTA = (2.0 * math.pi / 64) ** 2 / 8.0  # of an edge of the polygon, over the radius


@pytest.fixture(scope="module", params=CASES.values(), ids=CASES.keys())
def face(request):
    shape, cop = request.param
    return face_pressure(shape, shape.centroid, cop)


def arguments(face):
    return face.plane(), face.edges().tolist(), face.series()


def friction(face, twist):
    return np.array(polygon_friction(*twist, *arguments(face)))


def frictions(face, twists):
    """Of many twists (n, 3), (n, 9)."""
    arrays = (np.array(face.plane()), face.edges(), np.array(face.series()))
    return answers(polygon_friction, spread(twists), arrays=arrays, columns=9)


def about(center, w):
    """The twist of the centre of pressure that leaves ``center`` at rest."""
    return (w * center[1], -w * center[0], w)


def integral(face, twist):
    """The wrench by Gauss points in triangles between the centre of rotation and parts
    of the edges, that get smaller towards the foot of its perpendicular.
    """
    vx, vy, w = twist
    center = np.array((-vy, vx)) / w
    nodes, weights = np.polynomial.legendre.leggauss(8)
    nodes = 0.5 + 0.5 * nodes
    weights = 0.5 * weights
    total = np.zeros(3)
    for start, end in zip(face.corners, np.roll(face.corners, -1, 0), strict=True):
        step = end - start
        if not step.any():
            continue
        foot = min(max(float((center - start) @ step / (step @ step)), 0.0), 1.0)
        grades = 0.5 ** np.arange(50)
        cuts = np.unique(
            np.concatenate(
                ([0.0, 1.0], foot - foot * grades, foot + (1.0 - foot) * grades)
            )
        )
        size = np.diff(cuts)
        share = (cuts[:-1, None] + size[:, None] * nodes).ravel()
        weight = (size[:, None] * weights).ravel()
        arm = start + share[:, None] * step - center
        turn = arm[:, 0] * step[1] - arm[:, 1] * step[0]
        points = center + nodes[:, None, None] * arm
        areas = (nodes * weights)[:, None] * weight * turn
        total += wrench(face, points.reshape(-1, 2), areas.ravel(), twist)
    return total


def wrench(face, points, areas, twist):
    """The sum over points of the base."""
    vx, vy, w = twist
    x, y = points.T
    px = vx - w * y
    py = vy + w * x
    speed = np.hypot(px, py)
    loads = areas * (face.level + points @ face.slope)
    k = np.divide(loads, speed, out=np.zeros_like(speed), where=speed > 0.0)
    return np.array([(k * px).sum(), (k * py).sum(), (k * (x * py - y * px)).sum()])


def centers(face, rng):
    """Centres of rotation inside and outside, on edges and their lines, at corners and
    near all these.
    """
    corners = face.corners
    size = face.reach
    for _ in range(60):
        yield rng.normal(size=2) * size * 10.0 ** rng.uniform(-2.0, 1.0)
    for start, end in zip(corners, np.roll(corners, -1, 0), strict=True):
        step = end - start
        for share in (0.0, 1.0, 0.5, rng.uniform(), -0.3, 1.7):
            place = start + share * step
            yield place
            for distance in (1e-15, 1e-12, 1e-9, 1e-6, 1e-3):
                yield place + rng.normal(size=2) * distance * size
    yield np.zeros(2)


def test_the_wrench_is_the_integral_over_the_base_wherever_it_turns(face):
    rng = np.random.default_rng(0)
    scale = (1.0, 1.0, face.rho)
    for center in centers(face, rng):
        for w in (0.7, -0.3):
            twist = about(center, w)
            found = friction(face, twist)[:3]
            wanted = integral(face, twist)
            assert found / scale == pytest.approx(wanted / scale, abs=2e-9)


def test_the_wrench_is_the_dense_integral_where_it_hardly_turns(face):
    """Up to a turn of the speed over the size times 0.1, past the series' end."""
    rng = np.random.default_rng(1)
    rules = [polygon_rule(part, 8) for part in convex_parts(face)]
    points = np.concatenate([rule[0] for rule in rules])
    areas = np.concatenate([rule[1] for rule in rules])
    scale = (1.0, 1.0, face.rho)
    for turn in (0.0, 1e-300, 1e-12, 1e-6, 1e-3, 0.01, 0.0199, 0.0201, 0.03, 0.1):
        for _ in range(20):
            angle = rng.uniform(-math.pi, math.pi)
            sign = rng.choice((-1.0, 1.0))
            twist = (
                0.05 * math.cos(angle),
                0.05 * math.sin(angle),
                0.05 * sign * turn / face.reach,
            )
            found = friction(face, twist)[:3]
            wanted = wrench(face, points, areas, twist)
            assert found / scale == pytest.approx(wanted / scale, abs=2e-9)


def convex_parts(face):
    """Triangles that the polygon is made of."""
    from shapely import Polygon, constrained_delaunay_triangles
    from shapely.geometry.polygon import orient

    whole = Polygon(face.corners)
    for part in constrained_delaunay_triangles(whole.buffer(0.0)).geoms:
        yield np.array(orient(part).exterior.coords)[:3]


def test_series_and_edges_agree_where_they_meet(face):
    rng = np.random.default_rng(2)
    plane, edges, series = arguments(face)
    scale = np.array((1.0, 1.0, face.rho))
    for angle in rng.uniform(-math.pi, math.pi, 500):
        for sign in (-1.0, 1.0):
            v = (math.cos(angle), math.sin(angle), sign * plane[3])
            one = np.array(near(*v, plane, edges))
            other = np.array(far_center_friction(*v, series))
            assert one[:3] / scale == pytest.approx(other[:3] / scale, abs=1e-9)
            rows = np.array((1.0, 1.0, face.rho, 1.0, face.rho, face.rho**2))
            assert one[3:] / rows == pytest.approx(other[3:] / rows, abs=1e-5)


def test_the_slope_is_the_derivative_of_the_wrench(face):
    rng = np.random.default_rng(3)
    scale = np.array((1.0, 1.0, 1.0 / face.rho))
    for turn in (0.0, 0.005, 0.5, 5.0):
        for _ in range(20):
            angle = rng.uniform(-math.pi, math.pi)
            v = np.array((math.cos(angle), math.sin(angle), turn / face.rho))
            xx, xy, xw, yy, yw, ww = friction(face, v)[3:]
            slope = np.array(((xx, xy, xw), (xy, yy, yw), (xw, yw, ww)))
            columns = []
            for i in range(3):
                step = np.zeros(3)
                step[i] = 1e-5 * scale[i]
                ahead = friction(face, v + step)[:3]
                back = friction(face, v - step)[:3]
                columns.append((ahead - back) / (2e-5 * scale[i]))
            unit = np.outer(scale, scale)
            assert slope * unit == pytest.approx(np.array(columns).T * unit, abs=1e-4)
            assert np.linalg.eigvalsh(slope * unit).min() > -1e-6


def test_friction_falls_to_zero_with_the_speed(face):
    """It grows with the power over ``CREEP``, and has a slope at rest."""
    assert not friction(face, (0.0, 0.0, 0.0))[:3].any()
    assert friction(face, (0.0, 0.0, 0.0))[[3, 6]] == pytest.approx(1.0 / CREEP)
    v = np.array((0.6, -0.3, 0.5 / face.rho))
    fast = friction(face, v)[:3]
    power = fast @ v
    for speed in (1e-12, 1e-8, 1e-5):
        part = speed * power / math.hypot(speed * power, CREEP)
        assert friction(face, speed * v)[:3] == pytest.approx(part * fast, rel=1e-9)


def rows(face, rng):
    """Random twists and all degenerate ones, (n, 3)."""
    size = 10.0 ** rng.uniform(-12.0, 1.0, (3000, 1))
    drawn = rng.normal(size=(3000, 3)) * size
    drawn[:1000, 2] *= 10.0 ** rng.uniform(-6.0, 2.0, 1000)
    special = [about(c, w) for c in centers(face, rng) for w in (1.0, -1.0)]
    still = np.zeros((1, 3))
    return np.concatenate([drawn, special, still, np.eye(3), -np.eye(3)])


@pytest.fixture(scope="module")
def one_by_one(face):
    """Twists and the friction of each, by a call of the kernel."""
    twists = rows(face, np.random.default_rng(4))
    known = [polygon_friction(*twist, *arguments(face)) for twist in twists.tolist()]
    return twists, np.array(known)


def test_a_batch_gives_what_its_kernel_gives(engine, face, one_by_one):
    # without numba a batch is those calls again: a tenth of them will do
    share = slice(None, None, 10 if engine == "python" else 1)
    twists, wanted = (values[share] for values in one_by_one)
    np.testing.assert_array_equal(frictions(face, twists), wanted)


def test_under_one_body_it_is_the_same_to_the_last_bit_compiled_or_not(
    face, monkeypatch
):
    if fast.compiler() is None:
        pytest.skip("numba is not installed: pip install 'pushpressslide[fast]'")
    compiled = friction_under(face)
    monkeypatch.setattr(fast, "loaded", lambda: False)
    interpreted = friction_under(face)
    for twist in rows(face, np.random.default_rng(5)).tolist():
        for sloped in (True, False):
            assert compiled(*twist, sloped) == interpreted(*twist, sloped)


KINDS = ("convex", "star", "box", "chamfer", "sliver", "concave sliver")


def drawn_corners(kind, rng):
    """Corners of a random polygon of a kind, counter-clockwise."""
    if kind in ("box", "sliver"):
        width = 1e-3 if kind == "sliver" else rng.uniform(0.2, 1.0)
        return np.array([(-1.0, -width), (1.0, -width), (1.0, width), (-1.0, width)])
    if kind == "chamfer":
        cut = 10.0 ** rng.uniform(-4.0, -1.0)
        right = [(1.0 - cut, -0.6), (1.0, -0.6 + cut), (1.0, 0.6)]
        return np.array([(-1.0, -0.6), *right, (-1.0, 0.6)])
    angles = np.sort(rng.uniform(0.0, 2.0 * math.pi, 9))
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if kind == "convex":
        return corners
    corners = corners * rng.uniform(0.4, 1.0, 9)[:, None]
    return corners * (1.0, 1e-3) if kind == "concave sliver" else corners


def drawn_faces(kind, seed, count):
    """Pressures with their centre anywhere inside: half of the polygons lift."""
    rng = np.random.default_rng(seed)
    while count:
        corners = drawn_corners(kind, rng)
        turn = rng.uniform(-math.pi, math.pi)
        c, s = math.cos(turn), math.sin(turn)
        corners = 0.1 * corners @ np.array([(c, s), (-s, c)]) + 0.05 * rng.normal(
            size=2
        )
        try:
            shape = Prism(tuple(map(tuple, corners.tolist())), 0.1)
            middle = np.array(shape.centroid)
            ways = corners[rng.choice(len(corners), 2, replace=False)].mean(0) - middle
            cop = middle + rng.choice((0.0, rng.uniform(0.1, 0.9))) * ways
            yield face_pressure(shape, (0.0, 0.0), tuple(cop)), rng
        except ValueError:  # the corners cross, or the centre is off the base
            continue
        count -= 1


def area_of(face):
    x, y = face.corners.T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def far_integral(face, twist):
    """The wrench where the centre of rotation is far off: Gauss points in triangles of
    the base itself, as the direction of sliding is smooth there.
    """
    nodes, weights = np.polynomial.legendre.leggauss(16)
    nodes = 0.5 + 0.5 * nodes
    weights = 0.5 * weights
    total = np.zeros(3)
    ends = np.roll(face.corners, -1, 0)
    for start, end in zip(face.corners, ends, strict=True):
        side = start + nodes[:, None] * (end - start)
        turn = start[0] * end[1] - start[1] * end[0]
        points = nodes[:, None, None] * side
        areas = (nodes * weights)[:, None] * weights * turn
        total += wrench(face, points.reshape(-1, 2), areas.ravel(), twist)
    return total


@pytest.mark.parametrize("kind", KINDS)
def test_the_wrench_of_any_polygon_is_the_integral_at_any_distance(kind):
    """To a hundred roundings times what the sums over the edges lose: the distance over
    the width, and once more the length over the width.
    """
    rounding = 100.0 * np.finfo(float).eps
    for face, rng in drawn_faces(kind, 7, 12):
        scale = (1.0, 1.0, face.rho)
        slender = face.reach**2 / area_of(face)
        for distance in 10.0 ** rng.uniform(math.log10(2.5), 4.0, 20):
            angle = rng.uniform(-math.pi, math.pi)
            place = distance * face.reach * np.array((math.cos(angle), math.sin(angle)))
            twist = about(place, rng.choice((0.7, -0.3)))
            found = friction(face, twist)[:3] / scale
            lost = 1e-10 if distance > 50.0 else rounding * distance * slender**2
            wanted = far_integral(face, twist) / scale
            assert found == pytest.approx(wanted, abs=1e-12 + lost)


@cache
def turning_about_an_edge(kind):
    """Faces, twists about places on the edges, and the friction of beside these."""
    cases = []
    for face, rng in drawn_faces(kind, 8, 60):
        corners = face.corners
        steps = np.roll(corners, -1, 0) - corners
        shares = rng.uniform(size=(len(corners), 1))
        middles = corners + shares * steps
        places = np.concatenate([corners, middles, 0.5 * (corners + middles)])
        beside = places + 1e-9 * face.reach * rng.normal(size=places.shape)
        twists = np.array([about(place, 0.7) for place in places])
        near_by = [friction(face, about(place, 0.7))[:3] for place in beside]
        cases.append((face, twists, np.array(near_by)))
    return cases


@pytest.mark.parametrize("kind", KINDS)
def test_a_polygon_that_turns_about_its_edge_has_the_friction_of_beside_it(
    kind, engine
):
    """Without numba a batch calls the kernel itself."""
    for face, twists, near_by in turning_about_an_edge(kind):
        scale = np.array((1.0, 1.0, face.rho))
        found = frictions(face, twists)[:, :3] / scale
        assert found == pytest.approx(near_by / scale, abs=2e-6)


NO_NUMBER = (math.nan, math.inf, -math.inf, 1e300)


@pytest.mark.parametrize("place", [0, 1, 2])
@pytest.mark.parametrize("bad", NO_NUMBER)
@pytest.mark.parametrize("other", [0.0, 0.3])
def test_the_friction_of_a_twist_that_is_no_number_is_none(engine, place, bad, other):
    face = face_pressure(*CASES["box"], (0.012, -0.008))
    twist = [other] * 3
    twist[place] = bad
    assert np.isnan(friction(face, twist)).all()
    good = [0.1, 0.2, 0.3]
    found = frictions(face, np.array([good, twist, good]))
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2]]).all()


@pytest.mark.parametrize("bad", NO_NUMBER[:3])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_samples_have_no_friction_of_a_twist_that_is_no_number(engine, place, bad):
    samples = rectangle_pressure(0.2, 0.1, 5.0, resolution=2)
    twist = [0.0] * 3
    twist[place] = bad
    for found in (
        exact_wrenches(samples, 0.3, np.array([twist]))[0],
        ExactSurface(samples, 0.3).wrenches(np.array([twist]))[0],
        sampled_friction(*twist, exact_support(samples, 0.3).arrays[0]),
    ):
        assert not np.isfinite(found).all()
        assert np.isnan(found[:3]).any()


@pytest.mark.parametrize("cop", [(0.0, 0.0), (0.01, 0.005), (0.03, 0.01)])
def test_a_round_base_is_a_polygon_of_nearly_its_friction(cop):
    """To the square of the sagitta of its edges over the loaded part's size."""
    face = face_pressure(Cylinder(0.05, 0.1), (0.0, 0.0), cop)
    angles = np.arange(4096) * (2.0 * math.pi / 4096)
    circle = 0.05 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    fine = face_pressure(Prism(tuple(map(tuple, circle.tolist())), 0.1), (0, 0), cop)
    rng = np.random.default_rng(6)
    for _ in range(10):
        twist = rng.normal(size=3) * (1.0, 1.0, 1.0 / face.rho)
        off = friction(face, twist)[:3] - friction(fine, twist)[:3]
        assert off / (1.0, 1.0, face.rho) == pytest.approx(0.0, abs=SAGITTA**2 / 0.6)


def test_a_support_needs_a_limit(face):
    with pytest.raises(ValueError, match="max_force"):
        polygon_support(face, 0.0)
