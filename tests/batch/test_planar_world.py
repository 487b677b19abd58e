"""Many bodies under tips, like one of them on the planar engine."""

import numpy as np
import pytest

from pushpressslide.batch.planar_world import Faces, PlanarWorld, Tips
from pushpressslide.batch.pushing import SEPARATE, SLIP_LEFT, SLIP_RIGHT, STICK
from pushpressslide.batch.support import ellipsoid_support, polygon_support
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import TipCommand
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Robot, Support, Task
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.planar.world import World, resting

BOX = Box((0.15, 0.1, 0.1))
MASS = 1.0  # [kg]
LOAD = MASS * GRAVITY  # [N]
MU = 0.3
RADIUS = 0.02
DAMPING = 300.0
DT = 0.004
TICKS = 60
KINDS = {
    "free": SEPARATE,
    "stick": STICK,
    "slip_left": SLIP_LEFT,
    "slip_right": SLIP_RIGHT,
}
REAR = ((-0.075, 0.0), (1.0, 0.0), (-0.05, 0.05))
RIGHT = ((0.0, -0.05), (0.0, 1.0), (-0.075, 0.075))
FACES = {"one": (REAR,), "same face": (REAR, REAR), "two faces": (REAR, RIGHT)}


def faces(chosen):
    foot, normal, ends = np.swapaxes(np.array(chosen), 0, 1)
    return Faces(foot, normal, ends)


def drawn(rng, chosen, count):
    """Places of the tips and their velocities, in B, and friction."""
    places = np.empty((count, len(chosen), 2))
    for k, (foot, normal, ends) in enumerate(chosen):
        along = rng.uniform(*(0.9 * np.array(ends)), count)
        gap = np.where(rng.random(count) < 0.5, 0.0, rng.uniform(0.0, 2e-3, count))
        n = np.array(normal)
        left = np.array((-n[1], n[0]))
        out = (RADIUS + gap)[:, None] * n
        places[:, k] = np.array(foot) + along[:, None] * left - out
    inwards = np.array([normal for _, normal, _ in chosen])
    velocities = rng.uniform(0.0, 0.08, (count, len(chosen), 1)) * inwards
    velocities += rng.normal(size=velocities.shape) * 0.03
    friction = rng.uniform(0.05, 0.9, count)
    friction[-2:] = 1e-9  # next to none
    return places, velocities, friction


def rotations(angles):
    c = np.cos(angles)
    s = np.sin(angles)
    return np.moveaxis(np.array(((c, -s), (s, c))), -1, 0)


def alone(chosen, places, velocities, friction, X_WB):
    """States of the planar engine for one body; its tips are at no height, so that
    its centre of pressure stays where it is.
    """
    contacts = tuple(
        Contact(i, "side", foot, normal, 0.0)
        for i, (foot, normal, _) in enumerate(chosen)
    )
    robots = tuple(
        Robot("hand", (*X_WB.apply(place), 0.0), tip_radius=RADIUS) for place in places
    )
    task = Task(
        "by-hand",
        ObjectModel(BOX, MASS, (0.0, 0.0)),
        X_WB,
        X_WB,
        robots,
        Support("table", MU),
        contact_friction=friction,
    )
    world = World(task, contacts, DT)
    state = world.start(X_WB, X_WB, 0.0)
    state = state._replace(
        tips=tuple(resting((*X_WB.apply(place), 0.0)) for place in places)
    )
    commands = [
        TipCommand(
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (*velocity, 0.0),
            (0.0, 0.0, 0.0),
            (DAMPING, DAMPING, DAMPING),
            0.0,
            0.0,
            0.0,
            25.0,
            0.0,
        )
        for velocity in velocities
    ]
    for _ in range(TICKS):
        state = world.step(state, commands)
        yield state


@pytest.mark.parametrize("chosen", FACES.values(), ids=FACES.keys())
def test_bodies_go_as_one_on_the_planar_engine(engine, chosen):
    """On the exact surface, under one and two tips."""
    rng = np.random.default_rng(0)
    count = 12
    places, velocities, friction = drawn(rng, chosen, count)
    poses = rng.uniform(-1.0, 1.0, (count, 3))
    face = face_pressure(BOX, (0.0, 0.0), (0.0, 0.0))
    support = polygon_support(face, MU * LOAD)
    world = PlanarWorld(
        support, faces(chosen), Tips(RADIUS, friction[:, None], DAMPING), DT
    )
    turned = rotations(poses[:, 2])
    velocities = np.einsum("nij,nkj->nki", turned, velocities)
    starts = poses[:, None, :2] + np.einsum("nij,nkj->nki", turned, places)
    states = world.initial_states(poses, starts)
    many = []
    for _ in range(TICKS):
        states = world.step(states, velocities)
        many.append(states)
    kinds = set()
    for i in range(count):
        single = alone(
            chosen,
            places[i].tolist(),
            velocities[i].tolist(),
            float(friction[i]),
            Pose2(*poses[i].tolist()),
        )
        for state, batch in zip(single, many, strict=True):
            X = state.X_WB
            assert batch.poses[i] == pytest.approx((X.x, X.y, X.yaw), abs=1e-9)
            for k, tip in enumerate(state.tips):
                assert batch.tips[i, k] == pytest.approx(tip.position[:2], abs=1e-9)
                assert batch.forces[i, k] == pytest.approx(tip.force[:2], abs=1e-5)
                assert batch.kinds[i, k] == KINDS[state.contacts[k]]
                kinds.add(state.contacts[k])
    assert kinds == set(KINDS)


def pushed_apart(**figures):
    """A world of a box on the ellipsoid, with a tip behind it and one in front."""
    chosen = (REAR, ((0.075, 0.0), (-1.0, 0.0), (-0.05, 0.05)))
    tips = {"radius": RADIUS, "friction": 0.5, "damping": DAMPING} | figures
    return PlanarWorld(ellipsoid_support(3.0, 0.06), faces(chosen), Tips(**tips), DT)


def behind(count):
    """A world with so many tips at the rear face."""
    tips = Tips(RADIUS, 0.5, DAMPING)
    return PlanarWorld(ellipsoid_support(3.0, 0.06), faces((REAR,) * count), tips, DT)


def test_a_body_that_no_tip_touches_rests_and_the_tips_fly(engine):
    world = pushed_apart()
    states = world.initial_states((0.1, 0.2, 0.3), [[-0.4, 0.2], [0.4, 0.1]])
    after = world.step(states, [[-0.1, 0.02], [0.1, 0.0]])
    np.testing.assert_array_equal(after.poses, states.poses)
    np.testing.assert_array_equal(after.forces, 0.0)
    np.testing.assert_array_equal(after.kinds, SEPARATE)
    flown = (after.tips - states.tips) / DT
    np.testing.assert_allclose(flown, [[-0.1, 0.02], [0.1, 0.0]], atol=1e-12)


def test_a_tip_beside_its_face_or_behind_it_touches_nothing(engine):
    world = behind(1)
    tips = [[[-0.096, 0.06]], [[-0.09, 0.0]], [[-0.0951, 0.0]]]
    after = world.step(world.initial_states((0.0, 0.0, 0.0), tips), [[0.1, 0.0]])
    assert after.kinds[:, 0].tolist() == [SEPARATE, SEPARATE, STICK]


def test_opposite_tips_beside_the_centre_turn_a_body_on_the_spot(engine):
    world = pushed_apart()
    states = world.initial_states((0.0, 0.0, 0.0), [[-0.095, -0.04], [0.095, 0.04]])
    after = world.step(states, [[0.1, 0.0], [-0.1, 0.0]])
    np.testing.assert_array_equal(after.kinds, STICK)
    assert after.twists[2] > 0.1
    np.testing.assert_allclose(after.twists[:2], 0.0, atol=1e-9)
    # the couple that slides the ellipsoid, from normal and friction forces
    levers = states.tips + np.array([[RADIUS, 0.0], [-RADIUS, 0.0]])
    x, y = np.moveaxis(levers, -1, 0)
    couple = (x * after.forces[:, 1] - y * after.forces[:, 0]).sum()
    assert couple == pytest.approx(3.0 * 0.06, rel=1e-6)


def test_two_tips_that_slip_push_along_the_edges_of_their_cones(engine):
    tips = Tips(RADIUS, 0.2, DAMPING)
    world = PlanarWorld(ellipsoid_support(3.0, 0.06), faces((REAR, REAR)), tips, DT)
    states = world.initial_states((0.0, 0.0, 0.0), [[-0.095, -0.03], [-0.095, 0.03]])
    after = world.step(states, [[[0.05, 0.2]] * 2, [[0.05, -0.2]] * 2])
    assert after.kinds.tolist() == [[SLIP_LEFT] * 2, [SLIP_RIGHT] * 2]
    ratios = after.forces[..., 1] / after.forces[..., 0]
    np.testing.assert_allclose(ratios, [[0.2, 0.2], [-0.2, -0.2]], atol=1e-12)


def test_one_of_two_tips_leaves_and_the_other_pushes_on_as_if_alone(engine):
    world = behind(2)
    states = world.initial_states((0.0, 0.0, 0.0), [[-0.095, -0.03], [-0.095, 0.03]])
    after = world.step(states, [[0.05, 0.0], [-0.05, 0.0]])
    assert after.kinds.tolist() == [STICK, SEPARATE]
    alone = behind(1)
    lone = alone.step(
        alone.initial_states((0.0, 0.0, 0.0), [[-0.095, -0.03]]), [[0.05, 0.0]]
    )
    np.testing.assert_allclose(after.poses, lone.poses, atol=1e-12)
    np.testing.assert_allclose(after.forces[:1], lone.forces, atol=1e-9)


def test_a_push_below_the_limit_leaves_a_body_at_rest(engine):
    world = behind(1)
    states = world.initial_states((0.0, 0.0, 0.0), [[-0.095, 0.0]])
    forces = np.array([[[2.9, 0.0]], [[3.1, 0.0]]])
    after = world.step(states, [[0.0, 0.0]], forces)
    assert abs(after.twists[0]).max() < 1e-6
    assert after.twists[1, 0] == pytest.approx(0.1 / DAMPING, rel=1e-3)
    np.testing.assert_array_equal(after.kinds, STICK)
    np.testing.assert_allclose(after.forces[0], [[2.9, 0.0]], atol=1e-4)


def test_what_is_not_finite_moves_nothing_and_leaves_the_others_alone(engine):
    world = behind(2)
    poses = np.zeros((5, 3))
    tips = np.tile([[-0.095, -0.03], [-0.095, 0.03]], (5, 1, 1))
    velocities = np.tile([[0.05, 0.01], [0.06, 0.0]], (5, 1, 1))
    right = world.step(world.initial_states(poses, tips), velocities)
    poses[1] = np.nan
    tips[2] = np.inf
    velocities[3] = (np.nan, 0.0)
    velocities[4, 0] = (np.inf, 0.0)
    after = world.step(world.initial_states(poses, tips), velocities)
    np.testing.assert_array_equal(after.poses[0], right.poses[0])
    np.testing.assert_array_equal(after.twists[1:4], 0.0)
    assert (after.kinds[1:4] == SEPARATE).all()
    assert (after.forces[1:4] == 0.0).all()
    # the other tip of the last body pushes on
    assert after.kinds[4].tolist() == [SEPARATE, STICK]
    assert np.isfinite(after.poses[4]).all()


def test_any_leading_shape_gives_the_answer_row_by_row(engine):
    rng = np.random.default_rng(4)
    friction = np.array([0.1, 0.6])[:, None, None]
    tips = Tips(RADIUS, friction, DAMPING)
    support = ellipsoid_support([1.0, 2.0, 3.0], 0.06)
    world = PlanarWorld(support, faces((REAR, RIGHT)), tips, DT)
    assert world.shape == (2, 3)
    velocities = rng.normal(size=(4, 1, 1, 2, 2)) * 0.05 + 0.05
    tips_at = [[-0.095, 0.01], [0.02, -0.07]]
    states = world.step(world.initial_states((0.0, 0.0, 0.0), tips_at), velocities)
    states = world.step(states, velocities)
    assert states.poses.shape == (4, 2, 3, 3)
    assert states.forces.shape == (4, 2, 3, 2, 2)
    for i, j, k in np.ndindex(4, 2, 3):
        one = PlanarWorld(
            ellipsoid_support(k + 1.0, 0.06),
            faces((REAR, RIGHT)),
            Tips(RADIUS, float(friction[j, 0, 0]), DAMPING),
            DT,
        )
        alone = one.initial_states((0.0, 0.0, 0.0), tips_at)
        for _ in range(2):
            alone = one.step(alone, velocities[i, 0, 0])
        np.testing.assert_allclose(states.poses[i, j, k], alone.poses, atol=1e-12)
        np.testing.assert_array_equal(states.kinds[i, j, k], alone.kinds)


def test_shapes_and_figures_are_checked():
    with pytest.raises(ValueError, match=r"tips 3; must be 1 or 2"):
        behind(3)
    with pytest.raises(ValueError, match="damping"):
        pushed_apart(damping=0.0)
    with pytest.raises(ValueError, match="radius"):
        pushed_apart(radius=-0.01)
    with pytest.raises(ValueError, match="friction"):
        pushed_apart(friction=np.nan)
    with pytest.raises(ValueError, match=r"foot \(2,\); must be"):
        PlanarWorld(
            ellipsoid_support(1.0, 0.1), Faces(*REAR), Tips(RADIUS, 0.5, 1.0), DT
        )
    world = behind(1)
    with pytest.raises(ValueError, match="velocities"):
        world.step(world.initial_states((0.0, 0.0, 0.0), [[0.0, 0.0]]), [[0.1]])
