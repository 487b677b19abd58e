"""Identification of an object's centre of mass, against motions of a unicycle whose
heading leads from the true centre to the contact.
"""

import math
import random

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import ObjectModel, Scene, Support
from pushpressslide.core.twist_path import integrate
from pushpressslide.geometry.shapes import Box
from pushpressslide.identification.center import (
    BOUNDED,
    HEADING,
    CenterIdentifier,
    CenterState,
    Doubt,
    doubt,
)

DT = 0.004
SPEED = 0.04  # [m/s] of the virtual axle
CONTACT = (0.05, 0.0)
WHEELBASE = 0.06  # [m]
AXLE = -0.05  # [m] of the virtual axle ahead of the CoM
NOISE = 2e-4  # [m] and, over the lever, [rad] of a pose


def driven(
    identifier, center, curvatures, state=None, axle=AXLE, backward=False, noise=0.0
):
    """Return the state after arcs of a second each, of ``curvatures`` [1/m], with the
    centre of mass at ``center`` [m] across the line to the contact.
    """
    rng = random.Random(1)
    heading = math.atan2(-center, CONTACT[0])
    speed = -SPEED if backward else SPEED
    x = axle * math.cos(heading)
    y = center + axle * math.sin(heading)
    state = state or CenterState()
    pose = Pose2(0.3, 0.1, 0.4)
    for i in range(int(len(curvatures) / DT)):
        w = speed * curvatures[int(i * DT)]
        vx = speed * math.cos(heading) + w * y
        vy = speed * math.sin(heading) - w * x
        pose = integrate(pose, (vx, vy, w), DT)
        seen = Pose2(
            pose.x + rng.gauss(0.0, noise),
            pose.y + rng.gauss(0.0, noise),
            pose.yaw + rng.gauss(0.0, noise / CONTACT[0]),
        )
        force = (3.0, 0.0)
        if backward:
            force = (-3.0, 0.0)
        state = identifier.step(state, (i + 1) * DT, seen, force, CONTACT)
    return state


def planned(center=0.0, backward=False):
    """Identifier of the centre in a segment planned with ``center`` [m]."""
    yaw = math.atan2(-center, CONTACT[0])
    axle = (AXLE * math.cos(yaw), center + AXLE * math.sin(yaw))
    turn = math.pi if backward else 0.0
    doubted = Doubt(axle=0.5 * WHEELBASE)
    return CenterIdentifier(Pose2(*axle, yaw + turn), CONTACT, (0.0, center), doubted)


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("across", [-0.01, 0.0, 0.006])
@pytest.mark.parametrize("believed", [0.0, 0.004])
def test_a_straight_way_gives_the_centre_whatever_it_is_planned_with(
    across, believed, backward
):
    identifier = planned(believed, backward)
    got = driven(identifier, across, [0.0] * 3, backward=backward).center
    assert got[0] == 0.0
    assert got[1] == pytest.approx(across, abs=0.0008)


def test_the_noise_of_poses_leaves_it_within_two_millimetres():
    got = driven(planned(), 0.008, [0.0] * 4, noise=NOISE).center
    assert got[1] == pytest.approx(0.008, abs=0.002)


def test_turns_to_both_sides_tell_the_axle_from_the_heading():
    curvatures = [8.0, 0.0, -8.0, 0.0, 8.0]
    got = driven(planned(), 0.006, curvatures, axle=AXLE + 0.01).center
    assert got[1] == pytest.approx(0.006, abs=0.001)


def test_a_turn_alone_with_the_axle_elsewhere_moves_the_centre_less_than_a_straight_way():
    got = driven(planned(), 0.0, [10.0] * 3, axle=AXLE + 0.01).center
    # taken for the heading's, the axle's error would be 10 mm x 10 / m
    assert abs(got[1]) < 0.5 * 0.01 * 10.0 * CONTACT[0]


def test_what_was_seen_is_kept_from_one_segment_to_the_next():
    identifier = planned()
    state = identifier.carry_over(driven(identifier, 0.008, [0.0] * 3))
    assert state.known > 100.0
    again = driven(planned(state.center[1]), 0.008, [10.0], state)
    assert again.center[1] == pytest.approx(0.008, abs=0.001)


def test_an_object_at_rest_says_nothing():
    identifier = planned()
    state = CenterState()
    for i in range(300):
        state = identifier.step(state, i * DT, Pose2(), (1.0, 0.5), CONTACT)
    assert state.center == (0.0, 0.0)
    assert state.windows == ()


def scene(**doubts):
    body = ObjectModel(Box((0.2, 0.1, 0.08)), 1.0, (0.0, 0.0))
    return Scene(body, Support(friction=0.3), 0.8, (), (), **doubts)


def test_a_belief_that_does_not_say_how_sure_it_is_is_doubted_as_usual():
    got = doubt(scene(), CONTACT, 0.04, 0.06, 0.08)
    assert got.heading == HEADING
    assert got.off_line == pytest.approx(math.radians(2.0))


def test_a_centre_is_looked_for_as_far_off_as_is_believed_possible():
    got = doubt(scene(center_error=0.01), CONTACT, 0.04, 0.06, 0.08)
    distance = math.hypot(*CONTACT)
    assert got.heading == pytest.approx(0.01 / distance)
    assert got.max_share * distance == pytest.approx(0.01 * math.sqrt(2.0))
    assert got.off_line < doubt(scene(), CONTACT, 0.04, 0.06, 0.08).off_line
    # a heading that would put it 30 mm off is another thing's
    heading = CenterIdentifier(Pose2(AXLE, 0.0, 0.0), CONTACT, (0.0, 0.0), got)
    found = driven(heading, 0.03, [0.0] * 3).center
    assert abs(found[1]) == pytest.approx(0.01 * math.sqrt(2.0))


def test_the_friction_moves_the_axle_the_more_the_higher_the_contact_and_the_less_lever():
    def axle(height, lever):
        """Doubt of the axle's position [m]."""
        unsure = scene(friction_error=0.2)
        return doubt(unsure, CONTACT, lever, 0.06, height).axle

    assert axle(0.08, 0.04) - axle(0.0, 0.04) == pytest.approx(0.06 * 0.2 * 0.3 * 2.0)
    assert axle(0.08, 0.02) > axle(0.08, 0.04)


def test_a_sure_belief_is_given_up_for_twice_the_error_of_what_is_seen() -> None:
    aside = 0.06 * CONTACT[0]  # more than two degrees

    def contradicted(doubts: Doubt, off: float) -> bool:
        """Whether a centre that is known to ``off`` [rad] counts as elsewhere."""
        axle = Pose2(AXLE, 0.0, 0.0)
        identifier = CenterIdentifier(axle, CONTACT, (0.0, 0.0), doubts)
        state = CenterState(center=(0.0, aside), off=off)
        return identifier.contradicts(state, (0.0, 0.0))

    assert contradicted(Doubt(), 0.025)
    assert not contradicted(Doubt(), 0.035)
    unsure = doubt(scene(center_error=0.01), CONTACT, 0.04, 0.06, 0.08)
    assert contradicted(unsure, 0.035)


def test_the_more_windows_are_seen_the_better_the_centre_is_known() -> None:
    few = driven(planned(), 0.006, [0.0]).off
    many = driven(planned(), 0.006, [0.0] * 4).off
    assert many < few < HEADING


def test_a_centre_at_its_bound_is_known_by_its_side() -> None:
    """How far it is beyond the bound, nothing tells."""
    unsure = doubt(scene(center_error=0.01), CONTACT, 0.04, 0.06, 0.08)
    axle = Pose2(AXLE, 0.0, 0.0)
    identifier = CenterIdentifier(axle, CONTACT, (0.0, 0.0), unsure)
    lever = math.hypot(*CONTACT)
    bound = unsure.max_share * lever
    inside, outside = (
        identifier.aside(CenterState(center=(0.0, place), off=0.02, filtered=True))
        for place in (0.5 * bound, bound)
    )
    assert inside is not None
    assert outside is not None
    assert outside.value == pytest.approx(math.copysign(bound, outside.value))
    assert outside.deviation > BOUNDED * lever > 2.0 * inside.deviation
    assert (inside.at_bound, outside.at_bound) == (False, True)
