"""Two pushes that drive the object by twists in their cone: choice of the path,
tracking law and continuation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pushpressslide.allocation.allocator import Allocator
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath, TwistRate
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import (
    Continuation,
    Feasibility,
    Measured,
    Mode,
    Tracker,
    in_arms,
)
from pushpressslide.planning.in_cone import (
    Margin,
    describe_cone_margin,
    least_cone_margin,
    resume_path,
)
from pushpressslide.planning.segments import remaining_ends, run_time, segment
from pushpressslide.planning.side_contacts import assignments, given_to
from pushpressslide.rom.drives import CarDrive, TwistDrive
from pushpressslide.tracking.holonomic import HolonomicTracker


class TwistPushes(Mode[CarDrive | TwistDrive]):
    """A mode of two pushes, whose segments may have a TwistDrive."""

    def tracker(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Holonomic law for a segment. Its corrections stay in a cone that uses only a
        fraction of the friction.
        """
        drive = segment.drive
        assert isinstance(drive, TwistDrive)
        friction = margins.CORRECTION_USE * query.scene.contact_friction
        cone = TwistCone(segment.contacts, friction, drive.surface)
        decay = margins.ARM.shortest(segment.profile.speed)
        return HolonomicTracker(drive.X_BV, cone.surface, decay, cone.nearest)

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation by twists in the cone of the measured contacts, about the centre
        of mass as identified.
        """
        drive = segment.drive
        assert isinstance(drive, TwistDrive)
        drive = drive.with_center(measured.estimates.center)
        contacts = measured.contacts
        cone = TwistCone(contacts, query.scene.contact_friction, drive.surface)
        start, goal = remaining_ends(query.body, segment, measured.X_WB, drive.X_BV)
        path = resume_path(start, goal, cone, drive.radius, measured.longest)
        return None if path is None else Continuation(contacts, drive, path)


def within_reach(
    query: MotionQuery, placements: Sequence[tuple[Contact, ...]]
) -> list[tuple[Contact, ...]]:
    """Placements of two contacts that two arms reach at start and goal, according to
    the reach tables.

    The reach is tested only in a search over sequences of motions. Otherwise all
    placements are returned.
    """
    if not query.from_search:
        return list(placements)
    feasibility = Feasibility(query)

    def reached(contacts: Sequence[Contact]) -> bool:
        """Whether two arms reach two contacts."""
        return any(
            all(map(feasibility.reach_ends, given_to(contacts, arms)))
            for arms in ((0, 1), (1, 0))
        )

    return [contacts for contacts in placements if reached(contacts)]


def exact_margin(scene: Scene, contacts: Sequence[Contact]) -> Margin:
    """Function that returns the margin [rad] of a twist inside the cone of
    ``contacts``.

    It uses the ellipsoid that touches the exact limit surface at that twist. For a
    twist that tips the object, the margin is far below zero.
    """

    def margin(rate: TwistRate) -> float:
        """Margin [rad] of a twist inside the cone."""
        try:
            surface = push_surface(scene, contacts[0].height, Twist(*rate))
        except ValueError:
            return -math.inf
        cone = TwistCone(contacts, scene.least_contact_friction, surface)
        return cone.cone_margin(*rate)

    return margin


def driven_by_twists(
    query: MotionQuery,
    choice: Choice,
    path: TwistPath,
    cone: TwistCone,
    push: float = 0.0,
) -> Choice:
    """``choice`` with a ``path`` made of twists in the ``cone`` of its contacts, which
    push with up to ``push`` [N].
    """
    margin = least_cone_margin(path, cone)
    drive = TwistDrive(cone.surface, path.radius, push)
    one_segment = segment(
        query, choice.mode, choice.contacts, drive, path, cone_margin=margin
    )
    summary = (
        f"path {path.distance:.3f} m of {len(path.sections)} twist(s), "
        f"{describe_cone_margin(margin)}"
    )
    time = run_time(query.motion, (one_segment,))
    return replace(choice, segments=(one_segment,), time=time, summary=summary)


def largest_push(path: TwistPath, cone: TwistCone, allocate: Allocator) -> float:
    """Largest normal force [N] of a contact along a path of twists."""
    wrenches = [cone.wrench(*rate) for rate, _ in path.sections]
    return max(max(allocate(w.fx, w.fy, w.tau).normals) for w in wrenches)


def in_free_arms(scene: Scene, choice: Choice) -> list[Choice]:
    """One copy of the choice for each assignment of its contacts to arms that do not
    cross.
    """
    (segment,) = choice.segments
    length = segment.path.length
    poses = [segment.body_pose(share * length) for share in (0.0, 0.5, 1.0)]
    points = [contact.point for contact in choice.contacts]
    return in_arms(choice, assignments(scene.bases, points, poses))
