"""The state of bodies and arms between two motions: the start and the end of a motion.

A task gives the initial state. From there, planners and engines proceed from state to
state: between the stages of several bodies, from one run to the run that continues it,
and after a recovery.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2

if TYPE_CHECKING:
    from pushpressslide.core.plan import Contact

OBJECT = "object"
"""Name of a task's own object among its bodies."""

Joints = tuple[float, ...]  # [rad] of one arm


@dataclass(frozen=True, slots=True)
class HeldContacts:
    """Mode and contacts that the arms hold, regardless of the contacts' loads."""

    mode: str
    contacts: tuple[Contact, ...]  # without loads

    @classmethod
    def by(cls, mode: str, contacts: tuple[Contact, ...]) -> HeldContacts:
        """Contacts of a mode, with their loads removed."""
        return cls(mode, tuple(replace(contact, load=0.0) for contact in contacts))


@dataclass(frozen=True)
class WorldState:
    """Poses of the movable bodies, configurations of the arms, and the held contacts."""

    # X_WG of bodies by name; any other is as the task has it
    poses: Mapping[str, Pose2]
    # joints of each arm; empty: any posture, or no arms
    joints: tuple[Joints, ...] = ()
    held_contacts: HeldContacts | None = None  # None: the arms have let go
    speeds: tuple[Joints, ...] = ()  # [rad/s] of the joints; empty: at rest
    tips: tuple[Vector3, ...] = ()  # [m] centre of each; empty: as they come
    # quaternion (w, x, y, z) and position [m] in the world, (7,), of the same
    # bodies; empty in an engine without space
    spatial: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def object(self) -> Pose2:
        """X_WG of the task's own object."""
        return self.poses[OBJECT]

    def with_body_at(self, body: str, X_WG: Pose2) -> WorldState:
        """State with one body at ``X_WG`` and no held contacts."""
        return replace(
            self, poses={**self.poses, body: X_WG}, held_contacts=None, spatial={}
        )

    def __hash__(self) -> int:
        """Hash of the fields that are compared."""
        return hash((frozenset(self.poses.items()), self.joints, self.held_contacts))
