"""Claims of the paper about the virtual axle, evaluated with the measured axles."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide_studies.paper.bands import AXLE_BAND, SEEN_AXLE, near
from pushpressslide_studies.paper.claim import Claim, verdict
from pushpressslide_studies.paper.corrections_one_arm import BAR
from pushpressslide_studies.paper.evidence import Result

SOURCE = "Virtual axle"
PRINTED_AXLE = 0.82  # [m] from the CoM, by the paper's formula
SEEN_C = 0.43


def axle_claims(result: Result) -> list[Claim]:
    """Claims evaluated with the measurements at the height of the paper's press."""
    rows = [row for row in result["rows"] if row["measured"] is not None]
    high = max((row["height"] for row in rows), default=0.0)
    ours = [row for row in rows if row["height"] == high]
    if not ours:
        return []
    return [*_places(result, ours, high), *_steadiness(ours)]


def _places(result: Result, rows: Sequence[Result], height: float) -> list[Claim]:
    """Claims about the axle's position, evaluated at the forces that pull most and push
    most.
    """
    pulled = min(rows, key=lambda row: row["angle"])
    pushed = max(rows, key=lambda row: row["angle"])
    axles = (pulled["measured"], pushed["measured"])
    both = f"{1e3 * axles[0]:+.0f} mm pulled, {1e3 * axles[1]:+.0f} mm pushed"
    shift = result["support_friction"] * height
    cs = (_c_of(axles[0], shift), _c_of(axles[1], -shift))
    formula = pulled["paper"]
    return [
        Claim(
            SOURCE,
            "Axle from the CoM by the paper's formula",
            f"{PRINTED_AXLE:g} m",
            f"{1e3 * formula:+.0f} mm",
            verdict(near(abs(formula), PRINTED_AXLE)),
            "The same formula and inputs. The distance from the CoM to the CoP is "
            "subtracted, not added.",
            figure=True,
        ),
        Claim(
            SOURCE,
            "Axle from the CoM as seen in simulation",
            f"{abs(SEEN_AXLE):g} m",
            both,
            verdict(all(abs(axle - SEEN_AXLE) <= AXLE_BAND for axle in axles)),
            "Drag at the tip's height moves the load, one way when pulled and the "
            "other way when pushed.",
            figure=True,
        ),
        Claim(
            SOURCE,
            "c falls from 0.6 to 0.43 under the arm's force",
            f"{SEEN_C:g}",
            f"{cs[0]:.2f} pulled, {cs[1]:.2f} pushed",
            verdict(all(near(c, SEEN_C) for c in cs)),
            "From the measured axles and the moved centres of pressure: there is no "
            "single c.",
            figure=True,
        ),
    ]


def _c_of(axle: float, shift: float) -> float:
    """Constant c = rho / r0 of the bar that turns about ``axle`` [m] from the CoM.

    ``shift`` [m] is the displacement of the centre of pressure by the drag.
    """
    square = (BAR.cop[0] + shift - axle) * BAR.lever
    return math.sqrt(max(square, 0.0)) / BAR.half_diagonal


def _steadiness(rows: Sequence[Result]) -> list[Claim]:
    """Claims on whether the axle moves over time or with the force, and whether it
    agrees with its prediction.
    """
    bands = [row["measured_axle_band"] for row in rows]
    band = max(high - low for low, high in bands)
    axles = [row["measured"] for row in rows]
    spread = max(axles) - min(axles)
    worst = max(abs(row["measured"] - row["predicted"]) for row in rows)
    return [
        Claim(
            SOURCE,
            "The axle remains stable",
            "",
            f"within {1e3 * band:.1f} mm over time",
            verdict(band <= AXLE_BAND),
            "For a force of constant direction in the body, 5th to 95th percentile.",
        ),
        Claim(
            SOURCE,
            "The axle is invariant to the force's direction",
            "",
            f"moves by {1e3 * spread:.0f} mm",
            verdict(spread <= AXLE_BAND),
            "It moves with the direction through the exact surface's shape and the "
            "tip's height.",
        ),
        Claim(
            SOURCE,
            "The abstraction is valid: the object turns about a predictable axle",
            "",
            f"predicted within {1e3 * worst:.1f} mm",
            verdict(worst <= AXLE_BAND),
            "With the exact surface and the height of the contact, in every probe.",
        ),
    ]
