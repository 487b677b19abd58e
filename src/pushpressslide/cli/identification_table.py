"""The table of ``pps identify``: plain text, as it may be wider than a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pushpressslide.identification.scoring import Identification

GROUPS = (("", 3), ("rho [mm]", 3), ("held-out error of the direction [deg]", 6))
HEAD = (
    "set",
    "pushes",
    "friction",
    "fitted",
    "predicted",
    "rigid face",
    "ellipsoid",
    "full",
    "quartic",
    "pressure",
    "no fit",
    "even load",
)


def lines(
    identifications: Iterable[Identification], result: Mapping[str, Any]
) -> list[str]:
    """Return the table, a line for each set, and a sentence on the errors.

    The sentence says how much smaller they are than the one-parameter ellipsoid's.
    """
    from pushpressslide.report.identification import cells

    rows = [HEAD, *(tuple(cell or "-" for cell in cells(i)) for i in identifications)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    head, *body = (_line(row, widths) for row in rows)
    rule = "-" * len(head)
    return [_group_line(widths), head, rule, *body, _gain(result)]


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    """Return a row in columns: the first to the left, the others to the right."""
    numbers = (cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))
    return "  ".join([row[0].ljust(widths[0]), *numbers])


def _group_line(widths: Sequence[int]) -> str:
    """Return the names of the groups, each above its first column."""
    text = ""
    column = 0
    for name, columns in GROUPS:
        text = text.ljust(sum(widths[:column]) + 2 * column) + name
        column += columns
    return text


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
