"""The twists that two side contacts can drive (docs/mechanics.md, sections 6 and 9)."""

import math
import random

import numpy as np
import pytest

from pushpressslide.allocation.orthogonal import feasibility
from pushpressslide.allocation.twist_cone import INWARD, TwistCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.plan import Contact
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.friction import cone_edges
from pushpressslide.mechanics.height_term import DraggedSurface

D = 0.2
MU = 0.5
RHO = 0.12
SURFACE = DraggedSurface(6.0, RHO, 0.02, (0.004, -0.003))
ORTHOGONAL = (
    Contact(0, "side", (0.0, D), (0.0, -1.0), 0.05),
    Contact(1, "side", (-D, 0.0), (1.0, 0.0), 0.05),
)
CONE = TwistCone(ORTHOGONAL, MU, SURFACE)


def random_twists(count: int) -> list[tuple[float, float, float]]:
    rng = random.Random(3)
    return [
        (rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1) / RHO) for _ in range(count)
    ]


def test_it_says_inside_exactly_where_the_inequalities_of_section_6_do() -> None:
    inside = 0
    for twist in random_twists(2000):
        wrench = CONE.wrench(*twist)
        possible = feasibility(wrench.fx, wrench.fy, wrench.tau, D, MU).feasible
        assert (CONE.cone_margin(*twist) >= 0.0) == possible
        inside += possible
    assert 60 < inside < 400  # 6 to 16 percent of all directions, more for this rho


def test_many_twists_at_once_have_the_spare_of_each() -> None:
    twists = random_twists(200)
    assert CONE.cone_margins(np.array(twists)) == pytest.approx(
        [CONE.cone_margin(*twist) for twist in twists], abs=1e-12
    )


def test_the_wrench_is_the_one_that_drives_the_twist_of_the_com() -> None:
    for twist in random_twists(50):
        wrench = CONE.wrench(*twist)
        driven = SURFACE.twist_direction(wrench).moved_to((0.0, 0.0))
        k = math.hypot(*twist[:2]) / math.hypot(driven.vx, driven.vy)
        assert (k * driven.vx, k * driven.vy, k * driven.w) == pytest.approx(
            twist, abs=1e-9
        )


def test_a_twist_stays_inside_when_its_wrench_is_turned_by_less_than_it_has_to_spare() -> (
    None
):
    rng = random.Random(4)
    rays = CONE.rays(0.1)
    assert len(rays) >= 4
    for ray in rays:
        spare = CONE.cone_margin(*ray)
        fx, fy, tau, _ = CONE.wrench(*ray)
        size = math.hypot(fx, fy, tau / RHO)
        for _ in range(50):
            off = [rng.gauss(0, 1) for _ in range(3)]
            k = 0.99 * math.sin(spare) * size / math.hypot(*off)
            moved = (fx + k * off[0], fy + k * off[1], tau + k * RHO * off[2])
            assert feasibility(*moved, D, MU).feasible


def test_rays_have_what_is_asked_for_and_point_all_round_the_cone() -> None:
    rays = CONE.rays(0.08)
    assert len(rays) >= 6
    assert all(CONE.cone_margin(*ray) >= 0.08 for ray in rays)
    assert any(w > 0.0 for _, _, w in rays)
    assert any(w < 0.0 for _, _, w in rays)


def test_the_nearest_wrench_is_possible_and_none_is_given_for_a_possible_one() -> None:
    allocate = two_contact_allocator(
        [c.point for c in ORTHOGONAL], [c.normal for c in ORTHOGONAL], MU, RHO
    )
    for twist in random_twists(200):
        wrench = CONE.wrench(*twist)
        nearest = CONE.nearest(wrench)
        if CONE.cone_margin(*twist) >= 0.0:
            assert nearest is None
        else:
            assert nearest is not None
            again = allocate(nearest.fx, nearest.fy, nearest.tau)
            assert math.hypot(*again.residual[:2], again.residual[2] / RHO) < 1e-8


def test_the_point_that_a_wrench_is_about_does_not_matter() -> None:
    wrench = Wrench(-2.0, 1.0, 0.3)
    near = CONE.nearest(wrench)
    far = CONE.nearest(wrench.moved_to((0.1, 0.2)))
    assert near is not None
    assert far is not None
    assert near[:3] == pytest.approx(far[:3])


def test_what_only_a_squeeze_could_give_is_outside() -> None:
    facing = (
        Contact(0, "side", (-0.1, 0.17), (0.5, -0.866), 0.05),
        Contact(1, "side", (-0.1, -0.17), (0.5, 0.866), 0.05),
    )
    cone = TwistCone(facing, 1.2, SURFACE)
    assert cone.cone_margin(1.0, 0.0, 0.0) > 0.5
    assert cone.cone_margin(-1.0, 0.0, 0.0) < 0.0


def test_the_rays_lie_between_the_edges_or_their_middles_and_the_middle_of_the_cone() -> (
    None
):
    """In the norm of the surface, each INWARD of the way to the middle of the edges."""
    edges = []
    for contact in ORTHOGONAL:
        for fx, fy in cone_edges(contact.normal, MU):
            x, y = contact.point
            edge = np.array([fx, fy, (x * fy - y * fx) / RHO])
            edges.append(edge / np.linalg.norm(edge))
    middle = sum(edges) / 4.0
    ends = [0.5 * (a + b) for i, a in enumerate(edges) for b in edges[i:]]
    wanted = [(1.0 - INWARD) * end + INWARD * middle for end in ends]
    wanted = [ray / np.linalg.norm(ray) for ray in wanted]
    rays = CONE.rays(-1.0)
    assert len(rays) == len(wanted)
    found = []
    for ray in rays:
        fx, fy, tau, _ = CONE.wrench(*ray)
        direction = np.array([fx, fy, tau / RHO])
        found.append(direction / np.linalg.norm(direction))
    distances = np.linalg.norm(np.array(found)[:, None] - np.array(wanted), axis=-1)
    assert distances.min(axis=1).max() < 1e-9  # each ray is wanted
    assert distances.min(axis=0).max() < 1e-9  # each one wanted is there
