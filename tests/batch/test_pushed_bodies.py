"""Many pushed bodies, like one of them by the single form."""

import math

import numpy as np
import pytest

from pushpressslide.batch.pushed_bodies import PushedBodies
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import integrate
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

BODIES = 500
STEPS = 20
DT = 0.02


def test_bodies_go_as_one_by_the_single_form(engine):
    """In contact all the time: stick and slip, to either side."""
    rng = np.random.default_rng(0)
    angles = rng.uniform(-math.pi, math.pi, BODIES)
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    feet = -normals * rng.uniform(0.03, 0.1, (BODIES, 1))
    friction = rng.uniform(0.0, 1.0, BODIES)
    rho = rng.uniform(0.03, 0.1, BODIES)
    places = rng.uniform(-0.05, 0.05, BODIES)
    yaws = rng.uniform(-math.pi, math.pi, BODIES)
    headings = angles + yaws + rng.uniform(-0.6, 0.6, BODIES)
    velocities = 0.05 * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    bodies = PushedBodies(feet, normals, (-1.0, 1.0), friction, rho)
    start = np.column_stack([rng.normal(size=(BODIES, 2)), yaws])
    pushes = bodies.initial_states(start, places)
    for _ in range(STEPS):
        pushes = bodies.advance(pushes, velocities, DT)
    kinds = set()
    for i in range(BODIES):
        X = Pose2(*start[i])
        place = float(places[i])
        nx, ny = normals[i].tolist()
        surface = EllipsoidLimitSurface(1.0, float(rho[i]))
        for _ in range(STEPS):
            contact = (feet[i, 0] - ny * place, feet[i, 1] + nx * place)
            velocity = X.unrotate(tuple(velocities[i].tolist()))
            out = push_outcome(surface, contact, (nx, ny), float(friction[i]), velocity)
            if out.kind == "separate":
                break
            kinds.add(out.kind)
            twist = out.twist
            X = integrate(X, (twist.vx, twist.vy, twist.w), DT)
            place += out.slip_velocity * DT
        else:
            x, y, yaw = pushes.poses[i]
            assert math.dist((x, y), X.position) < 1e-9
            assert abs(math.remainder(yaw - X.yaw, 2.0 * math.pi)) < 1e-9
            assert pushes.places[i] == pytest.approx(place, abs=1e-9)
            assert pushes.gaps[i] == 0.0
    assert kinds == {"stick", "slip_left", "slip_right"}


def test_a_body_rests_until_its_pusher_has_come(engine):
    bodies = PushedBodies((-0.1, 0.0), (1.0, 0.0), (-0.05, 0.05), 0.4, 0.07)
    pushes = bodies.initial_states((0.0, 0.0, 0.0), gaps=[0.004, 0.02])
    pushes = bodies.advance(pushes, (0.1, 0.0), 0.1)
    np.testing.assert_allclose(pushes.poses[:, 0], [0.006, 0.0], atol=1e-12)
    np.testing.assert_allclose(pushes.gaps, [0.0, 0.01], atol=1e-12)
    back = bodies.advance(pushes, (-0.1, 0.0), 0.1)
    np.testing.assert_array_equal(back.poses, pushes.poses)
    np.testing.assert_allclose(back.gaps, [0.01, 0.02], atol=1e-12)


def test_a_pusher_that_comes_beside_the_face_passes_the_body(engine):
    bodies = PushedBodies((-0.1, 0.0), (1.0, 0.0), (-0.05, 0.05), 0.4, 0.07)
    pushes = bodies.initial_states(
        (0.0, 0.0, 0.0), places=[0.06, -0.06, 0.0], gaps=0.005
    )
    for _ in range(3):
        pushes = bodies.advance(pushes, (0.1, 0.0), 0.1)
    assert np.isinf(pushes.gaps).tolist() == [True, True, False]
    np.testing.assert_array_equal(pushes.poses[:2], np.zeros((2, 3)))
    assert pushes.poses[2, 0] == pytest.approx(0.025)


def test_a_pusher_that_slips_over_an_edge_leaves_the_body(engine):
    bodies = PushedBodies((-0.1, 0.0), (1.0, 0.0), (-0.05, 0.05), 0.0, 0.07)
    pushes = bodies.initial_states((0.0, 0.0, 0.0), places=0.045)
    ways = []
    for _ in range(20):
        before = pushes.poses
        pushes = bodies.advance(pushes, (0.02, 0.1), 0.02)
        ways.append(float(np.abs(pushes.poses - before).max()))
    assert ways[0] > 0.0
    assert np.isinf(pushes.gaps)
    assert ways[-1] == 0.0


def test_half_the_step_has_half_the_error(engine):
    """A pusher keeps its direction in the world, a twist its own in the body."""
    bodies = PushedBodies((-0.1, 0.0), (1.0, 0.0), (-1.0, 1.0), 5.0, 0.07)

    def end(steps: int) -> np.ndarray:
        pushes = bodies.initial_states((0.0, 0.0, 0.3), places=0.03)
        for _ in range(steps):
            pushes = bodies.advance(pushes, (0.05, 0.02), 1.0 / steps)
        return pushes.poses

    exact = 2.0 * end(800) - end(400)
    errors = [np.abs(end(steps) - exact).max() for steps in (50, 100, 200)]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.05)
    assert errors[2] < 2e-4


def test_shapes_and_figures_are_checked():
    with pytest.raises(ValueError, match="rho"):
        PushedBodies((-0.1, 0.0), (1.0, 0.0), (-1.0, 1.0), 0.5, 0.0)
    with pytest.raises(ValueError, match="ends"):
        PushedBodies((-0.1, 0.0), (1.0, 0.0), (1.0,), 0.5, 0.07)


def test_results_are_taken_up_as_they_lie_or_copied_alike(engine):
    bodies = PushedBodies((-0.1, 0.0), (1.0, 0.0), (-0.05, 0.05), 0.4, 0.06)
    rng = np.random.default_rng(1)
    first = bodies.initial_states(
        rng.normal(size=(200, 3)), rng.uniform(-0.04, 0.04, 200)
    )
    one = bodies.advance(first, (0.05, 0.01), DT)
    velocities = np.tile((0.04, -0.02), (200, 1))
    lying = bodies.advance(one, np.broadcast_to((0.04, -0.02), (200, 2)), DT)
    copied = bodies.advance(one._replace(poses=one.poses.copy("C")), velocities, DT)
    for a, b in zip(lying, copied, strict=True):
        assert (a == b).all()
