"""Wrenches of two orthogonal pushes, by sampling, compared with the paper's formulas.

Source: docs/mechanics.md. Lengths are in multiples of the distance d of the contacts
from the CoM, or of K = rho^2/d.
"""

from __future__ import annotations

import math
import statistics
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.allocation import orthogonal, published
from pushpressslide.core.arrays import Array
from pushpressslide.mechanics.friction import cone_edges
from pushpressslide.report import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = dict[str, float]
FRICTIONS = (0.2, 0.3, 0.5, 0.8)


def coverage(friction: float, samples: int, seed: int) -> Row:
    """Share of directions of (fx, fy, tau/d) that two orthogonal pushes can produce.

    ``symmetric`` is the share of these directions that the paper's even split of
    friction produces without a bias. For the rest, ``bias`` is the median size of the
    wrench added by the paper's smallest bias, for a requested wrench of size 1, and
    ``turned`` the median angle [rad] between the requested and the resulting wrench.
    For infeasible directions, ``drift`` is the median ratio of the smallest drift of
    any split to the paper's smallest bias.
    """
    wrenches = np.random.default_rng(seed).normal(size=(samples, 3))
    wrenches /= np.linalg.norm(wrenches, axis=1)[:, None]
    feasible = symmetric = 0
    biases = []
    turns = []
    ratios = []
    for fx, fy, tau in wrenches.tolist():
        bias = published.least_bias(fx, fy, tau, 1.0, friction)
        if not orthogonal.feasibility(fx, fy, tau, 1.0, friction).feasible:
            ratios.append(orthogonal.least_drift(fx, fy, tau, 1.0, friction) / bias)
            continue
        feasible += 1
        if bias == 0.0:
            symmetric += 1
        else:
            biases.append(math.sqrt(2.0) * bias)
            cosine = (1.0 + bias * (fx - fy)) / math.hypot(fx + bias, fy - bias, tau)
            turns.append(math.acos(min(cosine, 1.0)))
    return {
        "friction": friction,
        "possible": feasible / samples,
        "symmetric": symmetric / feasible,
        "bias": statistics.median(biases),
        "turned": statistics.median(turns),
        "drift": statistics.median(ratios),
    }


def possible_wrenches(friction: float, samples: int, seed: int) -> Array:
    """Feasible wrenches (samples, 3), fx, fy and tau/d: sums of random forces inside
    both cones.
    """
    edges = [
        (x, y, px * y - py * x)
        for (px, py), normal in (((-1.0, 0.0), (1.0, 0.0)), ((0.0, 1.0), (0.0, -1.0)))
        for x, y in cone_edges(normal, friction)
    ]
    return np.asarray(
        np.random.default_rng(seed).exponential(1.0, (samples, 4)) @ np.array(edges)
    )


def turning_centers(friction: float, samples: int, seed: int) -> Row:
    """ICRs of random feasible wrenches, compared with section 6 and the paper.

    ``outside`` is the number of centres outside the region for their direction of
    turning, ``closest`` the smallest distance from the CoM. ``radius``, ``near`` and
    ``far`` are those of section 6, ``d_min`` and ``d_max`` those of the paper. All
    distances are in units of K.
    """
    outside = 0
    closest = math.inf
    for fx, fy, tau in possible_wrenches(friction, samples, seed).tolist():
        center = orthogonal.turning_center(fx, fy, tau, 1.0)
        outside += not orthogonal.can_turn_about(center, tau > 0.0, 1.0, friction, 1.0)
        closest = min(closest, math.hypot(*center))
    near, far = orthogonal.translation_radii(1.0, friction, 1.0)
    d_min, d_max = published.unicycle_distances(1.0, friction, 1.0)
    return {
        "friction": friction,
        "samples": samples,
        "outside": outside,
        "closest": closest,
        "radius": orthogonal.least_turning_radius(1.0, friction, 1.0),
        "near": near,
        "far": far,
        "d_min": d_min,
        "d_max": d_max,
    }


def figure(friction: float, seed: int) -> Figure:
    """Figure of the feasible wrenches for a force of 1 N in any direction, and of the
    ICRs.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(style.SETTINGS):
        made = Figure(figsize=(style.WIDTH, 3.9), dpi=style.DPI, layout="constrained")
        moments, centers = made.subplots(1, 2)
    _moments(moments, friction)
    _centers(centers, friction, seed)
    return made


def _moments(axes: Axes, mu: float) -> None:
    degrees = np.linspace(-40.0, 130.0, 341)
    moments = np.linspace(-0.65, 0.65, 301)
    shown = np.zeros((len(moments), len(degrees)))
    for j, angle in enumerate(np.radians(degrees).tolist()):
        fx = math.cos(angle)
        fy = -math.sin(angle)
        for i, tau in enumerate(moments.tolist()):
            if orthogonal.feasibility(fx, fy, tau, 1.0, mu).feasible:
                shown[i, j] = (
                    2.0 if published.least_bias(fx, fy, tau, 1.0, mu) == 0.0 else 1.0
                )
    axes.contourf(
        degrees, moments, shown, levels=[0.5, 1.5, 2.5], colors=[style.AMBER, style.SKY]
    )
    for name, color in (
        ("paper's even split", style.SKY),
        ("only other splits", style.AMBER),
    ):
        axes.plot([], [], color=color, lw=6.0, label=name)
    axes.set_xlabel("direction of the force from +x towards -y [deg]")
    axes.set_ylabel("moment / (d force)")
    axes.set_ylim(-0.92, 0.7)  # room for the legend
    axes.legend(loc="lower right", frameon=False)
    style.title(axes, f"Possible wrenches, mu = {mu:g}")


def _centers(axes: Axes, mu: float, seed: int) -> None:
    reach = 9.0
    wrenches = possible_wrenches(mu, 6000, seed)
    x = -wrenches[:, 1] / wrenches[:, 2]
    y = wrenches[:, 0] / wrenches[:, 2]
    left = wrenches[:, 2] > 0.0
    for side, color, name in (
        (left, style.BLUE, "turning left"),
        (~left, style.ORANGE, "turning right"),
    ):
        near = side & (np.abs(x) < reach) & (np.abs(y) < reach)
        axes.plot(x[near], y[near], ".", ms=2.0, color=color, label=name)
    for turn in (True, False):
        corners = np.array(orthogonal.turning_corners(1.0, mu, 1.0, turn))
        axes.plot(*corners.T, color=style.BLACK, lw=1.2)
    angle = np.linspace(0.0, 2.0 * math.pi, 200)
    d_min, _ = published.unicycle_distances(1.0, mu, 1.0)
    for radius, line, name in (
        (orthogonal.least_turning_radius(1.0, mu, 1.0), "-", "closest (section 6)"),
        (d_min, "--", "paper's d_min"),
    ):
        axes.plot(
            radius * np.cos(angle),
            radius * np.sin(angle),
            line,
            color=style.GREY,
            lw=1.0,
            label=name,
        )
    axes.plot(0.0, 0.0, "+", color=style.BLACK)
    axes.set(
        xlim=(-reach, reach),
        ylim=(-reach, reach),
        aspect="equal",
        xlabel="x / K",
        ylabel="y / K",
    )
    axes.legend(loc="upper left", frameon=False)
    style.title(axes, f"Centres of turning, mu = {mu:g}")
