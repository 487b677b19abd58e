"""Distances of two arms in closed form."""

import numpy as np
import pytest

from pushpressslide.arms.paths.capsules import _segment_distance, least_distance
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.outline import arm_capsules


def test_the_distance_of_segments_is_that_of_their_nearest_points() -> None:
    rng = np.random.default_rng(0)
    a = rng.normal(size=(200, 2, 3))
    b = rng.normal(size=(200, 2, 3))
    a[:20, 1] = a[:20, 0]  # spheres
    b[10:30, 1] = b[10:30, 0]
    b[30:40] = a[30:40] + rng.normal(size=(10, 1, 3))  # parallel
    u = np.linspace(0.0, 1.0, 201)[:, None]
    on = [c[:, None, 0] + u * (c[:, None, 1] - c[:, None, 0]) for c in (a, b)]
    sampled = np.linalg.norm(on[0][:, :, None] - on[1][:, None], axis=-1).min(
        axis=(1, 2)
    )
    exact = _segment_distance(a, b)
    assert (exact <= sampled + 1e-9).all()
    np.testing.assert_allclose(exact, sampled, atol=0.03)


@pytest.mark.parametrize("name", ["iiwa7", "panda", "hand"])
def test_two_arms_are_as_far_apart_as_they_are_moved(name: str) -> None:
    near, far = (Robot(name, (0.0, y, 0.0)) for y in (0.0, 3.0))
    q = arm_kinematics(near).facts.home[None]
    one = arm_capsules(near, 0)
    other = arm_capsules(far, 1)
    width = 3.0 - least_distance(one, other, q, q, 10.0)
    assert 0.0 < width < 0.6
    assert least_distance(one, arm_capsules(near, 1), q, q, 0.08) < -0.02
