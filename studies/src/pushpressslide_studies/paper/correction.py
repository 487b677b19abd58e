"""A statement of the paper, with its correction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Rho = Literal["none", "given", "c r0", "pole", "straight", "fit", "exact surface"]
"""Which length rho a figure rests on: none; one given for the example; the paper's own;
of turning on the spot (``rho_pole``); near straight motion (``rho_straight``); of the
nearest ellipsoid (``rho_fit``); or no ellipsoid, but the exact surface.
"""


@dataclass(frozen=True, slots=True)
class Compared:
    """One quantity, by the paper's text or formula and corrected."""

    what: str
    paper: float
    holds: float
    unit: str = ""
    decimals: int = 2
    rho: Rho = "none"  # of what holds

    def shown(self, value: float) -> str:
        """One of the two values, with its unit."""
        text = f"{value:.{self.decimals}f}"
        if self.unit in ("", "°"):
            return text + self.unit
        return f"{text} {self.unit}"


@dataclass(frozen=True, slots=True)
class Correction:
    """A statement of the paper, its error, and the figures that show it."""

    claim: str
    section: str  # of docs/mechanics.md
    why: str
    figures: tuple[Compared, ...]
