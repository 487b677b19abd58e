"""Many dragging forces at a time, against the exact surface one force at a time."""

import math

import numpy as np
import pytest

from pushpressslide.core.task import Box, Cylinder, ObjectModel, Prism
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.dragging import DraggedBase, DraggedEllipsoid
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_level,
    exact_twist_direction,
)
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.virtual_axle import dragged_twist

MU = 0.3
HEIGHT = 0.06
BEHIND = (-0.1, 0.02)
BODIES = [
    ObjectModel(Box((0.2, 0.15, 0.15)), 1.0, (0.0, 0.0)),
    ObjectModel(Box((0.2, 0.15, 0.15)), 1.0, (0.02, -0.01)),
    ObjectModel(
        Prism(((0.15, 0.0), (-0.1, 0.12), (-0.1, -0.12)), 0.1), 1.0, (-0.0167, 0.0)
    ),
    ObjectModel(Cylinder(0.1, 0.1), 1.0, (0.0, 0.0)),
]


def centers(twists) -> np.ndarray:
    """Where twists (m, 3) of B's origin turn it about [m]."""
    vx, vy, w = np.asarray(twists).T
    return np.stack([-vy / w, vx / w], axis=-1)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("resolution", "tolerance"), [(4, 2e-3), (6, 1e-3)])
def test_a_push_slides_the_object_as_on_the_exact_surface(
    body, resolution: int, tolerance: float
) -> None:
    directions = [(math.cos(a), math.sin(a)) for a in (-0.5, -0.2, 0.1, 0.5)]
    n = len(directions)
    base = DraggedBase(body, HEIGHT * MU, resolution)
    slid = base.slide(np.zeros((n, 2)), np.tile(BEHIND, (n, 1)), np.array(directions))

    def pressure_at(cop):
        return face_pressure(body.shape, body.center_of_mass, cop)

    exact = [
        dragged_twist(pressure_at, MU, (0.0, 0.0), BEHIND, HEIGHT, d)[:3]
        for d in directions
    ]
    far = np.linalg.norm(centers(exact), axis=1)
    off = np.linalg.norm(centers(slid.twists) - centers(exact), axis=1)
    assert (off < tolerance * (1.0 + far / 0.1)).all()


def test_each_force_slides_as_it_does_alone_whatever_else_is_asked() -> None:
    rng = np.random.default_rng(0)
    base = DraggedBase(BODIES[0], 0.02)
    angles = rng.uniform(-math.pi, math.pi, 40)
    cops = rng.uniform(-0.02, 0.02, (40, 2))
    contacts = rng.uniform(-0.07, 0.07, (40, 2))
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    together = base.slide(cops, contacts, directions).twists
    for i in range(0, 40, 7):
        alone = base.slide(
            cops[i : i + 1], contacts[i : i + 1], directions[i : i + 1]
        ).twists[0]
        assert alone == pytest.approx(together[i], abs=1e-9)


def test_where_the_object_tips_nothing_is_said() -> None:
    base = DraggedBase(BODIES[0], 0.2)
    assert np.isnan(
        base.slide(np.zeros((1, 2)), np.array([BEHIND]), np.array([(1.0, 0.0)])).twists
    ).all()


def test_an_ellipsoid_slides_about_the_centre_of_pressure_that_the_drag_moves() -> None:
    """Against the surface about that moved centre, one force at a time."""
    rng = np.random.default_rng(3)
    rho = 0.07
    shift = 0.03
    angles = rng.uniform(-math.pi, math.pi, 50)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cops = rng.uniform(-0.05, 0.05, (50, 2))
    contacts = rng.uniform(-0.2, 0.2, (50, 2))
    slid = DraggedEllipsoid(rho, shift).slide(cops, contacts, directions)
    for cop, contact, force, twist, share in zip(
        cops, contacts, directions, slid.twists, slid.shares, strict=True
    ):
        moved = cop + shift * share * force
        surface = EllipsoidLimitSurface(1.0, rho, tuple(moved))
        wrench = wrench_of_forces([tuple(contact)], [tuple(share * force)])
        assert surface.level(wrench) == pytest.approx(1.0)
        driven = surface.twist_direction(wrench).moved_to((0.0, 0.0))
        k = math.hypot(*twist) / math.hypot(*driven[:3])
        assert twist == pytest.approx([k * part for part in driven[:3]], abs=1e-12)


def test_from_any_place_it_slides_as_on_the_exact_surface_under_the_moved_load() -> (
    None
):
    """Of many bodies, places and angles; 5 mN/N and 2 % are the rule's coarseness."""
    rng = np.random.default_rng(4)
    for body in BODIES:
        base = DraggedBase(body, 0.3 * MU * body.shape.height, 4)
        count = 60
        angles = rng.uniform(-math.pi, math.pi, count)
        directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        contacts = rng.uniform(-0.12, 0.12, (count, 2))
        slid = base.slide(np.zeros((count, 2)), contacts, directions)
        assert np.isfinite(slid.twists).all()
        for contact, force, twist, share in zip(
            contacts, directions, slid.twists, slid.shares, strict=True
        ):
            cop = 0.3 * MU * body.shape.height * share * force
            pressure = support_pressure(
                body.shape, 1.0, body.center_of_mass, tuple(cop), 4
            )
            wrench = wrench_of_forces([tuple(contact)], [tuple(share * force)])
            exact = exact_twist_direction(pressure, wrench).moved_to((0.0, 0.0))
            assert exact_level(pressure, 1.0, wrench) == pytest.approx(1.0, abs=5e-3)
            size = np.array([1.0, 1.0, 0.1])
            a = twist * size / np.linalg.norm(twist * size)
            b = np.array(exact[:3]) * size / np.linalg.norm(np.array(exact[:3]) * size)
            assert np.linalg.norm(a - b) < 0.02
