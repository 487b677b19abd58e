"""The camera of a replay sees the contact, with no body in front."""

import math

import numpy as np
import pytest

from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.view.drake.camera import (
    BEST_SLOPE,
    LEAST_SLOPE,
    Directions,
    candidates,
    top_direction,
)
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.sight import (
    Block,
    Limb,
    Moment,
    are_seen,
    force_share,
    seen_share,
    segment_distance,
    shown_share,
)
from pushpressslide.view.drake.views import page_views

BOX = Block(((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)), 0.15)
BEHIND = (-0.12, 0.0, 0.04)  # of a tip that pushes the box along +x
AROUND = np.array(
    [(x, y, z) for x in (-0.3, 0.3) for y in (-0.3, 0.3) for z in (0.0, 0.2)]
)
ALONG_X = np.array([(1.0, 0.0)])


def is_seen(moment, point, direction):
    return bool(are_seen(moment, np.array([point]), direction)[0])


def towards(azimuth, slope=BEST_SLOPE):
    flat = math.cos(slope)
    return np.array(
        [flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(slope)]
    )


def test_a_body_hides_a_tip_behind_it_and_shows_one_before_it():
    moment = Moment((BEHIND,), (BOX,), ())
    assert not is_seen(moment, BEHIND, towards(0.0))
    assert is_seen(moment, BEHIND, towards(math.pi))
    assert is_seen(moment, BEHIND, np.array([0.0, 0.0, 1.0]))
    assert seen_share(
        Moment((BEHIND, (0.12, 0.0, 0.04)), (BOX,), ()), towards(0.0)
    ) == (0.5)


def test_a_body_lower_than_the_line_of_sight_hides_nothing():
    low = Block(BOX.outline, 0.05)
    moment = Moment(((-0.4, 0.0, 0.04),), (low,), ())
    assert is_seen(moment, moment.contacts[0], towards(0.0))


def test_an_arm_in_front_hides_a_contact_but_its_own_rod_does_not():
    rod = Limb(BEHIND, (-0.12, 0.0, 0.2), 0.015)
    direction = towards(math.pi)
    assert is_seen(Moment((BEHIND,), (), (rod,)), BEHIND, direction)
    ahead = np.array(BEHIND) + 0.3 * direction
    side = np.array([0.0, 0.4, 0.0])
    left = tuple(ahead + side)
    right = tuple(ahead - side)
    link = Limb(left, right, 0.06)
    assert not is_seen(Moment((BEHIND,), (), (link,)), BEHIND, direction)
    assert is_seen(Moment((BEHIND,), (), (link,)), BEHIND, towards(0.0))


@pytest.mark.parametrize("yaw", np.linspace(0.0, 5.5, 8))
def test_the_camera_is_on_the_side_of_the_contact_whatever_the_heading(yaw):
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array([[c, -s], [s, c]])
    block = Block(tuple(map(tuple, (turn @ np.array(BOX.outline).T).T)), BOX.height)
    x, y = turn @ BEHIND[:2]
    moment = Moment(((x, y, BEHIND[2]),), (block,), ())
    push = np.array([(c, s)])
    chosen = Directions(TABLE, [moment], push, AROUND).best()
    assert is_seen(moment, moment.contacts[0], chosen)
    assert chosen[:2] @ push[0] < 0.3


def test_the_camera_goes_round_an_arm():
    moment = Moment((BEHIND,), (BOX,), ())
    free = Directions(TABLE, [moment], ALONG_X, AROUND).best()
    begin = np.array(BEHIND) + 0.25 * free
    up = np.array([0.0, 0.0, 0.1])
    link = Limb(tuple(begin - up), tuple(begin + up), 0.1)
    blocked = Moment((BEHIND,), (BOX,), (link,))
    assert seen_share(blocked, free) == 0.0
    chosen = Directions(TABLE, [blocked], ALONG_X, AROUND).best()
    assert seen_share(blocked, chosen) == 1.0


def test_a_tip_that_is_hidden_costs_more_than_its_force():
    over = ((-0.05, -0.3, 0.25), (-0.05, 0.3, 0.25))
    limbs = tuple(Limb((x, y, z), (x, -y, z), 0.065) for x, y, z in over)
    beyond = tuple(Limb((0.1, y, 0.25), (-0.2, y, 0.25), 0.065) for y in (-0.2, 0.2))
    forces = ((-0.05, 0.0, 0.162), (0.0, 0.0, 0.162))
    moment = Moment((BEHIND,), (BOX,), (*limbs, *beyond), forces=forces)
    best = Directions(TABLE, [moment], ALONG_X, AROUND).best()
    assert seen_share(moment, best) == 1.0
    assert force_share(moment, towards(math.pi)) < force_share(moment, towards(0.0))


def test_a_wall_is_seen_from_its_front_and_the_picture_is_upright():
    wall = SupportFrame.of_wall((0.86, 0.0, 0.81), math.pi)
    normal = np.array(wall.normal)
    for direction in candidates(wall, LEAST_SLOPE):
        assert direction @ normal >= math.sin(LEAST_SLOPE) - 1e-9
        assert direction[2] >= 0.0
    assert top_direction(wall) == pytest.approx(normal)


@pytest.mark.parametrize(
    ("a", "b", "c", "d", "distance"),
    [
        ((0, 0, 0), (1, 0, 0), (0.5, 1, 0), (0.5, 2, 0), 1.0),
        ((0, 0, 0), (1, 0, 0), (0.5, -1, 0.3), (0.5, 1, 0.3), 0.3),
        ((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), 1.0),
        ((0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 0), 2.0),
        ((0, 0, 0), (1, 0, 0), (0.2, 0.4, 0), (0.2, 0.4, 0), 0.4),
    ],
)
def test_the_distance_of_two_lines(a, b, c, d, distance):
    lines = [np.array(p, dtype=float) for p in (a, b, c, d)]
    assert segment_distance(*lines) == pytest.approx(distance)


def test_a_page_has_views_of_the_contact_from_above_from_the_side_and_at_the_tip(
    arm_run,
):
    playback = Playback(arm_run.plan, arm_run.record)
    ticks = np.arange(0, 400, 40)
    views = {view.name: view for view in page_views(playback, ticks)}
    assert list(views) == ["Contact", "All", "Top", "Side", "Tip", "Follow"]
    assert views["Top"].direction[2] > 0.99
    assert views["Side"].direction[2] < views["Contact"].direction[2]
    tips = arm_run.record.arrays["tip_position"][ticks, 0]
    assert np.array(views["Tip"].follow) == pytest.approx(tips, abs=1e-4)
    poses = arm_run.record.arrays["object_pose"][ticks, :2]
    assert np.array(views["Follow"].follow)[:, :2] == pytest.approx(poses, abs=1e-4)
    # behind the tip that pushes along the object's x axis, wherever the object turns
    yaws = arm_run.record.arrays["object_pose"][ticks, 2]
    assert np.array(views["Tip"].turn) == pytest.approx(yaws, abs=1e-4)
    assert views["Tip"].direction[0] < 0.0
    assert not views["Follow"].turn
    assert len(views["All"].points) > len(views["Contact"].points)


def test_the_camera_shows_the_object_with_no_body_in_front():
    corners = tuple((x, y, 0.151) for x, y in BOX.outline)
    on_top = (0.0, 0.0, 0.17)
    posts = [
        Block(((x, -0.4), (x + 0.3, -0.4), (x + 0.3, -0.2), (x, -0.2)), 0.6)
        for x in (-0.45, -0.15, 0.15)
    ]
    moment = Moment((on_top,), (BOX, *posts), (), corners)
    assert shown_share(moment, towards(-0.5 * math.pi)) == 0.0
    chosen = Directions(TABLE, [moment], np.zeros((0, 2)), AROUND).best()
    assert shown_share(moment, chosen) == 1.0
    assert seen_share(moment, chosen) == 1.0


def test_many_points_are_judged_as_each_alone():
    rng = np.random.default_rng(5)
    limbs = tuple(
        Limb(tuple(a), tuple(b), 0.05)
        for a, b in rng.uniform(-0.4, 0.4, (6, 2, 3)).tolist()
    )
    points = rng.uniform(-0.3, 0.3, (40, 3))
    moment = Moment((), (BOX,), limbs)
    together = are_seen(moment, points, towards(0.7))
    alone = [is_seen(moment, tuple(p), towards(0.7)) for p in points.tolist()]
    assert together.tolist() == alone
    assert 0 < together.sum() < len(points)
