"""Many truths of a plan run the laws of the run loop and of the planar engine."""

import math

import numpy as np
import pytest

from pushpressslide.batch.rows import answers, spread
from pushpressslide.control import adaptation, estimator, law, tip_motion
from pushpressslide.core import path as core_path
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.kernels import arc_path, leading, path_run, tip_step, tracking
from pushpressslide.kernels.arc_path import wrapped
from pushpressslide.tracking import rear_car, rear_stanley

ROWS = 400
PATH = ArcPath(
    Pose2(0.4, 0.2, 0.3), ((-9.0, 0.21), (0.0, 0.09), (7.0, 0.9), (0.0, 0.16))
)


def test_a_run_is_made_of_the_kernels_of_loop_and_engine():
    assert path_run.one_tip_step is tip_step.one_tip_step
    assert core_path.nearest is path_run.nearest is arc_path.nearest
    assert core_path.trapezoid is path_run.trapezoid
    assert law.paced is path_run.paced is leading.paced
    assert estimator.corrected is path_run.corrected
    assert adaptation.eased_steering_scale is path_run.eased_steering_scale
    assert tip_motion.approached is path_run.approached
    assert rear_car.steered_push is path_run.steered_push is tracking.steered_push
    assert rear_stanley.stanley_steering is path_run.stanley_steering


def test_the_nearest_point_of_a_path_compiled_is_that_of_the_path(engine):
    """On all pieces, beyond the end, and where bends are eased."""
    rng = np.random.default_rng(1)
    s = rng.uniform(0.0, PATH.length + 0.05, ROWS)
    left = rng.uniform(-0.03, 0.03, ROWS)
    poses = [PATH.pose(one) for one in s]
    x = np.array([p.x - a * math.sin(p.yaw) for p, a in zip(poses, left, strict=True)])
    y = np.array([p.y + a * math.cos(p.yaw) for p, a in zip(poses, left, strict=True)])
    behind = s - rng.uniform(0.0, 0.004, ROWS)
    rows = np.column_stack([x, y, behind, np.full(ROWS, 0.012)])
    arrays = tuple(np.array(table) for table in PATH.rows)
    found = answers(arc_path.nearest, spread(rows), arrays=arrays, columns=4)
    wanted = [PATH.nearest(*row) for row in rows.tolist()]
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)
    assert found[:, 0] == pytest.approx(s, abs=1e-9)
    assert found[:, 1] == pytest.approx(-left, abs=1e-9)


@pytest.mark.parametrize("turns", [0.0, 1.0, 2.0, 5.0, 1000.0])
def test_wrapped_angles_have_no_rounding(turns):
    for angle in np.random.default_rng(2).uniform(-math.pi, math.pi, 100).tolist():
        for whole in (turns, -turns):
            far = angle + whole * 2.0 * math.pi
            assert wrapped(far) == math.remainder(far, 2.0 * math.pi)
    assert wrapped(math.pi) == math.pi
