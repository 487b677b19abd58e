"""The table of ``pps identify``: a line for each set, plain text so that it may be
wider than a terminal.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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


def lines(found: Iterable[Identification], result: Mapping[str, Any]) -> list[str]:
    """Return the table, and below it how much smaller the errors are than the
    one-parameter ellipsoid's.
    """
    from pushpressslide.report.identification import cells

    rows = [HEAD, *(tuple(cell or "-" for cell in cells(each)) for each in found)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    text = [
        "  ".join(
            [
                row[0].ljust(widths[0]),
                *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True)),
            ]
        )
        for row in rows
    ]
    groups = ""
    at = 0
    for name, columns in GROUPS:
        groups = groups.ljust(sum(widths[:at]) + 2 * at) + name
        at += columns
    rule = "-" * len(text[0])
    gain = result["mean_error_reduction"]
    lower = [
        f"{name.replace('_', ' ')} {100.0 * gain[name]:.0f} %"
        for name in gain
        if name != "ellipsoid"
    ]
    last = f"Below the error of the ellipsoid with rho alone, mean over the sets: {', '.join(lower)}."
    return [groups, text[0], rule, *text[1:], last]
