"""Rules by which a figure or a statement of the paper counts as reproduced.

The rules were written from the paper's text, and do not depend on the result of any
run.
"""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide_studies.paper.evidence import Result
from pushpressslide_studies.paper.experiment import PaperFigure

SHARE = 0.1  # of a printed value, either way
SEEN_AXLE = -0.2  # [m] virtual axle from the CoM, in the paper's simulation
AXLE_BAND = SHARE * abs(SEEN_AXLE)  # [m]
PERIOD = 4e-3  # [s] of the control loop


@dataclass(frozen=True, slots=True)
class Rule:
    """Rule by which claims of one kind count as reproduced."""

    kind: str
    asked: str  # what has to hold
    reason: str


RULES: tuple[Rule, ...] = (
    Rule(
        "bound (≤, >)",
        "holds in every run",
        "A bound has no band. No run is picked out.",
    ),
    Rule(
        "value",
        f"within {100.0 * SHARE:.0f} % either way; better is not the same",
        "The paper's two runs with and without the joint term differ by 10 to 19 % "
        "in RMS. A wider band could not tell them apart.",
    ),
    Rule(
        "gain between two runs",
        "at least the paper's, at a force equal to friction",
        "The paper does not give its force. A push by the force of friction is what "
        "its quasi-static model commands.",
    ),
    Rule(
        "a task is done",
        "every run reaches its goal",
        "The paper names no failure. No run is picked out.",
    ),
    Rule(
        "place of the virtual axle",
        f"within {1e3 * AXLE_BAND:.0f} mm for every direction of the force",
        "10 % of the 0.2 m that the paper saw. The paper says that the direction "
        "does not matter.",
    ),
    Rule(
        "real time",
        f"the 99.9th percentile of a tick is below the period of {1e3 * PERIOD:g} ms "
        "in every run",
        "A robot needs every tick. The period is ours: the paper gives none, and no "
        "computer.",
    ),
)


def near(measured: float, printed: float) -> bool:
    """Whether a measured value is within the band around a printed value."""
    return abs(measured - printed) <= SHARE * abs(printed)


def reproduced(figure: PaperFigure, key: str, result: Result) -> bool:
    """Whether a run reproduced a figure of the paper.

    A run that missed its goal reproduces no figure. The only exception is a lower bound
    on the time, if the time limit ended the run.
    """
    measured = result[key]
    if measured is None:
        return False
    if not result["success"]:
        late = result["reason"]["code"] == "time_limit"
        return late and figure.about == "over" and measured >= figure.value
    if figure.about == "within":
        return bool(measured <= figure.value)
    if figure.about == "over":
        return bool(measured >= figure.value)
    return near(measured, figure.value)
