"""A batch runs the kernel that a control loop calls, and answers as it does."""

import inspect
import math

import numpy as np
import pytest

from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.batch import one_contact
from pushpressslide.core.allocation import STATUSES

POINT = (-0.1, 0.03)
FORWARD = (1.0, 0.0)
RHO = 0.08
ROWS = 300


def wrenches():
    """Random ones, some that one contact gives, and some that are no numbers."""
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(ROWS, 3)) * (1.0, 1.0, 0.05)
    rows[:50, 1] = 0.3 * rows[:50, 0]
    rows[:50, 2] = POINT[0] * rows[:50, 1] - POINT[1] * rows[:50, 0]
    rows[50:70, 2] = 0.0
    rows[70] = 0.0
    rows[71:74] = math.nan, math.inf, -math.inf
    return rows


ALLOCATORS = {
    "one contact": (
        one_contact_allocator(POINT, FORWARD, 0.5, RHO),
        one_contact.OneContact(POINT, FORWARD, 0.5, RHO),
        one_contact.one_contact,
    ),
}


@pytest.mark.parametrize("name", ALLOCATORS)
def test_a_batch_answers_as_the_allocator_of_its_kernel(engine, name):
    allocate, batch, kernel = ALLOCATORS[name]
    assert inspect.getclosurevars(allocate).nonlocals["kernel"] is kernel
    rows = wrenches()
    answers = batch.allocate(rows)
    single = [allocate(*row) for row in rows.tolist()]
    assert [STATUSES[i] for i in answers.status.tolist()] == [a.status for a in single]
    assert len({a.status for a in single}) > 1
    for part in ("forces", "normals", "margin", "residual"):
        expected = np.array([getattr(a, part) for a in single])
        np.testing.assert_allclose(
            getattr(answers, part), expected, rtol=1e-12, atol=1e-12
        )
