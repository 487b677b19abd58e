"""Contact points and loads with which one arm may press and slide an object."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.pressing import least_lever, press_lever, press_loads
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.planning.hollow import hollow_refusal
from pushpressslide.planning.tool_drag import tool_load
from pushpressslide.rom.drives import ORIGIN


@dataclass(frozen=True, slots=True)
class PressPlacements:
    """Places and loads that a task allows for the press."""

    contacts: tuple[Contact, ...]  # without loads, one for each place
    loads: tuple[float, ...]  # [N], the safest first

    def turning(self, scene: Scene) -> list[list[Contact]]:
        """Presses on the top with enough lever to turn the object, grouped by load.

        Firm presses come first, with the safest load first. The other presses follow,
        since even a small creep of their tips turns the object far.
        """
        places = [
            contact
            for contact in self.contacts
            if contact.point != ORIGIN
            and inside_top(scene.body, contact.point, scene.inset)
        ]
        groups = [
            [replace(place, load=load) for place in places] for load in self.loads
        ]
        groups = [
            [press for press in group if turned_by_tool(scene, press)]
            for group in groups
        ]
        firm = [[press for press in group if _firm(scene, press)] for group in groups]
        loose = [
            [press for press in group if not _firm(scene, press)] for group in groups
        ]
        return [group for group in (*firm, *loose) if group]


def turned_by_tool(scene: Scene, press: Contact) -> bool:
    """Whether a press has enough lever for a turn in which the tool follows the object."""
    lower = least_lever(scene, press.load) / margins.HELD_TURN
    return press_lever(scene, press) >= lower


def _firm(scene: Scene, press: Contact) -> bool:
    """Whether a press is far enough from the centre of pressure."""
    return press_lever(scene, press) >= margins.ARM.firm_lever


def press_placements(query: MotionQuery) -> PressPlacements:
    """Contact points and loads of the press. Raises RefusedError if no press holds, or
    if the top is too small.
    """
    motion = query.motion
    scene = query.scene
    loads = press_loads(
        scene.weight_on,
        scene.support.friction,
        scene.contact_friction,
        query.planned_force,
        motion.press_force,
        tool_load(query, 0.0)[0],
        scene.friction_uses,
        query.sensing.least_press,
    )
    places: Sequence[Point] = top_places(query.body, scene.inset)
    if motion.contacts:
        places = [query.X_GB.unapply(motion.contacts[0])]
    lower = margins.SURE_LEVER * scene.planned_center_error
    sure = [place for place in places if math.hypot(*place) >= lower]
    if places and not sure:
        lever = max(math.hypot(*place) for place in places)
        text = (
            "pressed {figure:mm.0f} from the centre of mass, whose place is known to "
            f"{1e3 * scene.planned_center_error:g} mm: allowed from {{allowed:mm.0f}}"
        )
        raise RefusedError(Refusal("lever", text, lever, lower, "m"))
    places = sure
    if not places:
        text = "the top has no place {allowed:mm.0f} inside its edges"
        raise RefusedError(Refusal("off_top", text, None, scene.inset, "m"))
    deep = hollow_refusal(scene)
    if deep is not None:
        raise RefusedError(deep)
    height = query.body.shape.top_height
    arm = scene.arms[0]
    contacts = tuple(Contact(arm, "top", place, ORIGIN, height) for place in places)
    return PressPlacements(contacts, tuple(loads))
