"""An object held by two contacts and moved along one constant twist, as in all modes
with two arms that press.
"""

from __future__ import annotations

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.twist_path import TwistPath


def resume_path(
    ends: tuple[Pose2, Pose2], radius: float, longest: float
) -> TwistPath | None:
    """Path of V along one twist between its ``ends``. None if it is longer than
    ``longest`` [m], or has no length.

    A turn by one radian counts as ``radius`` [m].
    """
    path = TwistPath.between(ends, radius)
    if not 0.0 < path.length <= longest:
        return None
    return path


def tipping_refusal(cause: str, margin: float) -> Refusal | None:
    """Refusal of too small a tipping ``margin`` [half widths], or None. ``cause`` says
    what tips the object.
    """
    allowed = margins.TIPPING_MARGIN
    if margin >= allowed:
        return None
    text = (
        f"{cause}: the centre of pressure comes within {{figure:.2f}} half widths of "
        "the base's edge, allowed {allowed:g}"
    )
    return Refusal("tipping", text, margin, allowed)
