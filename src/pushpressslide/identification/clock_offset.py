"""Offset between the clock of the object's poses and that of the arm.

While the tip pushes, its gap to the object is constant. If poses are stamped late, the
gap seems to grow with the speed of the object. The offset is chosen so that the gap is
constant, by least squares with the gap as a second unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.streams import Stream
from pushpressslide.identification.tip_contact import TipContact

SEARCH = 0.5  # [s] largest offset searched, to either side
STEP = 0.01  # [s] step of the search
SLOPE_TIME = 0.02  # [s] to either side, for the rate of change of a gap
GAP_ERROR = 5e-4  # [m] error of the outline and of the tip's radius
TOUCH_SHARE = 0.3  # share of the pushing force above which the tip counts as in contact
LEAST_TOUCH = 0.1  # [N] lower bound of that force, for light pushes
OUTLIER = 4.0  # standard deviations beyond which a gap is an outlier
LEAST_CONTACT = 20  # smallest number of poses in contact
CONFIDENCE = 1.96  # standard deviations of a 95 % interval


@dataclass(frozen=True)
class ClockOffset:
    """Time to add to the stamps of poses to match the arm's clock."""

    seconds: float
    half_width: float = 0.0  # [s] of its 95 % interval; 0 for a given offset


class _Solution(NamedTuple):
    step: float  # [s]
    half_width: float  # [s]


@dataclass(frozen=True, eq=False)
class OffsetFit:
    """Fit of the offset of one recording, whose forces have no bias."""

    source: str
    object: Stream
    tip: Stream
    force: Stream
    tip_contact: TipContact

    def offset(self) -> ClockOffset:
        """The offset, with an interval from the covariance of the fit.

        Raises PushPressSlideError if the streams share too little contact.
        """
        offsets = np.arange(-SEARCH, SEARCH + 0.5 * STEP, STEP)
        found = [self._gaps(offset, 0.0) for offset in offsets]
        counts = [len(gaps) for gaps in found]
        if max(counts) < LEAST_CONTACT:
            raise PushPressSlideError(
                f"{self.source}: {max(counts)} poses are in contact (force above "
                f"{self._touch:.2g} N); at least {LEAST_CONTACT} are needed; --offset S "
                f"sets the offset of clocks that differ by over {SEARCH:g} s"
            )
        spreads = [_spread(gaps) for gaps in found]
        seconds = float(offsets[int(np.argmin(spreads))])
        half_width = SEARCH
        for _ in range(8):
            step, half_width = self._step(seconds)
            seconds += min(max(step, -SLOPE_TIME), SLOPE_TIME)
            if abs(step) < 1e-6:
                break
        return ClockOffset(seconds, half_width)

    @property
    def _touch(self) -> float:
        return touching_force(self.force)

    def _rows(self, offset: float) -> NDArray[np.bool_]:
        """Mask of the poses in contact."""
        times = self.object.times + offset
        known = self.tip.covers(times) & self.force.covers(times)
        size = np.hypot(*self.force.values_at(times).T)
        rows: NDArray[np.bool_] = known & (size > self._touch)
        return rows

    def _gaps(self, offset: float, later: float) -> Array:
        """Gaps [m] between the object and the tip's position ``later`` [s] afterwards,
        for the poses in contact.
        """
        rows = self._rows(offset)
        tip = self.tip.values_at(self.object.times[rows] + offset + later)
        return self.tip_contact.contacts(tip[:, :2], self.object.values[rows]).gaps

    def _step(self, offset: float) -> _Solution:
        """Gauss-Newton step towards a constant gap, ignoring outliers."""
        gaps = self._gaps(offset, 0.0)
        ahead = self._gaps(offset, SLOPE_TIME)
        behind = self._gaps(offset, -SLOPE_TIME)
        slopes = (ahead - behind) / (2.0 * SLOPE_TIME)
        matrix = np.column_stack([slopes, np.ones(len(gaps))])
        prior = np.diag((1.0 / SEARCH**2, 1.0 / GAP_ERROR**2))
        rows = np.ones(len(gaps), dtype=bool)
        noise = float(np.std(gaps)) + 1e-9
        for _ in range(4):
            normal = matrix[rows].T @ matrix[rows] / noise**2 + prior
            fitted = np.linalg.solve(normal, -matrix[rows].T @ gaps[rows] / noise**2)
            errors = gaps + matrix @ fitted
            noise = 1.4826 * float(np.median(np.abs(errors))) + 1e-9
            rows = np.abs(errors) < OUTLIER * noise
        variance = float(np.linalg.inv(normal)[0, 0])
        return _Solution(float(fitted[0]), CONFIDENCE * math.sqrt(variance))


def touching_force(force: Stream) -> float:
    """Force [N] above which the tip counts as in contact: a share of the pushing force."""
    size = np.hypot(*force.values.T)
    return max(LEAST_TOUCH, TOUCH_SHARE * float(np.percentile(size, 90.0)))


def _spread(gaps: Array) -> float:
    """Robust spread [m] of gaps about a common value near zero."""
    if len(gaps) < LEAST_CONTACT:
        return math.inf
    middle = float(np.median(gaps))
    return float(np.abs(gaps - middle).mean()) + 0.1 * abs(middle)
