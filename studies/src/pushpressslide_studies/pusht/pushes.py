"""One push without friction: the T moves on an arc.

Source: studies/docs/gym-pusht.md. The force is along the face's inward normal n, which
is fixed in the body. The centre of mass therefore moves along n, and the T turns by
-left / rho^2 per length, like a car that is steered by the position of the contact.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from pushpressslide.core.pose import Pose2, turned_left
from pushpressslide.core.wrench import Wrench
from pushpressslide_studies.pusht.tee import FACES, RHO, SURFACE, PushedFace

PUSH_STEP = 12.0  # [px] of the pusher along the normal in one action
STRAIGHT = 1e-9  # [rad] of a turn that counts as none


@dataclass(frozen=True, slots=True)
class Push:
    """A push with a fixed contact on a face."""

    face: int  # index into FACES
    left: float  # [px] of the contact
    length: float  # [px] of the path of the centre of mass

    @property
    def pushed(self) -> PushedFace:
        """The face that is pushed."""
        return FACES[self.face]

    @property
    def curvature(self) -> float:
        """Turn [rad/px] per length of the path of the centre of mass."""
        return curvature(self.pushed, self.left)

    @property
    def pusher_ratio(self) -> float:
        """Advance of the pusher along the normal, per length of the path of the centre
        of mass.
        """
        return 1.0 + (self.left / RHO) ** 2


def curvature(face: PushedFace, left: float) -> float:
    """Turn [rad/px] per length of a push, from the limit surface."""
    n = face.normal
    x, y = face.contact(left)
    twist = SURFACE.twist_direction(Wrench(n[0], n[1], x * n[1] - y * n[0]))
    return twist.w / math.hypot(twist.vx, twist.vy)


def pushed_pose(X_WB: Pose2, push: Push) -> Pose2:
    """X_WB at the end of a push."""
    n = push.pushed.normal
    turn = push.curvature * push.length
    along = push.length
    across = 0.0
    if abs(turn) > STRAIGHT:
        along = push.length * math.sin(turn) / turn
        across = push.length * (1.0 - math.cos(turn)) / turn
    left = turned_left(n)
    step = Pose2(along * n[0] + across * left[0], along * n[1] + across * left[1], turn)
    return X_WB.compose(step)


def final_pose(X_WB: Pose2, pushes: Iterable[Push]) -> Pose2:
    """X_WB at the end of all pushes."""
    for push in pushes:
        X_WB = pushed_pose(X_WB, push)
    return X_WB
