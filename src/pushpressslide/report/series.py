"""Time series derived from a record.

Poses, contact forces in the contact's axes, errors, travel along the surface.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import ObjectModel
from pushpressslide.mechanics.faces import side_of

Mask = NDArray[np.bool_]

CONTACT_FORCE = 0.1
"""Measured normal force [N] below which a tip counts as out of contact."""

STATE = ("object_pose", "object_twist", "tip_position", "time")
"""Arrays that are finite at every tick unless the engine has failed."""

SLIP_PLAY = 1e-4
"""Motion [m] of a tip on the surface below which it does not count as slip."""


def wrap_angles(angles: Array) -> Array:
    """Angles [rad] wrapped into [-pi, pi)."""
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)


def compose(poses: Array, X_BC: Pose2 | Array) -> Array:
    """Poses X_AC (N, 3) from poses X_AB (N, 3) and X_BC, which is one pose or (N, 3).

    The yaw is not wrapped.
    """
    dx, dy, turn = (X_BC.x, X_BC.y, X_BC.yaw) if isinstance(X_BC, Pose2) else X_BC.T
    c = np.cos(poses[:, 2])
    s = np.sin(poses[:, 2])
    x = poses[:, 0] + c * dx - s * dy
    y = poses[:, 1] + s * dx + c * dy
    return np.stack([x, y, poses[:, 2] + turn], axis=1)


def planar_poses(positions: Array) -> Array:
    """Planar poses (N, 3), x, y [m] and yaw [rad], from quaternions (w, x, y, z) and
    positions (N, 7).
    """
    w, x, y, z = (positions[:, i] for i in range(4))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([positions[:, 4], positions[:, 5], yaw], axis=1)


def ticks(record: Record) -> int:
    """Number of recorded ticks."""
    return len(record.arrays.get("time", ()))


def finite_ticks(record: Record) -> int:
    """Number of ticks before the first one whose state contains NaN or infinity."""
    count = ticks(record)
    for name in STATE:
        values = record.arrays.get(name)
        if values is None:
            continue
        finite = np.isfinite(values).reshape(len(values), -1).all(axis=1)
        count = min(count, int(np.argmin(np.append(finite, False))))
    return count


def finite_part(record: Record) -> Record:
    """Part of the record before the first tick whose state contains NaN or infinity."""
    count = finite_ticks(record)
    if count == ticks(record):
        return record
    arrays = {
        name: values if name.startswith("plan_") else values[:count]
        for name, values in record.arrays.items()
    }
    return replace(record, arrays=arrays)


def in_phase(record: Record, *names: str) -> Mask:
    """Mask (N,) of the ticks in any of the named phases."""
    wanted = [i for i, phase in enumerate(PHASES) if phase in names]
    return np.isin(record.arrays["phase"], wanted)


def contact_phase(record: Record) -> Mask:
    """Mask (N,) of the ticks from the first to the last of a placement's phase "move".

    The ticks in which a lost contact is touched again are included.
    """
    mask = np.zeros(ticks(record), dtype=bool)
    move = in_phase(record, "move")
    number = record.arrays["placement"]
    for i in np.unique(number):
        (moving,) = np.nonzero(move & (number == i))
        if len(moving):
            mask[moving[0] : moving[-1] + 1] = True
    return mask


def by_placement(plan: Plan, record: Record) -> list[tuple[Plan, Record]]:
    """Plan and record of each started placement."""
    begun = []
    number = record.arrays["placement"]
    for i, placement in enumerate(plan.by_placement):
        own = number == i
        if own.any():
            rows = {
                k: v[own] for k, v in record.arrays.items() if not k.startswith("plan_")
            }
            planned = np.isin(record.arrays["plan_stretch"], rows["stretch"])
            rows |= {
                k: record.arrays[k][planned] for k in ("plan_path", "plan_stretch")
            }
            begun.append((placement, replace(record, arrays=rows)))
    return begun


def tracked_poses(body: ObjectModel, record: Record) -> Array:
    """Poses X_WV (N, 3) of the tracking point and heading of each tick's segment."""
    return compose(
        compose(record.arrays["object_pose"], body.X_GB),
        record.arrays["vehicle_frame"],
    )


def segment_paths(record: Record) -> list[Array]:
    """Reference path of each segment of the plan, as poses X_WV (K, 3)."""
    path = record.arrays["plan_path"]
    number = record.arrays["plan_stretch"]
    return [path[number == i] for i in range(1 + int(number.max(initial=-1)))]


def path_errors(body: ObjectModel, record: Record) -> Array:
    """Distances (N,) [m] of the tracking point from the path of its segment."""
    tracked = tracked_poses(body, record)[:, :2]
    out = np.empty(ticks(record))
    for i, path in enumerate(segment_paths(record)):
        own = record.arrays["stretch"] == i
        out[own] = distance_to_polyline(tracked[own], path[:, :2])
    return out


def timed_errors(record: Record) -> tuple[Array, Array, Array]:
    """Time [s], position error [m] and signed yaw error [rad], all (N,).

    The errors are deviations from the pose in the first plan at the same time. The
    plan's clock starts at the first touch of each placement. Errors are NaN before the
    motion and after it.
    """
    offset = record.arrays["object_pose"] - record.arrays["reference_pose"]
    moving = contact_phase(record)
    position = np.where(moving, np.hypot(offset[:, 0], offset[:, 1]), np.nan)
    return (
        record.arrays["time"],
        position,
        np.where(moving, wrap_angles(offset[:, 2]), np.nan),
    )


@dataclass(frozen=True, slots=True)
class Motion:
    """Series over the M ticks of phase "move".

    Errors are relative to the first plan, over all K ticks from the first touch of each
    placement to the end of its motion.
    """

    position_error: Array  # (K,) [m] to the first plan at the same time
    yaw_error: Array  # (K,) [rad] signed, to the first plan at the same time
    path_error: Array  # [m] of the tracking point to the path
    tracking_error: Array  # (M, 3) along [m], left [m], heading [rad]: the law's own
    tracked: Array  # (M, 2) [m] tracking point in the world
    segment: Array  # index of the segment of the plan

    @property
    def path_length(self) -> float:
        """Length [m] of the tracking point's path, summed over the segments."""
        return sum(
            float(travel(self.tracked[self.segment == i])[-1])
            for i in np.unique(self.segment)
        )


def motion(body: ObjectModel, record: Record) -> Motion:
    """Series of phase "move"."""
    move = in_phase(record, "move")
    _, position_error, yaw_error = timed_errors(record)
    judged = contact_phase(record)
    return Motion(
        position_error[judged],
        yaw_error[judged],
        path_errors(body, record)[move],
        record.arrays["tracking_error"][move],
        tracked_poses(body, record)[move, :2],
        record.arrays["stretch"][move],
    )


def contact_forces(
    plan: Plan, record: Record, name: str = "measured_force"
) -> tuple[Array, Array]:
    """Normal (N, C) and tangential (N, C, 2) components [N] of forces ON the object.

    There are C contacts, each of a different arm. The normal component of a side
    contact is along the face's inward normal, and the tangential components point to
    the left and up. The normal component of a top contact points down, and the
    tangential components are along x and y of B. ``name`` is the record's array, in
    world axes.
    """
    forces = record.arrays[name]
    yaw = record.arrays["object_pose"][:, 2]
    contacts = plan.contacts
    normals = np.empty((len(yaw), len(contacts)))
    tangents = np.empty((len(yaw), len(contacts), 2))
    c = np.cos(yaw)
    s = np.sin(yaw)
    for i, contact in enumerate(contacts):
        wx, wy, z = forces[:, contact.arm].T
        x = c * wx + s * wy
        y = -s * wx + c * wy
        if contact.kind == "top":
            normals[:, i] = -z
            tangents[:, i] = np.stack([x, y], axis=1)
        else:
            n = contact.normal
            normals[:, i] = n[0] * x + n[1] * y
            tangents[:, i] = np.stack([-n[1] * x + n[0] * y, z], axis=1)
    return normals, tangents


def surface_coordinates(body: ObjectModel, record: Record, contact: Contact) -> Array:
    """Position (N, 2) [m] at which the tip of ``contact`` touches the object's surface.

    For a side contact, the coordinates are along the face (along the arc of a cylinder)
    and up; for a top contact, x and y in B. A sphere touches a flat face at the foot of
    the perpendicular from its centre, whatever the force, so the coordinates follow
    from the tip's centre.
    """
    tip = record.arrays["tip_position"][:, contact.arm]
    pose = record.arrays["object_pose"]
    c = np.cos(pose[:, 2])
    s = np.sin(pose[:, 2])
    dx = tip[:, 0] - pose[:, 0]
    dy = tip[:, 1] - pose[:, 1]
    x = c * dx + s * dy
    y = -s * dx + c * dy  # in G; B has the same axes
    if contact.kind == "top":
        return np.stack([x, y], axis=1)
    side = side_of(body, contact)
    along = side.coordinates(x - body.center_of_mass[0], y - body.center_of_mass[1])
    return np.stack([along, tip[:, 2]], axis=1)


def travel(points: Array, play: float = 0.0) -> Array:
    """Cumulative distance (N,) travelled by ``points`` (N, k), without jitter within
    ``play`` [same unit].

    The distance is that of a follower dragged on a string of length ``play``, which
    small motions do not move. A long motion therefore loses ``play``, and each reversal
    loses twice as much.
    """
    distance = np.zeros(len(points))
    if len(points) == 0:
        return distance
    if play <= 0.0:
        distance[1:] = np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))
        return distance
    follower = np.array(points[0], dtype=np.float64)
    total = 0.0
    for i in range(1, len(points)):
        gap = points[i] - follower
        lead = float(np.sqrt(gap @ gap))
        if lead > play:
            follower += (1.0 - play / lead) * gap
            total += lead - play
        distance[i] = total
    return distance


def slip(plan: Plan, record: Record, index: int) -> Array:
    """Cumulative slip (N,) [m] of contact ``index`` along the surface.

    Slip counts in phase "move" while the tip touches the object. A shift of the tip
    while contact is lost does not count. Jitter below ``SLIP_PLAY`` is not summed (see
    ``travel``). Rolling of the tip counts as slip.
    """
    normals, _ = contact_forces(plan, record)
    touching = in_phase(record, "move") & (normals[:, index] >= CONTACT_FORCE)
    points = surface_coordinates(plan.task.scene.body, record, plan.contacts[index])
    out = np.zeros(ticks(record))
    before = 0.0
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], touching, [False]]).astype(np.int8))
    )
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        slipped = before + travel(points[start:stop], SLIP_PLAY)
        out[start:stop] = slipped
        out[stop:] = slipped[-1]
        before = float(slipped[-1])
    return out


def distance_to_polyline(points: Array, line: Array) -> Array:
    """Distances (N,) [m] of ``points`` (N, 2) to a polyline (K, 2), K >= 2."""
    start = line[:-1]
    span = np.diff(line, axis=0)
    squared = np.maximum(np.einsum("kd,kd->k", span, span), 1e-24)
    out = np.empty(len(points))
    for first in range(0, len(points), 2000):
        part = points[first : first + 2000]
        offset = part[:, None, :] - start[None, :, :]
        u = np.clip(np.einsum("nkd,kd->nk", offset, span) / squared, 0.0, 1.0)
        gap = offset - u[:, :, None] * span[None, :, :]
        out[first : first + 2000] = np.sqrt(
            np.einsum("nkd,nkd->nk", gap, gap).min(axis=1)
        )
    return out
