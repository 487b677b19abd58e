"""Sensors: effect of noise, bias, delay and drop-outs on the controller's measurements."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from pushpressslide.control.cell import Applied, ArmState, Cell, TipAlone
from pushpressslide.control.sensing import DelayLine, sensed
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing

PERIOD = 0.01
COUNT = 4000


def truth(tick: int) -> Measurement:
    """Everything moves with the tick, so that a delay can be told."""
    tip = TipState((1.0 * tick, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 2.0 * tick, 0.0))
    return Measurement(tick * PERIOD, Pose2(3.0 * tick, 0.0, 0.0), (tip, tip))


def still() -> Measurement:
    tip = TipState((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), (4.0, 5.0, 6.0))
    return Measurement(0.0, Pose2(0.1, 0.2, 0.3), (tip,))


class Sensor:
    """A cell in which what is true is told, and what comes out of its sensors."""

    simulated = True
    time = 0.0

    def __init__(self, sensing: Sensing, seed: int, dt: float) -> None:
        self.truth = truth(0)
        tips = [Told(self, 0), Told(self, 1)]
        self.cell = sensed(Cell("told", self, tips, self), sensing, seed, dt)
        self.last = truth(0)

    def advance(self) -> None: ...

    def failure(self) -> None: ...

    def read(self) -> StampedPose:
        return StampedPose(self.time, self.truth.object_pose)

    def measure(self, truth: Measurement) -> Measurement:
        """One tick on."""
        self.time += 1.0
        self.truth = truth
        pose = self.cell.tracker.read()
        arms = self.cell.arms[: len(truth.tips)]
        tips = tuple(arm.read().tip for arm in arms)
        held = self.last.object_pose if pose is None else pose.X_WG
        self.last = Measurement(truth.time, held, tips, pose_seen=pose is not None)
        return self.last


class Told(TipAlone):
    """A tip that is where it is told to be."""

    def __init__(self, told: Sensor, index: int) -> None:
        self.told = told
        self.index = index

    def read(self) -> ArmState:
        return ArmState(self.told.time, self.told.truth.tips[self.index])

    def send(self, command: object) -> Applied:
        return Applied()


def seen(sensing: Sensing, count: int = COUNT, seed: int = 1) -> list[Measurement]:
    sensor = Sensor(sensing, seed, PERIOD)
    return [sensor.measure(still()) for _ in range(count)]


def test_without_imperfections_the_truth_is_seen() -> None:
    assert Sensor(Sensing(), 0, PERIOD).measure(truth(7)) == truth(7)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("position_noise", lambda m: (m.object_pose.x, m.object_pose.y)),
        ("yaw_noise", lambda m: (m.object_pose.yaw,)),
        ("tip_noise", lambda m: m.tips[0].position),
        ("force_noise", lambda m: m.tips[0].force),
    ],
)
def test_noise_has_its_standard_deviation_and_touches_nothing_else(
    field, value
) -> None:
    rows = seen(replace(Sensing(), **{field: 0.02}))
    measured = np.array([value(m) for m in rows])
    error = measured - np.array(value(still()))
    bound = 5.0 / np.sqrt(COUNT)
    assert np.std(error, axis=0) == pytest.approx(0.02, rel=bound)
    assert np.mean(error, axis=0) == pytest.approx(0.0, abs=0.02 * bound)
    for name in ("position_noise", "yaw_noise", "tip_noise", "force_noise"):
        if name != field:
            assert Sensing().__getattribute__(name) == 0.0
    first = rows[0]
    untouched = {
        "position_noise": (first.tips, first.object_pose.yaw),
        "yaw_noise": (first.tips, first.object_pose.position),
        "tip_noise": (first.object_pose, first.tips[0].force),
        "force_noise": (first.object_pose, first.tips[0].position),
    }[field]
    exact = still()
    assert (
        untouched
        == {
            "position_noise": (exact.tips, exact.object_pose.yaw),
            "yaw_noise": (exact.tips, exact.object_pose.position),
            "tip_noise": (exact.object_pose, exact.tips[0].force),
            "force_noise": (exact.object_pose, exact.tips[0].position),
        }[field]
    )


def test_a_bias_is_constant() -> None:
    sensing = Sensing(
        position_bias=(0.01, -0.02),
        yaw_bias=0.03,
        tip_bias=(0.1, 0.2, 0.3),
        force_bias=(1.0, 2.0, 3.0),
    )
    for m in seen(sensing, 3):
        assert m.object_pose.position == pytest.approx((0.11, 0.18))
        assert m.object_pose.yaw == pytest.approx(0.33)
        assert m.tips[0].position == pytest.approx((1.1, 2.2, 3.3))
        assert m.tips[0].force == pytest.approx((5.0, 7.0, 9.0))


def test_each_sensor_has_its_own_delay_and_the_stamp_is_the_present() -> None:
    sensing = Sensing(delay=0.02, pose_delay=0.0, force_delay=0.05)
    sensor = Sensor(sensing, 0, PERIOD)
    for tick in range(20):
        m = sensor.measure(truth(tick))
        assert m.time == tick * PERIOD
        assert m.object_pose.x == 3.0 * tick
        assert m.tips[1].position[0] == max(tick - 2, 0)
        assert m.tips[1].force[1] == 2.0 * max(tick - 5, 0)


def test_a_dropped_pose_is_the_last_one_seen_and_says_so() -> None:
    sensor = Sensor(Sensing(pose_dropout=0.4), 3, PERIOD)
    last = None
    dropped = 0
    for tick in range(COUNT):
        m = sensor.measure(truth(tick))
        if m.pose_seen:
            assert m.object_pose.x == 3.0 * tick
            last = m.object_pose
        else:
            dropped += 1
            assert m.object_pose == last
    assert dropped / COUNT == pytest.approx(0.4, abs=0.04)


def test_one_sensor_more_leaves_the_noise_of_the_others_as_it_was() -> None:
    alone = seen(Sensing(force_noise=0.1), 10)
    both = seen(Sensing(force_noise=0.1, position_noise=0.01, tip_noise=0.01), 10)
    assert [m.tips[0].force for m in alone] == [m.tips[0].force for m in both]


def test_a_seed_has_its_own_noise_and_gives_the_same_again() -> None:
    noisy = Sensing(position_noise=0.01, tip_noise=0.01, force_noise=0.1)
    assert seen(noisy, 5, seed=1) == seen(noisy, 5, seed=1)
    assert seen(noisy, 5, seed=1) != seen(noisy, 5, seed=2)


def test_a_first_pose_is_kept_and_each_tip_has_its_noise() -> None:
    first = Sensor(Sensing(pose_dropout=0.999), 1, PERIOD).measure(still())
    assert first.pose_seen
    assert first.object_pose == still().object_pose
    rows = Sensor(Sensing(tip_noise=0.01, force_noise=0.1), 1, PERIOD).measure(truth(1))
    left, right = rows.tips
    assert left.position != right.position
    assert left.force != right.force
    assert left.velocity == right.velocity == (0.1, 0.0, 0.0)


def test_what_is_dropped_is_late_as_well() -> None:
    """A pose that comes after its delay is the one of its time, or none."""
    sensor = Sensor(Sensing(pose_dropout=0.5, pose_delay=0.03), 3, PERIOD)
    for tick in range(200):
        m = sensor.measure(truth(tick))
        if m.pose_seen:
            assert m.object_pose.x == 3.0 * max(tick - 3, 0)


@pytest.mark.parametrize(("delay", "ticks"), [(0.0, 0), (0.014, 1), (0.016, 2)])
def test_a_delay_is_rounded_to_ticks(delay: float, ticks: int) -> None:
    line: DelayLine[int] = DelayLine(delay, PERIOD)
    out = [line.through(i) for i in range(6)]
    assert out == [max(i - ticks, 0) for i in range(6)]


def test_a_sensor_that_is_full_clips_and_one_that_drops_repeats() -> None:
    for one in seen(Sensing(force_noise=3.0, force_range=5.0), 200):
        assert max(abs(v) for v in one.tips[0].force) <= 5.0
    lost = Sensing(force_noise=1.0, tip_noise=1e-3, force_dropout=0.3, tip_dropout=0.6)
    tips = [one.tips[0] for one in seen(lost, 2000)]
    pairs = list(pairwise(tips))
    same_force = sum(a.force == b.force for a, b in pairs) / len(pairs)
    same_place = sum(a.position == b.position for a, b in pairs) / len(pairs)
    assert same_force == pytest.approx(0.3, abs=0.04)
    assert same_place == pytest.approx(0.6, abs=0.04)
