"""Choices of one contact, one for each arm that may touch the object."""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Point
from pushpressslide.core.query import Ends
from pushpressslide.core.scene import Scene, arm_title


def either_arm(scene: Scene, ends: Ends, choice: Choice) -> list[Choice]:
    """Copies of a choice of one contact, one for each arm that may touch the object,
    the arm nearer to the contact first.

    Path and time depend only on the object, so all copies share them. With two arms,
    the label names the arm. A choice that is refused because of the object is returned
    unchanged.
    """
    if len(scene.robots) == 1 or choice.refusal is not None:
        return [choice]
    nearest = nearest_arms(scene, ends, choice.contacts[0].point)
    return [_by(choice, arm) for arm in nearest]


def nearest_arms(scene: Scene, ends: Ends, point: Point) -> list[int]:
    """Arms that may touch the object, sorted by the distance of their bases from a
    ``point`` [m] in B.

    The distances at both ``ends`` X_WB are added.
    """
    places = [X_WB.apply(point) for X_WB in ends]

    def distance(arm: int) -> float:
        """Distance [m] of the point from an arm's base, summed over start and goal."""
        x, y, _ = scene.bases[arm]
        return sum(math.dist((x, y), place) for place in places)

    return sorted(scene.arms, key=distance)


def _by(choice: Choice, arm: int) -> Choice:
    """The choice with its contact made by ``arm``."""
    contacts = tuple(replace(contact, arm=arm) for contact in choice.contacts)
    return replace(
        choice,
        label=f"{arm_title(arm)}, {choice.label}",
        contacts=contacts,
        segments=tuple(
            replace(segment, contacts=contacts) for segment in choice.segments
        ),
    )
