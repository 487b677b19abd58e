"""All results identified from one set of pushes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.identification.intervals import Intervals, intervals
from pushpressslide.identification.next_push import NextPush, next_push
from pushpressslide.identification.recorded_sets import RecordedSet
from pushpressslide.identification.scoring import Identification

LARGEST_ERROR = 0.5  # largest value of belief.friction_error


@dataclass(frozen=True, eq=False)
class IdentifiedSet:
    """Models and scores of a set, with confidence intervals and advice."""

    models: Identification
    intervals: Intervals
    next_push: NextPush
    recorded: RecordedSet | None = None  # None: a set of text logs

    @property
    def contact_friction(self) -> float | None:
        """Friction of the tip, or None if it did not slide."""
        return None if self.recorded is None else self.recorded.contact_friction

    @property
    def expected_error(self) -> float:
        """Mean held-out error [rad] of the load expected from the shape."""
        scores = self.models.scores
        names = ("no_fit", "no_fit_uniform")
        return min(scores[name].mean for name in names if name in scores)

    @property
    def needs_rho(self) -> bool:
        """Whether an ellipsoid predicts the pushes better than the load expected from
        the shape.

        Plans use this load if no rho is given.
        """
        return self.models.scores["ellipsoid"].mean < self.expected_error

    @property
    def belief(self) -> dict[str, float | None]:
        """Identified fields of a task file's ``belief``, in the file's units.

        ``rho`` is None if the load expected from the shape predicts the pushes better.
        """
        known = self.intervals
        belief: dict[str, float | None] = {
            "support_friction": known.friction.value,
            "rho": known.rho.value if self.needs_rho else None,
        }
        if self.contact_friction is not None:
            belief["contact_friction"] = self.contact_friction
        # rounded up to a thousandth
        error = math.ceil(1e3 * known.friction.relative) / 1e3
        belief["friction_error"] = min(error, LARGEST_ERROR)
        return belief


def identified_set(
    models: Identification, recorded: RecordedSet | None, seed: int
) -> IdentifiedSet:
    """The set with confidence intervals, and the push that would narrow them most."""
    known = intervals(models, seed)
    return IdentifiedSet(models, known, next_push(models.push_set, known), recorded)
