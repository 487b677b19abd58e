"""One planned push from behind, run for many true bodies at once.

It runs ``kernels.path_run`` over rows, in blocks of ticks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.batch.rows import Figures, answers, columns_of, leaves, map_nested
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.path_run import UNDER_WAY, Laws, path_run

TOGETHER = 64  # ticks after which the runs that have ended are left out
PAIR = (0.0, 0.0)
TRIPLE = (0.0, 0.0, 0.0)
STATE = (TRIPLE, TRIPLE, TRIPLE, PAIR, PAIR, TRIPLE, PAIR, (0.0,) * 6)
TRUTH = (0.0, 0.0, 0.0, PAIR)
WIDTH = 24  # numbers of a state
OFF = 21  # where its clock has the largest distance from the path
TIME = 22
END = 23


class PathRuns(NamedTuple):
    """A planned push, for any number of bodies."""

    sections: Array  # (p, 8) of the path: ``kernels.arc_path.Piece``
    bends: Array  # (q, 3) of the path: ``kernels.arc_path.Bend``
    laws: Laws
    noise: Array  # (3,) [m], [m], [rad] standard deviations of a measured pose
    # rows that noise is drawn for: what one is given does not depend on how many there are
    width: int

    def initial_states(
        self, poses: Array, place: float, rng: np.random.Generator
    ) -> Array:
        """States (n, 24) of bodies at ``poses`` (n, 3), X_WB, with the tip in contact
        at ``place`` [m] along the face. The pose estimates start with the filter's
        steady-state noise.
        """
        lead, (face, *_), _, _ = self.laws
        (nx, ny), depth, _, _, radius, _, _ = face
        x = nx * (depth - radius) - ny * place
        y = ny * (depth - radius) + nx * place
        c = np.cos(poses[:, 2])
        s = np.sin(poses[:, 2])
        k = lead[0]
        spread = self.noise * np.sqrt(k / (2.0 - k))
        draws = rng.standard_normal((3, self.width))[:, : len(poses)]
        states = np.zeros((len(poses), WIDTH))
        states[:, :3] = poses
        states[:, 3:6] = poses + (spread[:, None] * draws).T
        states[:, 9] = poses[:, 0] + c * x - s * y
        states[:, 10] = poses[:, 1] + s * x + c * y
        states[:, 19] = 1.0  # the steering scale
        return states

    def finish(self, states: Array, truths: Array, rng: np.random.Generator) -> Array:
        """States (n, 24) at the ends of all runs, or at the time limit.

        ``truths`` (n, 5) are rows of ``kernels.path_run.Truth``.
        """
        out = states.copy()
        rows = np.arange(len(states))
        numbers = np.array(list(leaves(self.laws)))
        laws = Figures(numbers, (map_nested(self.laws, lambda _: 0.0),))
        *_, dt, limit = self.laws[3]
        while len(rows) and states[0, TIME] <= limit - 0.5 * dt:
            noise = self._noise(rng)
            number = np.minimum(rows, len(noise) - 1.0)
            row = (
                Figures(states, (STATE,)),
                Figures(truths[rows], (TRUTH,)),
                *columns_of(number),
            )
            arrays = (self.sections, self.bends, noise)
            states = answers(path_run, row, laws, arrays, columns=WIDTH)
            out[rows] = states
            stay = states[:, END] == UNDER_WAY
            rows = rows[stay]
            states = states[stay]
        return out

    def _noise(self, rng: np.random.Generator) -> Array:
        """Noise (width, 3 * ticks) of the poses in a block of ticks.

        Without noise, a single row serves all runs.
        """
        if not self.noise.any():
            return np.zeros((1, 3 * TOGETHER))
        draws = rng.standard_normal((TOGETHER, 3, self.width))
        draws *= self.noise[:, None]
        return np.ascontiguousarray(np.moveaxis(draws, -1, 0)).reshape(self.width, -1)
