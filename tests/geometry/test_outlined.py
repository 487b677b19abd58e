"""A footprint of any outline: convex ones answer as before, concave ones by the true
footprint where it is about touching and by the hull where it is about tipping.
"""

import math
import pickle

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.border import Arc, Edge
from pushpressslide.geometry.pieces import convex_pieces
from pushpressslide.geometry.polygon import is_convex, signed_area
from pushpressslide.geometry.shapes import (
    Box,
    Compound,
    ConcavePrism,
    Cylinder,
    Part,
    Prism,
    Shape,
)

L_SHAPE = Prism(
    ((0.0, 0.0), (0.16, 0.0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0.0, 0.16)),
    0.06,
)
T_SHAPE = Compound(
    (
        Part(Box((0.12, 0.03, 0.04)), Pose2(0.0, 0.06)),
        Part(Box((0.03, 0.09, 0.04)), Pose2()),
    )
)
STADIUM = Compound(
    (
        Part(Box((0.12, 0.05, 0.04)), Pose2()),
        Part(Cylinder(0.025, 0.04), Pose2(0.06, 0.0)),
        Part(Cylinder(0.025, 0.04), Pose2(-0.06, 0.0, 0.3)),
    )
)
KEY = Compound(
    (
        Part(Cylinder(0.05, 0.04), Pose2()),
        Part(Box((0.12, 0.02, 0.04)), Pose2(0.09, 0.0, 0.0)),
    )
)
SHAPES: list[Shape] = [L_SHAPE, T_SHAPE, STADIUM, KEY]
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=["L", "T", "stadium", "key"])
ORIGIN = (0.01, -0.005)  # in G, of B
places = st.floats(-0.25, 0.25)
angles = st.floats(0.0, 2.0 * math.pi)


def notched(mouth: float, depth: float) -> Prism:
    """Return a block with a notch of a width and a depth [m] in its upper side."""
    half = 0.5 * mouth
    return Prism(
        (
            (-0.1, -0.05),
            (0.1, -0.05),
            (0.1, 0.05),
            (half, 0.05),
            (half, 0.05 - depth),
            (-half, 0.05 - depth),
            (-half, 0.05),
            (-0.1, 0.05),
        ),
        0.05,
    )


@st.composite
def convex_polygons(draw) -> tuple[tuple[float, float], ...]:
    """Return a convex polygon, its corners counter-clockwise [m]."""
    count = draw(st.integers(3, 9))
    gaps = [draw(st.floats(0.2, 1.0)) for _ in range(count)]
    turns = np.cumsum(gaps) * 2.0 * math.pi / sum(gaps)
    a = draw(st.floats(0.03, 0.2))
    b = draw(st.floats(0.03, 0.2))
    return tuple((float(a * math.cos(t)), float(b * math.sin(t))) for t in turns)


@given(convex_polygons(), places, places, angles)
def test_a_convex_outline_answers_as_a_convex_prism(
    corners: tuple[tuple[float, float], ...], x: float, y: float, angle: float
) -> None:
    assume(is_convex(corners))
    plain = Prism(corners, 0.1)
    general = ConcavePrism(corners, 0.1)
    assert type(plain) is Prism
    near = pytest.approx
    u = (math.cos(angle), math.sin(angle))
    inside = plain.depth((x, y)) > 0.0
    assert (general.depth((x, y)) > 0.0) == inside
    if inside:
        assert general.depth((x, y)) == near(plain.depth((x, y)), abs=1e-12)
    assert general.distance((x, y)) == near(plain.distance((x, y)), abs=1e-12)
    assert general.extent(u, ORIGIN) == near(plain.extent(u, ORIGIN))
    assert general.farthest(ORIGIN) == near(plain.farthest(ORIGIN))
    assert general.half_width == near(plain.half_width)
    assert general.inner_radius == near(plain.inner_radius)
    assert general.circumradius == near(plain.circumradius)
    assert general.centroid == near(plain.centroid)
    assert general.breadth == near(plain.breadth)
    assert general.gauge()(x, y) == near(plain.gauge()(x, y))
    point = np.array([[x, y]])
    assert general.depths(point, ORIGIN) == near(plain.depths(point, ORIGIN), abs=1e-12)


@given(convex_polygons(), angles)
def test_a_convex_outline_is_touched_as_a_convex_prism(
    corners: tuple[tuple[float, float], ...], angle: float
) -> None:
    plain = Prism(corners, 0.1)
    general = ConcavePrism(corners, 0.1)
    near = pytest.approx
    center = plain.centroid
    u = (math.cos(angle), math.sin(angle))
    (chord,) = general.chords(u, 0.001, center)
    assert (chord,) == (near(plain.chords(u, 0.001, center)[0], abs=1e-9),)
    mine = general.side_places(0.01, 0.02, center)
    theirs = plain.side_places(0.01, 0.02, center)
    assert len(mine) == len(theirs)
    for a, b in zip(mine, theirs, strict=True):
        assert a.index == b.index
        assert a.point == near(b.point, abs=1e-12)
        assert a.normal == near(b.normal, abs=1e-12)
        assert a.ends == near(b.ends, abs=1e-12)
        one, other = (s.side(b.point, b.normal, center) for s in (general, plain))
        tip = (a.point[0] - 0.03 * a.normal[0], a.point[1] - 0.03 * a.normal[1])
        assert one.gap(tip, 0.02)[0] == near(other.gap(tip, 0.02)[0], abs=1e-12)
        assert general.free_space(a.point, a.normal, 0.02, center) == math.inf


@given(convex_polygons(), st.floats(0.0, 0.8), angles)
def test_the_pressure_under_a_convex_outline_is_that_under_a_convex_prism(
    corners: tuple[tuple[float, float], ...], share: float, angle: float
) -> None:
    plain = Prism(corners, 0.1)
    mx, my = plain.middle
    r = share * plain.inner_radius
    cop = (mx + r * math.cos(angle), my + r * math.sin(angle))
    for one, other in zip(
        plain.pressure(cop, 5),
        ConcavePrism(corners, 0.1).pressure(cop, 5),
        strict=True,
    ):
        assert one == pytest.approx(other)


@every_shape
@given(places, places)
def test_depth_and_distance_are_those_of_the_true_footprint(
    shape: Shape, x: float, y: float
) -> None:
    area = shape.placed(Pose2())
    point = shapely.Point(x, y)
    away = area.exterior.distance(point)
    inside = area.contains(point)
    assert shape.depth((x, y)) == pytest.approx(away if inside else -away, abs=1e-12)
    assert shape.distance((x, y)) == pytest.approx(area.distance(point), abs=1e-12)


@every_shape
@given(angles)
def test_chords_are_inside_and_end_at_the_margin(shape: Shape, angle: float) -> None:
    ux, uy = (math.cos(angle), math.sin(angle))
    for near, far in shape.chords((ux, uy), 0.005, ORIGIN):
        for share in (0.0, 0.3, 1.0):
            along = near + share * (far - near)
            point = (along * ux, along * uy)
            assert shape.holds(point, 0.005 - 1e-6, ORIGIN)


@every_shape
def test_what_tips_is_the_hull(shape: Shape) -> None:
    hull = shape.placed(Pose2()).convex_hull
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.2, 0.2, size=(300, 2))
    inside = [hull.contains(shapely.Point(p)) for p in points]
    assert ((shape.depths(points, (0.0, 0.0)) > 0.0) == inside).all()
    gauge = shape.gauge()
    mx, my = shape.middle
    assert [gauge(x - mx, y - my) < 1.0 for x, y in points] == inside


@every_shape
def test_convex_pieces_make_up_the_footprint(shape: Shape) -> None:
    pieces = convex_pieces(shape.corners)
    assert all(is_convex(piece) for piece in pieces)
    assert all(signed_area(piece) > 0.0 for piece in pieces)
    area = sum(signed_area(piece) for piece in pieces)
    assert area == pytest.approx(signed_area(shape.corners), rel=1e-12)
    union = shapely.union_all([shapely.Polygon(piece) for piece in pieces])
    assert union.symmetric_difference(shape.placed(Pose2())).area < 1e-12


def test_an_l_and_a_t_have_two_convex_pieces() -> None:
    assert len(convex_pieces(L_SHAPE.corners)) == 2
    assert len(convex_pieces(T_SHAPE.corners)) == 2


@every_shape
@pytest.mark.parametrize("radius", [0.002, 0.01, 0.02, 0.05])
def test_a_tip_at_a_side_place_touches_there_and_overlaps_nothing(
    shape: Shape, radius: float
) -> None:
    area = shape.placed(Pose2())
    for place in shape.side_places(0.6 * radius, radius, (0.0, 0.0)):
        (x, y), (nx, ny) = place.point, place.normal
        tip = shapely.Point(x - radius * nx, y - radius * ny)
        # chords are 0.2 % of an arc's radius inside it
        assert tip.distance(area) == pytest.approx(radius, abs=0.0022 * 0.05)
        side = shape.side(place.point, place.normal, (0.0, 0.0))
        assert side.gap((tip.x, tip.y), radius)[0] == pytest.approx(0.0, abs=1e-9)


@given(st.floats(0.002, 0.06), st.floats(0.01, 0.08), st.floats(0.01, 0.09))
def test_the_inside_of_a_notch_is_touched_where_the_tip_fits(
    radius: float, mouth: float, depth: float
) -> None:
    assume(abs(2.0 * radius - mouth) > 1e-3)
    assume(abs(radius - depth) > 1e-3)
    touched = {
        place.index
        for place in notched(mouth, depth).side_places(0.0, radius, (0.0, 0.0))
    }
    assert touched >= {0, 1, 2, 6, 7}
    fits = 2.0 * radius < mouth
    assert ({3, 5} <= touched) == (fits and depth > radius)
    assert bool({3, 5} & touched) == (fits and depth > radius)
    dips = math.inf
    if not fits:  # into the mouth, between its corners
        dips = radius - math.sqrt(radius * radius - 0.25 * mouth * mouth)
    assume(abs(dips - depth) > 1e-3)
    assert (4 in touched) == (dips > depth)


def test_a_wide_cave_behind_a_narrow_mouth_is_not_touched() -> None:
    cave = Prism(
        (
            (-0.2, -0.2),
            (0.2, -0.2),
            (0.2, 0.2),
            (0.01, 0.2),
            (0.01, 0.1),
            (0.1, 0.1),
            (0.1, -0.1),
            (-0.1, -0.1),
            (-0.1, 0.1),
            (-0.01, 0.1),
            (-0.01, 0.2),
            (-0.2, 0.2),
        ),
        0.05,
    )
    touched = {p.index for p in cave.side_places(0.01, 0.02, (0.0, 0.0))}
    assert touched == {0, 1, 2, 10, 11}


def test_a_tooth_before_a_face_leaves_the_part_of_it_that_is_outside() -> None:
    radius = 0.02
    hook = Prism(
        (
            (-0.1, -0.1),
            (0.1, -0.1),
            (0.1, 0.2),
            (0.0, 0.2),
            (0.0, 0.03),
            (0.02, 0.03),
            (0.02, 0.18),
            (0.08, 0.18),
            (0.08, 0.0),
            (-0.1, 0.0),
        ),
        0.05,
    )
    places = hook.side_places(0.0, radius, (0.0, 0.0))
    (face,) = [place for place in places if place.index == 8]
    # the tip's centre is 10 mm below the tooth's end, whose corner is at x = 0
    free = -math.sqrt(radius**2 - 0.01**2)
    assert face.ends == pytest.approx((-0.1, free), abs=1e-4)
    assert not {4, 5, 6, 7} & {place.index for place in places}


def test_a_face_at_a_reflex_corner_is_touched_from_a_radius_on() -> None:
    radius = 0.015
    places = L_SHAPE.side_places(0.0, radius, (0.0, 0.0))
    (foot,) = [place for place in places if place.index == 2]
    # normal (0, -1): to its left is +x
    assert foot.ends == pytest.approx((0.06 + radius, 0.16), abs=1e-5)


def test_a_tip_in_a_notch_can_be_drawn_back_to_the_other_wall() -> None:
    shape = notched(0.06, 0.09)
    way = shape.free_space((0.03, 0.0), (1.0, 0.0), 0.01, (0.0, 0.0))
    assert way == pytest.approx(0.04, abs=1e-5)
    assert shape.free_space((0.1, 0.0), (-1.0, 0.0), 0.01, (0.0, 0.0)) == math.inf


def test_what_remains_of_a_round_part_is_round() -> None:
    kinds = [type(side) for side in STADIUM.border.sides]
    assert kinds == [Edge, Arc, Edge, Arc]
    for side in STADIUM.border.sides:
        if isinstance(side, Arc):
            assert side.sweep == pytest.approx(math.pi, abs=0.01)
            assert side.radius == 0.025
    normal = (-math.cos(0.4), -math.sin(0.4))
    point = (0.06 - 0.025 * normal[0], -0.025 * normal[1])
    side = STADIUM.side(point, normal, (0.0, 0.0))
    assert side.normal_at((0.085, 0.0)) == pytest.approx((-1.0, 0.0))
    assert side.gap((0.105, 0.0), 0.02)[0] == pytest.approx(0.0)
    assert side.gap((0.0, 0.045), 0.02)[0] == math.inf  # before the flat side
    assert [edge is None for edge in STADIUM.edges] == [False, True, False, True]


def test_places_along_an_arc_are_lengths_from_the_contact() -> None:
    center = (0.06, 0.0)
    point = (0.085, 0.0)
    side = STADIUM.side(point, (-1.0, 0.0), (0.0, 0.0))
    turn = np.array([-0.3, 0.0, 0.4])
    x = center[0] + 0.03 * np.cos(turn)
    y = center[1] + 0.03 * np.sin(turn)
    # to the left of the normal, which points to -x, is -y
    assert side.coordinates(x, y) == pytest.approx(-0.025 * turn)


def test_a_single_round_part_is_a_whole_circle() -> None:
    disc = Compound((Part(Cylinder(0.05, 0.04), Pose2(0.02, 0.0)),))
    (side,) = disc.border.sides
    assert isinstance(side, Arc)
    assert side.whole
    assert len(disc.side_places(0.01, 0.02, (0.0, 0.0))) == 24


def test_parts_that_meet_but_for_rounding_are_one() -> None:
    tilt = 0.7
    bar = Box((0.1, 0.03, 0.04))
    end = Pose2(0.0, 0.0, tilt).compose(Pose2(0.1, 0.0, 0.0))
    both = Compound((Part(bar, Pose2(0.0, 0.0, tilt)), Part(bar, end)))
    assert len(both.border.corners) == 4
    assert signed_area(both.border.corners) == pytest.approx(0.2 * 0.03, rel=1e-5)


@pytest.mark.parametrize(
    ("poses", "words"),
    [
        ((Pose2(), Pose2(0.2, 0.0)), "do not touch"),
        ((Pose2(), Pose2(0.1, 0.03)), "do not touch"),  # corner to corner
    ],
)
def test_parts_apart_are_refused(poses: tuple[Pose2, ...], words: str) -> None:
    bar = Box((0.1, 0.03, 0.04))
    with pytest.raises(ValueError, match=words):
        _ = Compound(tuple(Part(bar, pose) for pose in poses)).border


def test_a_ring_of_parts_is_refused() -> None:
    bar = Box((0.12, 0.02, 0.04))
    turns = [Pose2(0.0, 0.0, 0.5 * math.pi * i) for i in range(4)]
    parts = tuple(Part(bar, turn.compose(Pose2(0.0, 0.05))) for turn in turns)
    with pytest.raises(ValueError, match="hole"):
        _ = Compound(parts).border


def test_a_compound_that_is_a_box_has_the_box_s_corners_and_edges() -> None:
    box = Box((0.2, 0.1, 0.05))
    halves = Compound(
        (
            Part(Box((0.12, 0.1, 0.05)), Pose2(-0.04, 0.0)),
            Part(Box((0.1, 0.1, 0.05)), Pose2(0.05, 0.0, math.pi)),
        )
    )
    assert halves.corners == pytest.approx(np.array(box.corners))
    assert np.array(halves.edges) == pytest.approx(np.array(box.edges))


@every_shape
def test_a_shape_survives_a_trip_to_another_process(shape: Shape) -> None:
    again = pickle.loads(pickle.dumps(shape))
    assert again == shape
    assert hash(again) == hash(shape)
    assert again.corners == shape.corners


def test_corners_that_run_clockwise_are_refused() -> None:
    with pytest.raises(ValueError, match="counter-clockwise"):
        Prism(tuple(reversed(L_SHAPE.corners)), 0.06)
