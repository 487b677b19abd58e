"""The odds of a plan, as plain data and in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pushpressslide.core.plan import Plan
from pushpressslide.jobs.summary import interval
from pushpressslide.selection.odds import odds

TRUTHS_ALIKE = (
    "note: belief.friction_error, mass_error and center_error are 0, so that all truths "
    "of --odds are the same"
)
OTHER_BELIEF = (
    "note: no plan does with belief as it is; the odds are those about the values within "
    "its errors that were planned with"
)


def plan_odds(plan: Plan) -> dict[str, Any]:
    """Share of the truths for which a plan arrives without a recovery, with its 95 %
    interval, and the shares of what fails first.

    Raises PushPressSlideError for an object with a weight along its support.
    """
    found = odds(plan.queries, plan.segments)
    return {
        "truths": found.truths,
        "share": found.share,
        "interval": interval(found.arrivals, found.truths),
        "slip": found.slip / found.truths,
        "tipping": found.tipping / found.truths,
        "off_path": found.off_path / found.truths,
    }


def odds_text(figures: Mapping[str, Any]) -> str:
    """Odds in one line, from ``plan_odds``."""
    low, high = figures["interval"]
    return (
        f"arrives without a recovery in {figures['share']:.1%} of {figures['truths']} "
        f"truths, 95 % interval {low:.1%} to {high:.1%}; fails first by slip "
        f"{figures['slip']:.1%}, tipping {figures['tipping']:.1%}, off path "
        f"{figures['off_path']:.1%}"
    )
