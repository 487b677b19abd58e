"""Results of the paper's experiments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pushpressslide_studies.paper.identified_rho import IdentifiedRho

Result = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of one variant."""

    folder: Path
    result: Result | None  # contents of its result.json; None where it could not be run
    failure: str = ""
    rho: IdentifiedRho | None = None  # where the run was for it
    digest: str = ""  # of the object's motion: equal for two runs of the same motion


@dataclass(frozen=True, slots=True)
class Evidence:
    """All outcomes by the names of experiment and variant, and the result for the
    virtual axle.
    """

    outcomes: Mapping[tuple[str, str], Outcome]
    axle: Result | None = None  # as of virtual_axle.result_of

    def result(self, experiment: str, variant: str) -> Result | None:
        """Result of a variant. None if it was not run, or could not be run."""
        outcome = self.outcomes.get((experiment, variant))
        return None if outcome is None else outcome.result
