"""A choice of one contact, for each arm that may make it."""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Point
from pushpressslide.core.query import Ends
from pushpressslide.core.scene import Scene, arm_title


def either_arm(scene: Scene, ends: Ends, choice: Choice) -> list[Choice]:
    """Return a choice of one contact for each arm that may touch the object, the arm
    nearer to the contact first.

    The arms share its path and its time: these are the object's. Of two arms each is
    named in its label. A choice that the object itself refuses is returned as it is.
    """
    if len(scene.robots) == 1 or choice.refusal is not None:
        return [choice]
    nearest = nearest_arms(scene, ends, choice.contacts[0].point)
    return [_by(choice, arm) for arm in nearest]


def nearest_arms(scene: Scene, ends: Ends, point: Point) -> list[int]:
    """Return the arms that may touch the object, the one nearest to a ``point`` [m] in B
    first, at both ``ends`` X_WB of its way together.
    """
    places = [X_WB.apply(point) for X_WB in ends]

    def distance(arm: int) -> float:
        """Return how far [m] the point is from an arm's base, at start and goal."""
        x, y, _ = scene.bases[arm]
        return sum(math.dist((x, y), place) for place in places)

    return sorted(scene.arms, key=distance)


def _by(choice: Choice, arm: int) -> Choice:
    """Return a choice with its contact made by ``arm``."""
    contacts = tuple(replace(contact, arm=arm) for contact in choice.contacts)
    return replace(
        choice,
        label=f"{arm_title(arm)}, {choice.label}",
        contacts=contacts,
        segments=tuple(
            replace(segment, contacts=contacts) for segment in choice.segments
        ),
    )
