"""A parameter that was identified during a run, with its 95 % interval."""

from __future__ import annotations

from typing import Any, NamedTuple

from pushpressslide.core.pose import Point

SIGMAS = 1.96
"""Half width of a 95 % interval in standard deviations."""


class Parameter(NamedTuple):
    """An identified value beside what was believed before."""

    value: float
    deviation: float  # standard deviation
    belief: float
    direction: Point | None = None  # in G, of a coordinate
    at_bound: bool = False  # it may be farther from what was believed

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.value - SIGMAS * self.deviation

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.value + SIGMAS * self.deviation

    @property
    def contradicts_belief(self) -> bool:
        """Whether the interval excludes what was believed."""
        return not self.low <= self.belief <= self.high

    @property
    def figures(self) -> dict[str, Any]:
        """The parameter as in result.json."""
        return {
            "value": self.value,
            "low": self.low,
            "high": self.high,
            "believed": self.belief,
            "contradicts_belief": self.contradicts_belief,
            "direction": None if self.direction is None else [*self.direction],
        }
