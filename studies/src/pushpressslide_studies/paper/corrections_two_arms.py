"""Corrections to the paper's text on two arms (docs/mechanics.md, sections 5 to 7)."""

from __future__ import annotations

import math
import random

from pushpressslide.allocation import orthogonal, published
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_margin
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import center_of_pressure, rectangle_pressure
from pushpressslide.mechanics.rho import rho_fit, rho_pole
from pushpressslide.rom.differential_car import DifferentialCar
from pushpressslide_studies.paper.correction import Compared, Correction
from pushpressslide_studies.paper.corrections_one_arm import BAR, MU_SUPPORT, MU_TIP

SAMPLES = 20000  # wrenches that an allocator is tried on


def moments_about_com() -> Correction:
    """Correction to case 5, eq. 24, and case 2: the reference point of moments, and the
    line of the axle.
    """
    points = ((0.0, 0.3), (0.0, -0.3))
    cop = (0.0, 0.1875)
    wanted = wrench_of_forces(points, published.pressed_forces(points, 1.0, 0.0, 0.0))
    twist = EllipsoidLimitSurface(1.0, 0.2, cop).twist_direction(wanted)
    pivot = BAR.pivot(left=True)
    return Correction(
        "Moments are about the CoM; the virtual axle lies on the line of contact and "
        "CoM",
        "7",
        "The limit surface is about the centre of pressure. Presses, and drag at a "
        "height, move that point.",
        (
            Compared(
                "turn of a slide planned straight, centre of pressure 0.19 m off",
                0.0,
                abs(twist.w / twist.vx),
                "rad/m",
                2,
                rho="given",
            ),
            Compared(
                "distance of the pivot from that line, tip 0.1 m high",
                0.0,
                1e3 * abs(pivot[1]),
                "mm",
                0,
                rho="exact surface",
            ),
        ),
    )


def differential_drive() -> Correction:
    """Correction to case 3, mode 2: the differential drive."""
    width = 0.15
    rho = rho_pole(rectangle_pressure(0.3, 0.5))
    car = DifferentialCar((0.0, 0.0), 0.0, width, width, rho)
    return Correction(
        "Two rear pushes perfectly mimic a differential drive",
        "5",
        "A push cannot pull: the object moves forward only, with |kappa| at most "
        "w/rho².",
        (
            Compared(
                "least turning radius, 30 x 50 cm box",
                0.0,
                car.minimum_turning_radius,
                "m",
                3,
                rho="pole",
            ),
        ),
    )


def bias_is_external() -> Correction:
    """Correction to case 4, eq. 23: the bias is an external force."""
    points = ((-0.1, 0.0), (0.0, 0.1))
    d = 0.1
    wanted = (2.0, -2.0, 0.05)
    given = wrench_of_forces(points, published.orthogonal_pushes(*wanted, d, bias=1.0))
    return Correction(
        "f_bias is an internal force",
        "6",
        "Two normal forces at right angles do not cancel: (b, -b, 0) drives the "
        "object along the diagonal.",
        (
            Compared(
                "change of the object's force for a bias of 1 N",
                0.0,
                math.hypot(given.fx - wanted[0], given.fy - wanted[1]),
                "N",
            ),
        ),
    )


def turning_regions() -> Correction:
    """Correction to case 4: the extreme points of the turning centres."""
    mu = 0.5
    d = 1.0
    rho = 1.0  # K = 1
    points = ((-d, 0.0), (0.0, d))
    turns = [
        wrench_of_forces(points, ((1.0, mu), (s * mu * mu, -mu))).tau
        for s in (1.0, -1.0)
    ]
    near, far = published.unicycle_distances(d, mu, rho)
    true_near, true_far = orthogonal.translation_radii(d, mu, rho)
    outside = 1.0 + 1e-9  # the points are corners of the regions
    reached = orthogonal.can_turn_about((outside, outside / mu), True, d, mu, rho)
    reached &= orthogonal.can_turn_about(
        (1.0 / outside, -outside / mu), False, d, mu, rho
    )
    return Correction(
        "One extreme point turns left and one right, at d_min and d_max, and K/mu is "
        "in neither region",
        "6",
        "The friction of the primary arm has a moment too. Both points turn the "
        "object the same way, both are nearer, and K/mu is inside.",
        (
            Compared("d_min over K, mu = 0.5", near, true_near),
            Compared("d_max over K, mu = 0.5", far, true_far),
            Compared(
                "extreme points of the two that turn left under a force along x",
                1,
                sum(t > 0.0 for t in turns),
                "",
                0,
            ),
            Compared(
                "single-arm points (K, ±K/mu) in the regions", 0, 2 * reached, "", 0
            ),
        ),
    )


def symmetric_split() -> Correction:
    """Correction to section III-F: the symmetric split of the allocator."""
    return Correction(
        "The algebraic allocator guarantees positive normals and forces in their "
        "friction cones",
        "6",
        "An even split of the moment leaves the cones where another split does not. "
        "For many wrenches no split is inside.",
        tuple(
            Compared(
                f"feasible wrenches that the even split covers, mu = {mu:g}",
                100.0,
                100.0 * _covered(mu),
                "%",
                0,
            )
            for mu in (0.2, 0.8)
        ),
    )


def _covered(mu: float) -> float:
    """Share of feasible wrenches that the even split covers.

    The wrenches have random directions.
    """
    rng = random.Random(0)
    d = 0.1
    possible = 0
    covered = 0
    for _ in range(SAMPLES):
        fx = rng.gauss(0.0, 1.0)
        fy = rng.gauss(0.0, 1.0)
        tau = d * rng.gauss(0.0, 1.0)
        if orthogonal.feasibility(fx, fy, tau, d, mu).feasible:
            possible += 1
            first, second = published.orthogonal_pushes(fx, fy, tau, d)
            covered += (
                min(
                    cone_margin(first, (1.0, 0.0), mu),
                    cone_margin(second, (0.0, -1.0), mu),
                )
                >= 0.0
            )
    return covered / possible


def pivot_about_contact() -> Correction:
    """Correction to case 5: turning about a contact, with N_R going to zero."""
    left = (0.0, 0.3)
    right = (0.0, -0.3)
    weight = 20.0
    rho = rho_fit(rectangle_pressure(0.6, 0.8))
    presses = TwoPresses(left, right, weight, MU_SUPPORT, MU_TIP, rho, 100.0)
    cop = center_of_pressure(weight, (0.0, 0.0), (weight,), (left,))
    return Correction(
        "N_R goes to zero for a pivot about p_L",
        "7",
        "An arm that does not press has no friction, and the weight keeps the centre "
        "of pressure away from p_L.",
        (
            Compared(
                "least N_R/N for a turn, 60 x 80 cm box",
                0.0,
                presses.least_fraction,
                "",
                3,
                rho="fit",
            ),
            Compared(
                "distance of the centre of pressure from p_L, N_L = weight",
                0.0,
                math.dist(cop, left),
                "m",
            ),
        ),
    )
