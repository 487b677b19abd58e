"""What is identified of the centre of mass on the way, against motions made of the
ellipsoid.
"""

import math
import random

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2, cross
from pushpressslide.core.twist_path import moved
from pushpressslide.identification.center import (
    CenterState,
    PushedCenter,
)
from pushpressslide.mechanics.turning import Turning

DT = 0.004
SPEED = 0.04  # [m/s] of the centre of pressure
RHO = 0.06  # [m]
CONTACT = (-0.075, 0.0)
SIZE = 0.075  # [m]
LEVER = 0.075  # [m]
ACROSS = (0.0, 1.0)


def found(center, angles, believed=RHO, noise=0.0):
    """Return the centre that is identified from forces that turn through ``angles``
    [rad] in B, a second from one to the next; the object turns by an ellipsoid of RHO
    about the centre of pressure.
    """
    rng = random.Random(0)
    turning = Turning((0.0,), (believed * believed,))
    identifier = PushedCenter(ACROSS, LEVER, turning, SIZE)
    state = CenterState()
    pose = Pose2(0.1, 0.2, 0.5)
    x, y = center
    for i in range(int((len(angles) - 1) / DT)):
        angle = float(np.interp(i * DT, range(len(angles)), angles))
        e = (math.cos(angle), math.sin(angle))
        w = SPEED * cross((CONTACT[0] - x, CONTACT[1] - y), e) / RHO**2
        pose = moved(pose, (SPEED * e[0] + w * y, SPEED * e[1] - w * x, w), DT)
        force = (3.0 * e[0] + rng.gauss(0, noise), 3.0 * e[1] + rng.gauss(0, noise))
        state = identifier.step(state, (i + 1) * DT, pose, force, CONTACT)
    return state.center


TURNS = [0.2, -0.2, 0.3, -0.1, 0.0, 0.1]


@pytest.mark.parametrize("across", [-0.01, 0.0, 0.006])
@pytest.mark.parametrize("believed", [0.9 * RHO, RHO, 1.1 * RHO])
def test_curves_to_both_sides_give_the_centre_whatever_rho_is_believed(
    across, believed
):
    got = found((0.0, across), TURNS, believed=believed)
    assert got[0] == 0.0
    assert got[1] == pytest.approx(across, abs=0.001)


def test_a_straight_push_with_noise_gives_the_line_through_the_centre():
    angle = math.atan2(0.008 - CONTACT[1], 0.075)
    got = found((0.0, 0.008), [angle] * 4, noise=0.2)
    assert got[1] == pytest.approx(0.008, abs=0.001)


def test_a_centre_where_it_is_believed_stays_there():
    assert found((0.0, 0.0), TURNS) == pytest.approx((0.0, 0.0), abs=2e-4)


def test_an_object_at_rest_says_nothing():
    identifier = PushedCenter(ACROSS, LEVER, Turning((0.0,), (RHO**2,)), SIZE)
    state = CenterState()
    for i in range(300):
        state = identifier.step(state, i * DT, Pose2(), (1.0, 0.5), CONTACT)
    assert state.center == (0.0, 0.0)
    assert state.windows == ()


def test_what_was_seen_is_kept_from_one_segment_to_the_next():
    identifier = PushedCenter(ACROSS, LEVER, Turning((0.0,), (RHO**2,)), SIZE)
    state = CenterState((0.001, 0.002), pose=Pose2(), slides=True)
    assert identifier.onward(state) == CenterState((0.001, 0.002))
