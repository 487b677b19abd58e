"""One claim of the paper, with its verdict."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide_studies.paper.experiment import Verdict


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim, and its measured figures."""

    source: str
    words: str
    paper: str  # its figure, with unit; "" for none
    measured: str  # "" where it could not be measured
    verdict: Verdict
    why: str = ""
    figure: bool = False  # the paper gives a figure for it


def verdict(good: bool) -> Verdict:
    """Verdict on a measured claim."""
    return Verdict.reproduced if good else Verdict.not_reproduced
