"""Mean of values that arrive one by one, with its standard error."""

from __future__ import annotations

import math
from typing import NamedTuple


class RunningMean(NamedTuple):
    """Sums over the values so far."""

    samples: int = 0
    total: float = 0.0
    squares: float = 0.0  # sum of the squared values

    def including(self, value: float) -> RunningMean:
        """The mean with another ``value``."""
        return RunningMean(
            self.samples + 1, self.total + value, self.squares + value * value
        )

    @property
    def mean(self) -> float:
        """Mean of the values. There must be one."""
        return self.total / self.samples

    @property
    def error(self) -> float:
        """Standard error of the mean of independent values. There must be two."""
        scatter = max(self.squares - self.total * self.mean, 0.0)
        return math.sqrt(scatter / (self.samples * (self.samples - 1)))
