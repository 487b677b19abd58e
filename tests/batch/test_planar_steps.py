"""A compiled tick of the planar engine gives the results of the interpreted one."""

import numpy as np
import pytest

from pushpressslide.batch import fast
from pushpressslide.batch.planar_world import Faces, PlanarWorld, Tips
from pushpressslide.batch.support import (
    ellipsoid_support,
    exact_support,
    polygon_support,
)
from pushpressslide.core import twist_path
from pushpressslide.geometry import sides
from pushpressslide.geometry.shapes import Box
from pushpressslide.kernels import compliant_tip, plane, sliding, tip_step
from pushpressslide.kernels.supports import on_ellipsoid
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.pressure import rectangle_pressure
from pushpressslide.planar import contact, world
from pushpressslide.planar import sliding as planar_sliding

ROWS = 3_000
DT = 0.004
FACE = face_pressure(Box((0.2, 0.12, 0.06)), (0.0, 0.0), (0.0, 0.0))
SUPPORTS = {
    "ellipsoid": ellipsoid_support(3.0, 0.07),
    "polygon": polygon_support(FACE, 3.0),
    "samples": exact_support(rectangle_pressure(0.2, 0.12, 10.0, (0.01, 0.0), 2), 0.3),
}


def test_the_planar_engine_calls_the_kernels_of_the_tick():
    assert contact.side_touch is compliant_tip.side_touch
    assert contact.press_touch is compliant_tip.press_touch
    assert contact.wedged_touch is compliant_tip.wedged_touch
    assert planar_sliding.sliding.slide is sliding.slide
    assert tip_step.slide is sliding.slide
    assert tip_step.side_touch is compliant_tip.side_touch
    for name in ("held_force", "tip_law", "tip_after", "carried_body"):
        assert getattr(world, name) is getattr(tip_step, name)
    assert sides.flat_gap is plane.flat_gap
    assert twist_path.carried is plane.carried


def one_tick(name, count, rows):
    """Random bodies with one or two tips, most near their faces, after a tick from a
    state in motion.
    """
    rng = np.random.default_rng(count)
    foot = [(-0.1, 0.0), (0.0, -0.06)][:count]
    normal = [(1.0, 0.0), (0.0, 1.0)][:count]
    ends = [(-0.06, 0.06), (-0.1, 0.1)][:count]
    friction = rng.uniform(0.0, 1.0, (rows, 1))
    tips = Tips(0.015, friction, rng.uniform(100.0, 3000.0, (rows, 1)))
    bodies = PlanarWorld(SUPPORTS[name], Faces(foot, normal, ends), tips, DT)
    poses = rng.uniform(-3.0, 3.0, (rows, 3))
    along = rng.uniform(-0.06, 0.06, (rows, count))
    gap = np.maximum(rng.uniform(-1e-3, 1e-3, (rows, count)), 0.0)
    x = np.stack([-0.115 - gap[:, 0], along[:, -1]], axis=1)[:, :count]
    y = np.stack([along[:, 0], -0.075 - gap[:, -1]], axis=1)[:, :count]
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    places = np.stack([c * x - s * y, s * x + c * y], axis=-1) + poses[:, None, :2]
    into = np.array(normal) * rng.uniform(-0.02, 0.1, (rows, count, 1))
    v = into + 0.03 * rng.normal(size=(rows, count, 2))
    c, s = c[..., None], s[..., None]
    turned = np.concatenate(
        [c * v[..., :1] - s * v[..., 1:], s * v[..., :1] + c * v[..., 1:]], axis=-1
    )
    states = bodies.initial_states(poses, places)._replace(
        twists=rng.normal(size=(rows, 3)) * (0.05, 0.05, 0.5)
    )
    return bodies.step(states, turned, 0.5 * rng.normal(size=(rows, count, 2)))


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("name", SUPPORTS)
def test_a_compiled_tick_is_the_interpreted_one(name, count):
    """To the bit where the C library gives compiled and interpreted code the same sines,
    else to 1e-12; sums over samples go in another order, and end in balance elsewhere.
    """
    near = 1e-8 if name == "samples" else 1e-12
    if fast.compiler() is None:
        pytest.skip("numba is not installed: pip install 'pushpressslide[fast]'")
    rows = ROWS if name == "polygon" else ROWS // 5
    compiled = one_tick(name, count, rows)
    with fast.without_numba():
        interpreted = one_tick(name, count, rows)
    assert set(np.unique(compiled.kinds)) == {0, 1, 2, 3}
    np.testing.assert_array_equal(compiled.kinds, interpreted.kinds)
    for part in ("poses", "tips", "twists", "forces"):
        a = getattr(compiled, part)
        b = getattr(interpreted, part)
        np.testing.assert_allclose(a, b, rtol=near, atol=near)


def test_a_twist_beyond_all_numbers_is_no_balance():
    """There squares overflow, friction is zero, and no tip touches."""
    contact = (
        (-0.1, 0.0),
        (-0.115, 0.0),
        ((1.0, 0.0), (5.0, 0.0), (9.0, 9.0)),
        0.5,
        0.0,
    )
    laws = (on_ellipsoid, compliant_tip.side_touch)
    support = (0.07, 3.0, 0.07)
    lost = (1e171, 0.0, 0.0)
    assert not sliding.solved(lost, sliding.FREED, (contact,), support, laws)[0]
    vx, vy, w = sliding.slide(lost, (contact,), support, laws)
    assert (vx, vy, w) == pytest.approx((2.0 / 9.0, 0.0, 0.0), abs=1e-6)
