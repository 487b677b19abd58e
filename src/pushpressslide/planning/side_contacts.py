"""Contacts of arms that push an object's sides: height, distance, and assignment to
arms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pushpressslide.core import margins
from pushpressslide.core.control import Vector3
from pushpressslide.core.motion import FORCE_ALLOWED, Limits, Motion
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2, cross
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces, room_ahead


def contact_height(scene: Scene, motion: Motion) -> float:
    """Height [m] of the contacts above the support, the same for all arms that may
    touch.

    It is as low as possible with the wrists above the object, since a push at height h
    shifts the CoP by h mu_s.
    """
    return _height(scene, motion, _upright(scene))


def lone_contact_height(scene: Scene, motion: Motion) -> float:
    """Height [m] of the single contact of a push.

    If a push with the wrist above the object would tip it, the contact is lower and the
    tool leans back, with its wrist behind the object.
    """
    body = scene.body
    slack = body.shape.base_depth(body.center_of_mass)
    # [m] up to which the object surely stands, whatever the direction of the push
    stands = margins.PUSH_STANDS * slack / max(scene.most_friction, 1e-9)
    upright = _upright(scene)
    return _height(scene, motion, upright if upright <= stands else 0.0)


def _upright(scene: Scene) -> float:
    """Smallest height [m] of a contact with the wrist above the object."""
    reach = min(robot.tip_length for robot in scene.tips)
    return scene.body.shape.height + margins.ARM.wrist_gap - reach


def _height(scene: Scene, motion: Motion, min_height: float) -> float:
    """Height [m] of contacts that need at least ``min_height`` [m]."""
    if motion.contact_height is not None:
        return motion.contact_height
    height = scene.body.shape.height
    radius = max(robot.tip_radius for robot in scene.tips)
    arm = margins.ARM
    low = max(radius + arm.tool_gap, min_height)
    lowest = radius + arm.table_gap
    highest = height - 0.5 * radius
    inside = max(min(max(low, min(arm.low, 0.5 * height)), highest), lowest)
    lean = margins.side_lean(scene.contact_friction)
    return scene.body.shape.side_height(inside, (lowest, highest), radius, lean)


def least_distance(scene: Scene) -> float:
    """Smallest distance [m] between the contacts of two tips."""
    return sum(robot.tip_radius for robot in scene.robots) + margins.ARM.tool_room


def side_contact(arm: int, face: Face, left: float, height: float) -> Contact:
    """Contact on a face at ``height`` [m], a distance ``left`` [m] to the left of the
    line through the CoM along the normal.
    """
    return Contact(arm, "side", on_face(face, left), face.normal, height)


def pushable(scene: Scene, height: float, index: int | None = None) -> list[Face]:
    """Faces of the object that the tips can touch at a ``height`` [m], with contacts
    clear of their corners.

    With ``index``, only the face with that index.
    """
    lean = margins.side_lean(scene.contact_friction)
    found = faces(scene.body, scene.inset, scene.tip_radius, height, lean)
    return [face for face in found if index in (None, face.index)]


def untouchable(scene: Scene, height: float) -> Refusal:
    """Refusal of a push on a side that no tip can touch at a ``height`` [m]."""
    section = scene.body.shape.section(height)
    lean = section.least_lean(scene.tip_radius)
    allowed = margins.side_lean(scene.contact_friction)
    if lean <= allowed:
        text = "no part of the side at {figure:mm.0f} can be touched"
        return Refusal("no_faces", text, height, None, "m")
    text = (
        f"its sides lean by {{figure:deg.0f}} at {1e3 * height:.0f} mm, where a tip "
        "would lift or wedge it, allowed up to {allowed:deg.0f} with the tip's friction"
    )
    return Refusal("leaning", text, lean, allowed, "rad")


def before_contacts(scene: Scene, motion: Motion, contacts: Sequence[Contact]) -> float:
    """Distance [m] from their contacts at which tips start the touch: that of the
    motion, or less in a narrow notch.
    """
    wanted = motion.approach_distance
    margins = (room_before(scene, c, wanted, motion.clearance) for c in contacts)
    return min(margins, default=wanted)


def room_before(
    scene: Scene, contact: Contact, wanted: float, clearance: float
) -> float:
    """Distance [m] by which a tip can retreat from its contact.

    It is ``wanted`` [m], or less in a notch, with a ``clearance`` [m] to the notch's
    other wall.
    """
    if contact.kind == "top":
        return wanted
    radius = scene.robots[contact.arm].tip_radius
    origin = scene.body.X_GB.position
    side = scene.body.shape.section(contact.height)
    path = side.free_space(contact.point, contact.normal, radius, origin)
    return min(wanted, max(path - clearance, 0.5 * path))


def drag_refusal(
    query: MotionQuery, pushed: Sequence[Face], contacts: int, height: float
) -> Refusal | None:
    """Refusal of pushing faces with a number of ``contacts`` at ``height`` [m], or
    None.

    It checks the object's height, tipping, and whether the force is too small to be
    felt or too large for a single contact. For two contacts, which share the force,
    ``push_refusal`` checks its size.
    """
    scene = query.scene
    top = scene.body.shape.height
    radius = max(robot.tip_radius for robot in scene.tips)
    smooth = margins.OVER_EDGE_FRICTION * scene.contact_friction
    over = min(margins.OVER_EDGE, smooth) * radius
    if height > top + over:
        text = "touched at {figure:mm.0f}, the object is {allowed:mm.0f} high"
        return Refusal("above_object", text, height, top, "m")
    ahead = min(room_ahead(scene.body, face) for face in pushed)
    share = 1.0 - margins.PUSH_TIPPING_MARGIN
    highest = share * ahead / scene.most_friction
    if height > highest:
        text = (
            "touched at {figure:mm.1f}, allowed up to {allowed:mm.1f}, "
            f"{share:g} of the height at which the object tips"
        )
        return Refusal("tipping", text, height, highest, "m")
    max_friction = scene.max_friction()
    felt = margins.ARM.felt_force  # noise hides it, but the object is seen to move
    if contacts > 1:
        felt = margins.ARM.least_friction
    if max_friction < felt:
        text = (
            "the object slides at {figure:N.2f}, before the contacts are felt: allowed "
            "from {allowed:N.2f}"
        )
        return Refusal("light", text, max_friction, felt, "N")
    limit = query.limits.planned_force
    if contacts == 1 and max_friction > limit:
        text = f"needs {{figure:N.1f}}, {FORCE_ALLOWED}"
        return Refusal("normal_force", text, max_friction, limit, "N")
    return None


def push_refusal(push: float, limits: Limits, max_friction: float) -> Refusal | None:
    """Refusal of the force of two contacts, one of which pushes with up to ``push``
    [N], or None.

    The support friction of the object is ``max_friction`` [N].
    """
    limit = limits.planned_force
    squeeze = margins.SQUEEZE * max_friction
    if push > limit:
        text = f"pushed with up to {{figure:N.1f}}, {FORCE_ALLOWED}"
        return Refusal("normal_force", text, push, limit, "N")
    if push > squeeze:
        text = (
            "pushed with up to {figure:N.1f}, a squeeze: allowed {allowed:N.1f}, "
            f"{margins.SQUEEZE:g} times the drag"
        )
        return Refusal("squeeze", text, push, squeeze, "N")
    return None


def assignments(
    bases: Sequence[Vector3], points: Sequence[Point], poses: Sequence[Pose2]
) -> list[tuple[int, int]]:
    """Assignments of two contacts to two arms that do not cross, those with the nearest
    arms first.

    ``bases`` [m] are those of the arms, ``points`` [m] are in B, and ``poses`` X_WB are
    those along the motion. Element i of an assignment is the arm of contact i.
    """
    out = []
    for arms in ((0, 1), (1, 0)):
        (ax, ay, _), (bx, by, _) = (bases[arm] for arm in arms)
        tips = [[X.apply(p) for p in points] for X in poses]
        if any(_cross((ax, ay), a, (bx, by), b) for a, b in tips):
            continue
        distance = sum(math.dist((ax, ay), a) + math.dist((bx, by), b) for a, b in tips)
        out.append((distance, arms))
    return [arms for _, arms in sorted(out)]


def given_to(contacts: Sequence[Contact], arms: Sequence[int]) -> tuple[Contact, ...]:
    """The ``contacts`` assigned to ``arms``: presses first, then pushes in the order of
    the arms.
    """
    assigned = (
        replace(contact, arm=arm) for contact, arm in zip(contacts, arms, strict=True)
    )
    return tuple(sorted(assigned, key=lambda c: (c.kind == "side", c.arm)))


def _cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether the segments a-b and c-d cross each other."""

    def side(p: Point, q: Point, r: Point) -> bool:
        """Whether r is to the left of the line from p to q."""
        return cross((q[0] - p[0], q[1] - p[1]), (r[0] - p[0], r[1] - p[1])) > 0.0

    return side(a, b, c) != side(a, b, d) and side(c, d, a) != side(c, d, b)
