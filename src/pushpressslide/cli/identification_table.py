"""Tables of ``pps identify`` as plain text, at most 80 columns wide for short names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pushpressslide.identification.scoring import Identification

SUPPORTS = ("pushes", "friction", "rho fitted", "predicted", "rigid face")


def lines(
    identifications: Iterable[Identification], result: Mapping[str, Any]
) -> list[str]:
    """Two tables with a line for each set, and a sentence on the errors.

    The sentence compares the errors with those of the one-parameter ellipsoid.
    """
    from pushpressslide.report.identification import ERRORS, cells

    rows = [[cell or "-" for cell in cells(found)] for found in identifications]
    errors = 1 + len(SUPPORTS)
    return [
        "Supports; rho in mm",
        *_table(SUPPORTS, [row[:errors] for row in rows]),
        "",
        "Held-out errors of the direction, in degrees",
        *_table(ERRORS, [[row[0], *row[errors:]] for row in rows]),
        "",
        _gain(result),
    ]


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table with the names of the sets on the left and their values on the right."""
    whole = [("set", *columns), *rows]
    widths = [max(map(len, column)) for column in zip(*whole, strict=True)]
    head, *body = (_line(row, widths) for row in whole)
    return [head, "-" * len(head), *body]


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    numbers = (cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))
    return "  ".join([row[0].ljust(widths[0]), *numbers])


def _gain(result: Mapping[str, Any]) -> str:
    lower = [
        f"{name.replace('_', ' ')} {100.0 * share:.0f} %"
        for name, share in result["mean_error_reduction"].items()
        if name != "ellipsoid"
    ]
    return (
        "Below the error of the ellipsoid with rho alone, mean over the sets: "
        f"{', '.join(lower)}."
    )
