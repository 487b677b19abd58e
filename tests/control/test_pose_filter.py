"""The filter of the object's pose: late, wrong, repeated and noisy pictures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from pushpressslide.control import pose_filter
from pushpressslide.control.camera import Camera
from pushpressslide.control.hand_eye import OTHERWISE, HandEye
from pushpressslide.control.pose_filter import (
    CHANGED,
    HAND_EYE,
    STRANGERS,
    Advance,
    FilterState,
    Mean,
    PoseFilter,
)
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.sensing import Sensing
from pushpressslide.mechanics.contacts import force_of_velocity

PERIOD = 0.004
SPEED = 0.05  # [m/s] of the tip
RADIUS = 0.1
POINT = (-0.07, 0.02)
NOISY = Sensing(
    position_noise=1e-3, yaw_noise=math.radians(0.5), pose_rate=30.0, pose_delay=0.08
)
STRAIGHT = (0.0, 0.0)  # turn arm of an object that does not turn
FILTER = PoseFilter.for_sensing(NOISY, POINT, RADIUS)
LEARNT = [0, 1, 2, 3, 4, 5, 7, 8]  # of the state, where no tip touches


def advances(count: int, turn: float = 0.0, curve: float = 0.3) -> Iterator[Advance]:
    """Ticks in which a tip leads the object along a curve."""
    for i in range(1, count + 1):
        heading = curve * i * PERIOD
        path = SPEED * PERIOD
        tip = (path * math.cos(heading), path * math.sin(heading))
        yield Advance(i * PERIOD, PERIOD, tip, turn)


def start(mean: Mean | None = None) -> FilterState:
    pose = FILTER.pose(mean or Mean(0.0, 0.0, 0.4))
    return FILTER.start(StampedPose(0.0, pose))


def followed(
    arm: tuple[float, float], seconds: float, curve: float = 0.3
) -> tuple[FilterState, Mean]:
    """State after pictures without errors of an object with the turn ``arm`` [rad/m],
    and its true state. The tip's direction turns by ``curve`` [rad/s].
    """
    true = Mean(0.0, 0.0, 0.4, *arm)
    state = start(true)
    ticks = advances(round(seconds / PERIOD), curve=curve)
    for i, advance in enumerate(ticks, start=1):
        true = true.after(advance)
        seen = StampedPose(advance.time, FILTER.pose(true)) if i % 8 == 0 else None
        state = FILTER.step(state, advance, seen)
    return state, true


def off(pose: Pose2, by: float) -> Pose2:
    return Pose2(pose.x + by, pose.y - by, pose.yaw + 0.5)


@pytest.mark.parametrize("late", [1, 5, 30])
def test_late_pictures_count_at_their_own_time(late: int) -> None:
    """In the end the estimate is that of timely pictures."""
    ticks = list(advances(200))
    random = np.random.default_rng(3)
    true = Mean(0.0, 0.0, 0.4, -1.0, 0.5)
    taken = {}
    for i, advance in enumerate(ticks[:-late]):
        true = true.after(advance)
        if i % 8 == 0:
            x, y, yaw = (FILTER.noise * random.normal(size=3)).tolist()
            pose = FILTER.pose(true._replace(yaw=true.yaw + yaw))
            taken[i] = StampedPose(
                advance.time, Pose2(pose.x + x, pose.y + y, pose.yaw)
            )
    timely = start()
    delayed = timely
    for i, advance in enumerate(ticks):
        timely = FILTER.step(timely, advance, taken.get(i))
        delayed = FILTER.step(delayed, advance, taken.get(i - late))
    assert delayed.present == pytest.approx(timely.present, abs=1e-12)
    assert delayed.used == timely.used
    np.testing.assert_allclose(delayed.covariance, timely.covariance, atol=1e-15)


def test_a_picture_that_does_not_fit_does_not_move_the_estimate() -> None:
    state, true = followed(STRAIGHT, 1.0)
    advance = Advance(1.0 + PERIOD, PERIOD)
    outlier = StampedPose(advance.time, off(FILTER.pose(true), 0.05))
    after = FILTER.step(state, advance, outlier)
    assert after.present == FILTER.step(state, advance, None).present
    assert after.used == state.used


def test_pictures_that_agree_replace_the_estimate() -> None:
    state, true = followed(STRAIGHT, 1.0)
    elsewhere = off(FILTER.pose(true), 0.05)
    for i in range(1, STRANGERS + 1):
        before = state.present
        advance = Advance(1.0 + i * PERIOD, PERIOD)
        seen = Pose2(elsewhere.x + 1e-4 * i, elsewhere.y, elsewhere.yaw)
        state = FILTER.step(state, advance, StampedPose(advance.time, seen))
        assert (state.present == before) == (i < STRANGERS)
    there = FILTER.pose(state.present)
    assert there.position == pytest.approx(elsewhere.position, abs=1e-3)


def test_pictures_that_disagree_replace_nothing() -> None:
    state, true = followed(STRAIGHT, 1.0)
    before = state.present
    for i in range(1, 3 * STRANGERS):
        advance = Advance(1.0 + i * PERIOD, PERIOD)
        elsewhere = off(FILTER.pose(true), 0.05 * (-1) ** i)
        state = FILTER.step(state, advance, StampedPose(advance.time, elsewhere))
    assert state.present == before


def test_a_repeated_picture_is_no_news() -> None:
    """Its stamp may be new: its pose still has the age of the first one."""
    state, _ = followed(STRAIGHT, 1.0)
    frozen = state.pose.X_WG
    used = state.used
    for i in range(1, 50):
        advance = Advance(1.0 + i * PERIOD, PERIOD, (SPEED * PERIOD, 0.0))
        alone = FILTER.step(state, advance, None).present
        state = FILTER.step(state, advance, StampedPose(advance.time, frozen))
        assert state.present == alone
    assert state.used == used


ARMS = [(-3.0, 1.0), (2.5, 0.0), (-1.0, -4.0)]


@pytest.mark.parametrize("arm", ARMS)
def test_an_unknown_turn_arm_is_learnt(arm: tuple[float, float]) -> None:
    state, true = followed(arm, 8.0, curve=1.5)
    assert (state.mean.a, state.mean.b) == pytest.approx(
        arm, abs=0.1 * math.hypot(*arm)
    )
    blind = [Advance(8.0 + i * PERIOD, PERIOD, (2e-4, 0.0)) for i in range(1, 251)]
    turned = 0.0
    for advance in blind:  # 50 mm without a picture
        before = true.yaw
        true = true.after(advance)
        turned += abs(true.yaw - before)
        state = FILTER.step(state, advance, None)
    assert turned > 0.02
    assert state.present.yaw == pytest.approx(true.yaw, abs=0.15 * turned)


def test_a_turn_arm_is_that_of_a_pushed_ellipsoid() -> None:
    """A contact at r that moves by d turns the object by (r x d) / (rho^2 + r^2), as by
    the force that moves it so (mechanics/contacts.py).
    """
    lever = (-0.06, 0.02)
    rho = 0.05
    step = (2e-5, 1e-5)
    force = force_of_velocity(lever, rho, step)
    moment = lever[0] * force[1] - lever[1] * force[0]
    square = rho**2 + lever[0] ** 2 + lever[1] ** 2
    mean = Mean(0.0, 0.0, 0.0, lever[0] / square, lever[1] / square)
    turned = mean.after(Advance(PERIOD, PERIOD, step)).yaw
    assert turned == pytest.approx(moment / rho**2, rel=1e-9)


@pytest.mark.parametrize("arm", ARMS)
def test_the_line_to_the_center_and_the_axle_are_found(
    arm: tuple[float, float],
) -> None:
    state, _ = followed(arm, 8.0, curve=1.5)
    angle, deviation = FILTER.line(state)
    off = wrap_angle(angle - math.atan2(arm[1], arm[0]))
    assert abs(off) < min(3.0 * deviation, math.radians(5.0))
    reach, doubt = FILTER.reach(state)
    assert reach == pytest.approx(1.0 / math.hypot(*arm), abs=3.0 * doubt)
    assert doubt < 0.15 * reach


def test_an_arm_of_length_zero_has_no_line() -> None:
    assert FILTER.line(start())[1] == math.inf
    assert FILTER.reach(start()) == (math.inf, math.inf)


def drawn(advance: Advance, true: Mean, random: np.random.Generator) -> Mean:
    """Next state of an object that moves as the filter believes."""
    path = math.hypot(*advance.tip)
    growth = FILTER._growth([advance], path)
    errors = np.sqrt(growth) * random.normal(size=9)
    return Mean(*(np.array(true.after(advance)) + errors).tolist())


def weighed_error(seed: int) -> float:
    """Normalised squared error of the filter on its own model, after 2 s."""
    random = np.random.default_rng(seed)
    state = start()
    errors = np.zeros(9)
    P = state.covariance[np.ix_(LEARNT, LEARNT)]
    errors[LEARNT] = np.linalg.cholesky(P) @ random.normal(size=len(LEARNT))
    true = Mean(*(np.array(state.mean) + errors).tolist())
    for i, advance in enumerate(advances(504, turn=2e-4), start=1):
        true = drawn(advance, true, random)
        seen = None
        if i % 8 == 0:
            pose = FILTER.pose(true)
            x, y, yaw = (FILTER.noise * random.normal(size=3)).tolist()
            seen = StampedPose(
                advance.time, Pose2(pose.x + x, pose.y + y, pose.yaw + yaw)
            )
        state = FILTER.step(state, advance, seen)
    error = (np.array(true) - np.array(state.mean))[LEARNT]
    P = state.covariance[np.ix_(LEARNT, LEARNT)]
    return float(error @ np.linalg.solve(P, error))


def test_the_filter_knows_its_own_errors() -> None:
    """The mean of squared errors over their covariance is in its 95 % band."""
    runs = 50
    mean = np.mean([weighed_error(seed) for seed in range(runs)])
    lowest, highest = chi2.ppf((0.025, 0.975), len(LEARNT) * runs) / runs
    assert lowest < mean < highest


def test_a_tip_along_its_face_slips_along_it_only() -> None:
    """A push into the face moves the object, however far the tip slips."""
    slipping = Mean(0.0, 0.0, 0.5 * math.pi, slip=0.4)
    into = Advance(1.0, 1.0, (0.0, 0.01))  # along the body's x axis
    across = Advance(1.0, 1.0, (0.01, 0.0))
    face = (0.0, 1.0)
    assert slipping.after(into, face).y == pytest.approx(0.01)
    assert slipping.after(across, face).x == pytest.approx(0.006)
    assert slipping.after(into).y == pytest.approx(0.006)


@pytest.mark.parametrize("moves", [True, False])
def test_pictures_tell_whether_a_touching_tip_moves_the_object(moves: bool) -> None:
    """Its motion does not count before, and nothing moves by the tip's motion alone."""
    state = start()
    true = state.mean
    speed = 0.012
    for i in range(1, 501):
        tip = (speed * PERIOD * math.cos(0.4), speed * PERIOD * math.sin(0.4))
        advance = Advance(i * PERIOD, PERIOD, tip, disturbed=True, touching=True)
        if moves:
            true = true._replace(x=true.x + tip[0], y=true.y + tip[1])
        seen = StampedPose(advance.time, FILTER.pose(true)) if i % 8 == 0 else None
        state = FILTER.step(state, advance, seen)
        if i == 7:
            assert state.present.x == start().present.x
    assert state.mean.pushed == pytest.approx(float(moves), abs=0.1)
    assert state.present.x == pytest.approx(true.x, abs=5e-4)


def test_a_turn_shows_that_a_tip_touches_beside_its_place() -> None:
    """Its error is the vector from where it is measured to where it is."""
    along = (0.0, 1.0)
    own = PoseFilter.for_sensing(NOISY, POINT, RADIUS, along=along)
    beside = (0.002, -0.0015)
    true = Mean(0.0, 0.0, 0.4, -6.0, 4.0, ox=beside[0], oy=beside[1])
    pose = own.pose(true)
    state = own.start(StampedPose(0.0, pose))
    assert own.pose(state.mean) == pytest.approx(pose)
    before = own.touch_offset(state, (1.0, 0.0))
    for i, advance in enumerate(advances(5000), start=1):
        true = true.after(advance, along)
        seen = StampedPose(advance.time, own.pose(true)) if i % 8 == 0 else None
        state = own.step(state, advance, seen)
    assert abs(true.yaw - 0.4) > 1.0
    after = own.touch_offset(state, (1.0, 0.0))
    assert before == pytest.approx((0.0, min(HAND_EYE, 2.0 * NOISY.position_noise)))
    assert after[0] == pytest.approx(beside[0], rel=0.5)
    assert after[1] < 0.8 * before[1]
    assert state.mean.oy == pytest.approx(beside[1], rel=0.5)


class Led:
    """An object that a tip leads along a curve, and that turns besides."""

    def __init__(self) -> None:
        self.time = 0.0
        self.true = Mean(0.3, -0.1, 0.4, -1.5, 0.5)

    def read(self) -> StampedPose:
        return StampedPose(self.time, FILTER.pose(self.true))


def test_the_estimate_is_better_than_the_pictures() -> None:
    raw = []
    estimated = []
    for seed in range(5):
        led = Led()
        camera = Camera(led, NOISY, np.random.default_rng(seed), PERIOD)
        last = camera.read()
        assert last is not None
        state = FILTER.start(last)
        for advance in advances(1500):
            led.time = advance.time
            led.true = led.true.after(advance)
            seen = camera.read()
            state = FILTER.step(state, advance, seen)
            last = seen or last
            true = FILTER.pose(led.true)
            raw.append(difference(last.X_WG, true))
            estimated.append(difference(FILTER.pose(state.present), true))
    shares = rms(estimated) / rms(raw)
    assert (shares < 0.7).all()


def difference(pose: Pose2, true: Pose2) -> tuple[float, float]:
    return (math.dist(pose.position, true.position), wrap_angle(pose.yaw - true.yaw))


def rms(errors: list[tuple[float, float]]) -> Array:
    """Root mean squares (2,) of errors of place [m] and yaw [rad]."""
    out: Array = np.sqrt(np.mean(np.square(errors), axis=0))
    return out


def test_a_force_in_another_direction_turns_the_arm_and_makes_it_less_certain() -> None:
    state = start(Mean(0.0, 0.0, 0.4, 3.0, 1.0))
    state = state._replace(mean=state.mean._replace(a=3.0, b=1.0))
    turned = FILTER.rescaled(state, 0.5 * math.pi, 2.0)
    for mean in (turned.mean, turned.present):
        assert (mean.a, mean.b) == pytest.approx((-2.0, 6.0))
        assert mean[:3] == state.mean[:3]
    grown = np.diag(turned.covariance - state.covariance)[3:5]
    np.testing.assert_allclose(grown, (CHANGED * np.array((5.0, 5.0))) ** 2)
    np.testing.assert_array_equal(turned.covariance[:3, :3], state.covariance[:3, :3])
    same = FILTER.rescaled(state, 0.0, 1.0)
    np.testing.assert_allclose(same.covariance, state.covariance)


def test_equal_pictures_of_an_object_at_rest_are_news_without_noise() -> None:
    """A camera without noise sees an object that stands still in one place. Arms that
    wait for news would wait for ever.
    """
    exact = PoseFilter.for_sensing(Sensing(pose_rate=10.0), (0.0, 0.0), 0.1)
    X_WG = Pose2(0.4, 0.1, 0.3)
    state = exact.start(StampedPose(0.0, X_WG))
    for i in range(1, 6):
        time = 0.1 * i
        state = exact.step(state, Advance(time, 0.1), StampedPose(time, X_WG))
        assert state.used == time
    used = state.used
    for i in range(6, 12):  # the tip drives it on, and the camera has stopped
        advance = Advance(0.1 * i, 0.1, (0.005, 0.0))
        state = exact.step(state, advance, StampedPose(0.1 * i, X_WG))
    assert state.used == used


def lost_by(seed: int) -> float:
    """Error of the yaw [rad] of an object that two tips have turned for 5 s, and over
    which they have slid for 2 s.
    """
    coarse = Sensing(position_noise=3.5e-3, yaw_noise=math.radians(2.1), pose_rate=10.0)
    random = np.random.default_rng(seed)
    own = PoseFilter.for_sensing(coarse, (0.0, 0.0), RADIUS)
    true = Pose2(0.0, 0.0, 0.4)
    state = own.start(StampedPose(0.0, true, 30))
    for i in range(1, 1751):
        turn = 0.06 * PERIOD
        if i <= 1250:
            true = replace(true, yaw=true.yaw + turn)
        x, y, yaw = own.noise * random.standard_normal(3)
        seen = Pose2(true.x + x, true.y + y, true.yaw + yaw)
        picture = StampedPose(i * PERIOD, seen) if i % 25 == 0 else None
        state = own.step(state, Advance(i * PERIOD, PERIOD, turn=turn), picture)
    return abs(wrap_angle(state.present.yaw - true.yaw))


def test_pictures_that_all_contradict_the_motion_are_believed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each of them alone could be an error of the camera."""
    believed = [lost_by(seed) for seed in range(20)]
    monkeypatch.setattr(pose_filter, "CONTRADICTED", math.inf)
    ignored = [lost_by(seed) for seed in range(20)]
    assert np.mean(believed) < 0.5 * np.mean(ignored)


@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2])
def test_the_known_offset_of_a_tip_narrows_where_it_touches(yaw: float) -> None:
    """A tip known along x alone is known along that direction of the object alone."""
    known = HandEye((3e-3, 0.0), 1e-6, 0.0, HAND_EYE**2)
    one = replace(FILTER, hand_eye=known)
    state = one.start(StampedPose(0.0, Pose2(0.1, 0.2, yaw)))
    along = (math.cos(yaw), -math.sin(yaw))  # world x in G
    across = (math.sin(yaw), math.cos(yaw))
    assert one.touch_offset(state, along)[1] == pytest.approx(1e-3)
    assert one.touch_offset(state, across)[1] == pytest.approx(HAND_EYE)
    again = HandEye.from_axes((3e-3, 0.0), one.tip_covariance(state), yaw)
    assert again.offset == known.offset
    assert again[1:] == pytest.approx(known[1:])


@pytest.mark.parametrize("lets_go", [True, False])
@pytest.mark.parametrize("pushes", [True, False])
def test_turns_of_a_push_are_forgotten_as_it_touches_again(
    pushes: bool, lets_go: bool
) -> None:
    """It may have slid. A press creeps, and its turns are those of a tip that sticks."""
    one = replace(FILTER, along=(0.0, 1.0) if pushes else None)
    state = one.start(StampedPose(0.0, Pose2(0.1, 0.2, 0.4)))
    before = state.covariance[3:5, 3:5]
    known = state.covariance.copy()
    known[3:5, 3:5] *= 0.1
    learnt = state.mean._replace(a=4.0, b=-2.0)
    state = state._replace(mean=learnt, present=learnt, covariance=known)
    touch = Advance(PERIOD, PERIOD, disturbed=True, lets_go=lets_go)
    touched = one.step(state, touch, None)
    forgotten = pushes and not lets_go
    for mean in (touched.mean, touched.present):
        assert (mean.a, mean.b) == (one.arm if forgotten else (4.0, -2.0))
        assert one.pose(mean).position == pytest.approx((0.1, 0.2))
    expected = before if forgotten else 0.1 * before
    assert touched.covariance[3:5, 3:5] == pytest.approx(expected)


def test_a_tip_in_another_posture_is_known_less() -> None:
    seen = HandEye((3e-3, -1e-3), 1e-6, 2e-7, 4e-6)
    moved = seen.elsewhere()
    assert moved.offset == seen.offset
    assert math.sqrt(moved.xx - seen.xx) == pytest.approx(OTHERWISE)
    assert math.sqrt(moved.yy - seen.yy) == pytest.approx(OTHERWISE)
    assert moved.xy == seen.xy
