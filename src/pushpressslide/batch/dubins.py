"""Shortest Dubins paths on arrays, with separate left and right curvature limits: the
results of ``planning.dubins.shortest_path``.

Bakolas and Tsiotras, "Optimal synthesis of the asymmetric sinistral/dextral
Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.checks import check_last, check_positive
from pushpressslide.batch.rows import (
    Figures,
    answers,
    figures,
    figures_of,
    grouped,
)
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.dubins import NONE as NONE
from pushpressslide.kernels.dubins import shortest_dubins, shortest_dubins_length
from pushpressslide.planning.dubins import WORDS as WORDS


class DubinsPaths(NamedTuple):
    """Paths of three arcs, of which some may have zero length."""

    length: Array  # (...) [m]; NaN where a pose is no number
    word: NDArray[np.int8]  # (...) number in WORDS, NONE where a pose is no number
    lengths: Array  # (..., 3) [m] of the pieces
    curvatures: Array  # (..., 3) [1/m] of the pieces, positive to the left


def shortest_paths(
    starts: ArrayLike,
    goals: ArrayLike,
    kappa_left: ArrayLike,
    kappa_right: ArrayLike,
) -> DubinsPaths:
    """Shortest paths (...) from ``starts`` to ``goals`` (..., 3): x, y [m] and yaw
    [rad], with curvatures in [-``kappa_right``, ``kappa_left``] (...) [1/m].

    Of equally short words the first in ``WORDS`` is taken. Raises ValueError unless all
    limits are finite and > 0.
    """
    row = _arguments(starts, goals, kappa_left, kappa_right)
    out = answers(shortest_dubins, *row, columns=8)
    words = out[..., 1].astype(np.int8)
    return DubinsPaths(out[..., 0], words, out[..., 2:5], out[..., 5:])


def shortest_lengths(
    starts: ArrayLike,
    goals: ArrayLike,
    kappa_left: ArrayLike,
    kappa_right: ArrayLike,
) -> Array:
    """Lengths (...) [m] of ``shortest_paths`` alone."""
    row = _arguments(starts, goals, kappa_left, kappa_right)
    return answers(shortest_dubins_length, *row, columns=1)[..., 0]


def _arguments(
    starts: ArrayLike,
    goals: ArrayLike,
    kappa_left: ArrayLike,
    kappa_right: ArrayLike,
) -> tuple[tuple[Figures, Figures], Figures]:
    """Poses and curvature limits as arrays."""
    a, b, left, right = figures(starts, goals, kappa_left, kappa_right)
    check_last(a, (3,), "starts")
    check_last(b, (3,), "goals")
    check_positive(left, "kappa_left", "1/m")
    check_positive(right, "kappa_right", "1/m")
    return (grouped(a), grouped(b)), figures_of(left, right)
