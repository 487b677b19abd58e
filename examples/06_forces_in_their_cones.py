"""A wanted wrench to two contact forces inside their friction cones, one and many."""

import numpy as np

from pushpressslide.batch.two_contacts import TwoContacts

pair = TwoContacts(
    points=((-0.1, 0.04), (-0.1, -0.04)),  # [m] in B
    normals=((1.0, 0.0), (1.0, 0.0)),
    friction=0.5,
    rho=0.08,  # [m] weighs torques against forces
)
one = pair.allocate((2.0, 0.3, 0.02))  # fx, fy [N], tau [N m]
print(one.forces, one.status)  # of each contact; 0 ok, 1 projected, 2 infeasible

wrenches = np.random.default_rng(0).normal(size=(10_000, 3)) * (2.0, 1.0, 0.05)
many = pair.allocate(wrenches)
print(many.forces.shape, f"{many.ok.mean():.0%} are possible")
normal = many.forces[..., 0]
across = many.forces[..., 1]
assert (np.abs(across) <= 0.5 * normal + 1e-9).all()
