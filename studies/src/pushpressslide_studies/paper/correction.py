"""A statement of the paper, with its correction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Rho = Literal["none", "given", "c r0", "pole", "straight", "fit", "exact surface"]
"""Length rho on which a figure is based: none; a value given for the example; the
paper's value; that for turning on the spot (``rho_pole``); that for nearly straight
motion (``rho_straight``); that of the nearest ellipsoid (``rho_fit``); or no ellipsoid
but the exact surface.
"""


@dataclass(frozen=True, slots=True)
class Compared:
    """One quantity, according to the paper's text or formula and as corrected."""

    what: str
    paper: float
    holds: float
    unit: str = ""
    decimals: int = 2
    rho: Rho = "none"  # of what holds

    def shown(self, value: float) -> str:
        """One of the two values as text, with its unit."""
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
