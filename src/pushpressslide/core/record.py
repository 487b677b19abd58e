"""The record of a run: time series, and its ending.

Names, shapes and units are listed in docs/results.md.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.notebook import html_of
from pushpressslide.core.plan import Plan
from pushpressslide.core.record_columns import named_columns

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ReasonCode = Literal[
    "goal_reached",
    "goal_missed",
    "not_verified",
    "time_limit",
    "contact_lost",
    "force_limit",
    "torque_limit",
    "joint_limit",
    "runaway",
    "reference_jump",
    "collision",
    "body_moved",
    "diverged",
    "interrupted",
]


@dataclass(frozen=True, slots=True)
class Ending:
    """Ending of a run: a code, and one line of text with the deciding number."""

    code: ReasonCode
    text: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Time series of one run, and its ending."""

    # (N, ...) for N ticks, with the names in docs/results.md
    arrays: Mapping[str, NDArray[np.float64]]
    reason: ReasonCode
    reason_text: str
    engine: str  # the plant's name
    seed: int
    wall_time: float  # [s] of the whole loop
    modes: tuple[str, ...]
    plan: Plan  # as executed, replans included
    # versions, time step, joint margin, clearance, ...
    meta: Mapping[str, Any] = field(default_factory=dict)
    # content of result.json if the run was measured; from ``report.metrics.result``
    figures: Mapping[str, Any] = field(default_factory=dict)

    @property
    def success(self) -> bool | None:
        """Whether the goal was reached, no other body was displaced, and no limit was
        broken. None if the true pose is not known.

        Raises RuntimeError for a run that was not measured.
        """
        if not self.figures:
            raise RuntimeError(
                "the run was not measured: pushpressslide.run measures what it runs, "
                "pushpressslide.result any record"
            )
        success: bool | None = self.figures["success"]
        return success

    def to_dataframe(self) -> Any:
        """Time series with one value per tick, as a pandas DataFrame indexed by time
        [s].

        The columns are those of ``core.record_columns``, such as ``object_x``; phases
        are words. Raises PushPressSlideError if pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ModuleNotFoundError:
            raise PushPressSlideError(
                "to_dataframe: pandas is not installed; pip install pandas"
            ) from None
        columns = named_columns(self.arrays)
        index = pandas.Index(columns.pop("time"), name="time")
        return pandas.DataFrame(columns, index=index)

    def __repr__(self) -> str:
        """Summary in one line."""
        ticks = len(self.arrays.get("time", ()))
        modes = ", ".join(self.modes)
        return (
            f"Record({self.reason}: {modes} on {self.engine}, {ticks} ticks, seed "
            f"{self.seed})"
        )

    def _repr_html_(self) -> str:
        """Outcome, replay and figures, for a notebook."""
        return html_of(self, "record_html")


class Figures(dict[str, Any]):
    """The content of result.json, shown as a table in a notebook."""

    def _repr_html_(self) -> str:
        """Outcome and a table of the figures, for a notebook."""
        return html_of(self, "result_html")
