"""Data types for the paper's experiments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from pushpressslide.control.execution import USUAL, Execution


class Verdict(StrEnum):
    """Verdict on a claim."""

    reproduced = "reproduced"
    not_reproduced = "not reproduced"
    unstated = "cannot be judged"  # the paper does not say what it would take
    not_run = "not run"


@dataclass(frozen=True, slots=True)
class PaperFigure:
    """A figure stated in the paper."""

    value: float  # SI units, radians
    about: str = ""  # how the paper qualifies it: "over", "about", "within"


@dataclass(frozen=True, slots=True)
class Variant:
    """One run: a shipped task with some fields changed."""

    name: str  # of its folder
    title: str
    task: str  # of a shipped task
    overrides: tuple[str, ...] = ()  # a.b=c each, as of `pps run --set`
    # by key of result.json
    paper: Mapping[str, PaperFigure] = field(default_factory=dict)
    why: str = ""  # what makes it come out so, in a line
    execution: Execution = USUAL

    @property
    def settings(self) -> tuple[str, ...]:
        """All changed fields, including those that limit a measurement to a single
        attempt.
        """
        return (*self.overrides, "motion.recoveries=0", "limits.legs=1")


@dataclass(frozen=True, slots=True)
class Comparison:
    """A claim of the paper: the variant ``changed`` is better than the variant
    ``base``.
    """

    base: str  # name of a variant
    changed: str
    words: str  # what the change is, as the subject of a sentence


@dataclass(frozen=True, slots=True)
class Settled:
    """A statement of the paper whose verdict does not depend on the runs."""

    words: str
    verdict: Verdict
    why: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """Several runs that concern the same claim of the paper."""

    name: str
    title: str
    source: str  # where in the paper
    claim: str  # what the paper says
    variants: tuple[Variant, ...]
    why: str  # what decides the outcome, whatever the figures
    comparisons: tuple[Comparison, ...] = ()
    pictured: tuple[str, ...] = ()  # variants that are shown by pictures on the way
    # variants whose errors are plotted over time; None for all
    plotted: tuple[str, ...] | None = None
    axle: str = ""  # variant whose virtual axle is plotted over time
    settled: tuple[Settled, ...] = ()
    ours: bool = False  # the paper claims nothing that the runs could show
