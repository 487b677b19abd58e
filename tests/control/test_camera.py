"""The camera: rate, jitter, coloured noise, drift, resolution, outliers and a freeze."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.control.camera import Camera
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.pose import Pose2
from pushpressslide.core.sensing import Sensing

PERIOD = 0.01


class Moving:
    """An object that moves by a metre in a second."""

    def __init__(self, speed: float) -> None:
        self.tick = -1
        self.speed = speed

    def read(self) -> StampedPose:
        self.tick += 1
        time = self.tick * PERIOD
        return StampedPose(time, Pose2(self.speed * time, 0.0, 0.1))


def pictures(
    sensing: Sensing, count: int, speed: float = 0.0
) -> list[StampedPose | None]:
    camera = Camera(Moving(speed), sensing, np.random.default_rng(4), PERIOD)
    return [camera.read() for _ in range(count)]


def poses(sensing: Sensing, count: int = 4000) -> list[Pose2]:
    return [one.X_WG for one in pictures(sensing, count) if one is not None]


def test_pictures_come_at_their_rate_and_show_the_object_at_their_time() -> None:
    got = pictures(Sensing(pose_rate=25.0, pose_delay=0.03), 100, speed=1.0)
    stamps = [one.time for one in got[3:] if one is not None]
    assert stamps == pytest.approx([0.04 * i for i in range(len(stamps))])
    assert len(stamps) == 25
    assert got[7] is not None
    assert got[7].time == pytest.approx(0.04)
    assert all(one.X_WG.x == pytest.approx(one.time) for one in got if one is not None)


def test_late_pictures_are_newer_than_the_ones_before() -> None:
    sensing = Sensing(pose_delay=0.05, pose_jitter=0.1)
    got = pictures(sensing, 2000)
    ages = [
        PERIOD * i - one.time for i, one in enumerate(got[6:], 6) if one is not None
    ]
    stamps = [one.time for one in got[6:] if one is not None]
    assert stamps == sorted(set(stamps))
    assert min(ages) >= 0.05 - 1e-9
    assert max(ages) <= 0.15 + 1e-9
    assert max(ages) - min(ages) > 0.05
    assert sensing.oldest_pose == pytest.approx(0.15)


def test_coloured_noise_keeps_its_size_and_its_time() -> None:
    x = np.array([p.x for p in poses(Sensing(position_noise=1e-3, noise_time=0.1))])
    assert x.std() == pytest.approx(1e-3, rel=0.15)
    after = np.corrcoef(x[:-10], x[10:])[0, 1]
    assert after == pytest.approx(math.exp(-1.0), abs=0.12)


def test_drift_grows_with_the_root_of_time() -> None:
    x = np.array([p.x for p in poses(Sensing(position_drift=2e-3))])
    steps = x[100::100] - x[:-100:100]
    assert steps.std() == pytest.approx(2e-3, rel=0.35)


def test_a_coarse_camera_rounds() -> None:
    x = np.array([p.x for p in poses(Sensing(position_noise=5e-3, position_step=2e-3))])
    assert np.allclose(x, 2e-3 * np.round(x / 2e-3))
    assert len(set(x.round(6))) > 3


def test_outliers_have_their_share_and_their_distance() -> None:
    got = poses(Sensing(outlier_rate=0.2, outlier_size=0.05))
    wrong = [p for p in got if math.hypot(*p.position) > 1e-6]
    assert len(wrong) / len(got) == pytest.approx(0.2, abs=0.03)
    assert all(math.hypot(*p.position) == pytest.approx(0.05) for p in wrong)
    assert np.std([p.yaw for p in wrong]) > 1.0


def test_a_freeze_repeats_the_last_pose_with_new_stamps() -> None:
    got = pictures(Sensing(freeze=1.0, freeze_start=2.0), 400, speed=1.0)
    frozen = [one for one in got[200:300] if one is not None]
    assert len(frozen) == 100
    assert {round(one.X_WG.x, 9) for one in frozen} == {1.99}
    assert frozen[-1].time == pytest.approx(2.99)
    after = got[301]
    assert after is not None
    assert after.X_WG.x == pytest.approx(3.01)
