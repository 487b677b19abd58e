"""Objects with which a simulation cannot continue."""

from __future__ import annotations

import math

import pytest

from pushpressslide.arms.arm_cell import FAR, TIPPED, lost_object
from pushpressslide.core.pose import Pose2
from pushpressslide.core.spatial_pose import tilt_of
from pushpressslide.core.support_frame import TABLE, SupportFrame

ENDS = (Pose2(0.4, 0.0, 0.0), Pose2(0.6, 0.1, 1.0))
ON_WALL = SupportFrame(
    (0.5, 0.0, 0.3), ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
)


def test_an_object_that_leans_too_far_has_tipped_over() -> None:
    assert lost_object(1.0, ENDS[0], ENDS, None, 0.9 * TIPPED) is None
    text = lost_object(1.0, ENDS[0], ENDS, None, 1.1 * TIPPED)
    assert text == "the object has tipped and fallen over at (0.40, 0.00)"


def test_an_object_far_off_or_below_its_support_is_lost() -> None:
    far = Pose2(0.6 + 1.1 * FAR, 0.1, 0.0)
    assert lost_object(1.0, far, ENDS, None) is not None
    assert lost_object(math.nan, ENDS[0], ENDS, None) is not None
    assert lost_object(1.0, ENDS[0], ENDS, 0.01) is None
    assert "fallen" in str(lost_object(1.0, ENDS[0], ENDS, -0.01))


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5])
@pytest.mark.parametrize("lean", [0.0, 0.3, 1.2])
def test_a_lean_is_the_same_whatever_the_yaw(yaw: float, lean: float) -> None:
    """About x after the yaw: q = q_z(yaw) q_x(lean)."""
    cz, sz = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    cx, sx = math.cos(0.5 * lean), math.sin(0.5 * lean)
    quaternion = (cz * cx, cz * sx, sz * sx, sz * cx)
    assert tilt_of(quaternion, TABLE) == pytest.approx(lean, abs=1e-7)


def test_an_object_on_a_wall_stands_across_it() -> None:
    half = math.sqrt(0.5)
    along_x = (half, 0.0, half, 0.0)  # its z axis along the world's x axis
    assert tilt_of(along_x, ON_WALL) == pytest.approx(0.0, abs=1e-7)
    assert tilt_of((1.0, 0.0, 0.0, 0.0), ON_WALL) == pytest.approx(0.5 * math.pi)
