"""Ticks and force balances of bodies with two tips, on each kind of support, for the
rows of a batch.

A missing tip is represented by a tip that touches nothing.
"""

from __future__ import annotations

from pushpressslide.kernels.compliant_tip import Side, side_touch
from pushpressslide.kernels.edge_friction import Edges, Plane, Series
from pushpressslide.kernels.exact_surface import Samples
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.plane import Pose
from pushpressslide.kernels.sliding import Triple, slide
from pushpressslide.kernels.supports import on_ellipsoid, on_polygon, on_samples
from pushpressslide.kernels.tip_step import Body, Face, Led, State, two_tip_step

Leds = tuple[Led, Led]
Figures = tuple[tuple[Face, Face], Body]
Step = tuple[Pose, Triple, State, State]
Sides = tuple[Side, Side]


@kernel
def step_on_ellipsoid(pose: Pose, guess: Triple, leds: Leds, figures: Figures) -> Step:
    """``two_tip_step`` on an ellipsoidal support."""
    faces, body = figures
    laws = (on_ellipsoid, side_touch)
    return two_tip_step(pose, guess, leds, faces, body, body[2], laws)


@kernel
def step_on_polygon(
    pose: Pose,
    guess: Triple,
    leds: Leds,
    figures: Figures,
    plane: Plane,
    edges: Edges,
    series: Series,
) -> Step:
    """``two_tip_step`` for a polygon with a linear pressure."""
    faces, body = figures
    laws = (on_polygon, side_touch)
    surface = (plane, edges, series)
    return two_tip_step(pose, guess, leds, faces, body, surface, laws)


@kernel
def step_on_samples(
    pose: Pose, guess: Triple, leds: Leds, figures: Figures, samples: Samples
) -> Step:
    """``two_tip_step`` for samples of the load."""
    faces, body = figures
    laws = (on_samples, side_touch)
    return two_tip_step(pose, guess, leds, faces, body, samples, laws)


@kernel
def slide_on_ellipsoid(
    guess: Triple, sides: Sides, limit: float, rho: float
) -> tuple[Triple]:
    """``slide`` on an ellipsoidal support. ``limit`` [N] is mu_s N, ``rho`` is in [m]."""
    laws = (on_ellipsoid, side_touch)
    return (slide(guess, sides, (rho, limit, rho), laws),)


@kernel
def slide_on_polygon(
    guess: Triple,
    sides: Sides,
    limit: float,
    rho: float,
    plane: Plane,
    edges: Edges,
    series: Series,
) -> tuple[Triple]:
    """``slide`` for a polygon with a linear pressure."""
    support = ((plane, edges, series), limit, rho)
    return (slide(guess, sides, support, (on_polygon, side_touch)),)


@kernel
def slide_on_samples(
    guess: Triple, sides: Sides, limit: float, rho: float, samples: Samples
) -> tuple[Triple]:
    """``slide`` for samples of the load."""
    laws = (on_samples, side_touch)
    return (slide(guess, sides, (samples, limit, rho), laws),)
