"""Many bodies under tips, like one of them on the planar engine."""

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.batch.planar_world import Faces, PlanarWorld, Tips
from pushpressslide.batch.pushing import SEPARATE, SLIP_LEFT, SLIP_RIGHT, STICK
from pushpressslide.batch.support import ellipsoid_support, exact_support
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import TipCommand
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, ObjectModel, Robot, Support, Task
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.planar.support import RESOLUTION
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
    return places, velocities, rng.uniform(0.05, 0.9, count)


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
    state = replace(
        state, tips=tuple(resting((*X_WB.apply(place), 0.0)) for place in places)
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
    support = exact_support(support_pressure(BOX, LOAD, resolution=RESOLUTION), MU)
    world = PlanarWorld(
        support, faces(chosen), Tips(RADIUS, friction[:, None], DAMPING), DT
    )
    turned = rotations(poses[:, 2])
    velocities = np.einsum("nij,nkj->nki", turned, velocities)
    starts = poses[:, None, :2] + np.einsum("nij,nkj->nki", turned, places)
    states = world.begin(poses, starts)
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
