"""A batch runs the kernel that a control loop calls, and answers as it does."""

import inspect
import math

import numpy as np
import pytest

from pushpressslide.allocation import presses as loop_presses
from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.batch import (
    exact_surface,
    fast,
    limit_surface,
    one_contact,
    parallel,
    press_and_push,
    presses,
    two_contacts,
)
from pushpressslide.core.allocation import STATUSES
from pushpressslide.kernels.limit_surface import dragged_wrench, driving_wrench
from pushpressslide.mechanics import height_term, virtual_axle
from pushpressslide.mechanics import limit_surface as single_surfaces

POINT = (-0.1, 0.03)
FORWARD = (1.0, 0.0)
BEHIND = ((-0.1, 0.06), (-0.1, -0.06))
CORNER = (POINT, (0.04, 0.08))
CORNER_NORMALS = (FORWARD, (-0.6, -0.8))
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
    "one press": (
        one_press_allocator(POINT, 2.0, 0.5, RHO),
        presses.OnePress(POINT, 2.0, 0.5, RHO),
        presses.one_press,
    ),
    "press and push": (
        press_and_push_allocator((0.1, 0.0), 2.0, POINT, FORWARD, 0.5),
        press_and_push.PressAndPush((0.1, 0.0), 2.0, POINT, FORWARD, 0.5),
        press_and_push.press_and_push,
    ),
    "two contacts": (
        two_contact_allocator(CORNER, CORNER_NORMALS, 0.5, RHO),
        two_contacts.TwoContacts(CORNER, CORNER_NORMALS, 0.5, RHO),
        two_contacts.two_contacts,
    ),
    "two contacts with caps": (
        two_contact_allocator(CORNER, CORNER_NORMALS, 0.5, RHO, caps=(0.4, 0.3)),
        two_contacts.TwoContacts(CORNER, CORNER_NORMALS, 0.5, RHO, caps=(0.4, 0.3)),
        two_contacts.two_contacts,
    ),
    "parallel pushes": (
        parallel_push_allocator(BEHIND, FORWARD, 0.5, RHO),
        parallel.ParallelPushes(BEHIND, FORWARD, 0.5, RHO),
        parallel.parallel_pushes,
    ),
}


@pytest.mark.parametrize("name", ALLOCATORS)
def test_a_batch_answers_as_the_allocator_of_its_kernel(engine, name):
    allocate, batch, kernel = ALLOCATORS[name]
    assert inspect.getclosurevars(allocate).nonlocals["kernel"] is kernel
    rows = wrenches()
    assert_alike(batch.allocate(rows), [allocate(*row) for row in rows.tolist()])


def test_a_batch_of_two_presses_answers_as_their_allocator(engine):
    assert presses.two_presses is loop_presses.two_presses
    points = (POINT, (0.1, 0.02))
    rows = wrenches()
    normals = np.random.default_rng(1).uniform(-0.1, 4.0, (ROWS, 2))
    cops = np.random.default_rng(2).uniform(-0.1, 0.1, (ROWS, 2))
    allocate = loop_presses.two_press_allocator(points, 0.5)
    batch = presses.TwoPresses(points, 0.5).allocate(rows, normals, cops)
    given = zip(rows.tolist(), normals.tolist(), cops.tolist(), strict=True)
    assert_alike(batch, [allocate(*row, tuple(n), tuple(c)) for row, n, c in given])


def test_limit_surfaces_on_arrays_have_the_kernels_of_single_ones():
    assert exact_surface.exact_slide is single_surfaces.kernels.exact_slide
    assert exact_surface.exact_axle is virtual_axle.exact_axle
    assert limit_surface.driving_wrench is driving_wrench
    called = inspect.getclosurevars(driving_wrench).globals
    assert called["dragged_wrench"] is dragged_wrench is height_term.dragged_wrench


def assert_alike(answers, single):
    """Same statuses, same numbers but for a root or a sine in its last place."""
    assert [STATUSES[i] for i in answers.status.tolist()] == [a.status for a in single]
    assert len({a.status for a in single}) > 1
    for part in ("forces", "normals", "margin", "residual"):
        expected = np.array([getattr(a, part) for a in single])
        np.testing.assert_allclose(
            getattr(answers, part), expected, rtol=1e-12, atol=1e-12
        )


def test_batches_can_leave_numba_out_and_take_it_again(monkeypatch):
    monkeypatch.setattr(fast, "installed", lambda: math)
    assert fast.compiler() is math
    with fast.without_numba():
        assert fast.compiler() is None
    assert fast.compiler() is math
