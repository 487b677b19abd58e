"""The allocators on arrays give what they give one call at a time."""

import math

import numpy as np
import pytest

from pushpressslide.allocation.batch import press_forces, push_forces
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator

RHO = 0.08
PAIRS = (
    (((-0.1, 0.0), (0.0, 0.1)), ((1.0, 0.0), (0.0, -1.0))),
    (((-0.1, 0.06), (-0.1, -0.06)), ((1.0, 0.0), (1.0, 0.0))),
    (((-0.1, 0.03), (0.04, 0.08)), ((1.0, 0.0), (-0.6, -0.8))),
)


@pytest.mark.parametrize("split", ["least_friction", "least_force"])
@pytest.mark.parametrize("mu", [0.3, 1.0, 1.2])
@pytest.mark.parametrize(("points", "normals"), PAIRS)
def test_pushes(points, normals, mu, split):
    wrenches = np.random.default_rng(0).normal(size=(400, 3)) * (1.0, 1.0, 0.05)
    forces, feasible = push_forces(points, normals, mu, wrenches, split=split)
    allocate = two_contact_allocator(points, normals, mu, RHO, split=split)
    single = [allocate(*w) for w in wrenches.tolist()]
    assert feasible.tolist() == [a.status == "ok" for a in single]
    assert feasible.any()
    expected = np.array([a.forces for a in single])
    assert np.abs(forces - expected)[feasible].max() < 1e-9


def test_presses():
    rng = np.random.default_rng(1)
    points = ((-0.1, 0.2), (0.15, -0.2))
    wrenches = rng.normal(size=(400, 3)) * (1.0, 1.0, 0.1)
    normals = rng.uniform(0.0, 5.0, (400, 2))
    cops = rng.uniform(-0.1, 0.1, (400, 2))
    forces, feasible = press_forces(points, 0.5, wrenches, normals, cops)
    allocate = two_press_allocator(points, 0.5)
    single = [
        allocate(*w, tuple(n), tuple(c))
        for w, n, c in zip(
            wrenches.tolist(), normals.tolist(), cops.tolist(), strict=True
        )
    ]
    assert feasible.tolist() == [a.status == "ok" for a in single]
    assert 50 < feasible.sum() < 350
    assert np.abs(forces - np.array([a.forces for a in single]))[feasible].max() < 1e-12
    assert not any(math.isnan(x) for x in forces.ravel())
