"""An object that two contacts hold and lead along one constant twist: what the modes
that press share.
"""

from __future__ import annotations

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.twist_path import TwistPath


def resume_path(
    ends: tuple[Pose2, Pose2], radius: float, longest: float
) -> TwistPath | None:
    """Return the path of V by one twist between its ``ends``, lengths measured with
    ``radius`` [m]; None if it is longer than ``longest`` [m], or if there is nowhere to
    go.
    """
    path = TwistPath.between(ends, radius)
    if not 0.0 < path.length <= longest:
        return None
    return path


def tipping_refusal(cause: str, margin: float) -> Refusal | None:
    """Return what stands against a tipping ``margin`` [half widths] of the centre of
    pressure; None if nothing. ``cause`` says what tips the object.
    """
    allowed = margins.TIPPING_MARGIN
    if margin >= allowed:
        return None
    text = (
        f"{cause}: the centre of pressure comes within {{figure:.2f}} half widths of "
        "the base's edge, allowed {allowed:g}"
    )
    return Refusal("tipping", text, margin, allowed)
