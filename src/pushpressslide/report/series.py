"""What follows from a record: poses, contact forces in the contact's axes, travel along
the surface.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.control import PHASES
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, MotionPath, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Cylinder, Task

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CONTACT_FORCE = 0.1
"""[N] measured normal force below which a tip counts as not in contact."""

SLIP_PLAY = 1e-4
"""[m] by which a tip may wander on the surface before it counts as slip."""


def wrap_angles(angles: Array) -> Array:
    """Return angles [rad] wrapped into [-pi, pi)."""
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)


def compose(poses: Array, X_BC: Pose2 | Array) -> Array:
    """Return X_AC (N, 3) of poses X_AB (N, 3) and X_BC, one or (N, 3); the yaw is not
    wrapped.
    """
    dx, dy, turn = (X_BC.x, X_BC.y, X_BC.yaw) if isinstance(X_BC, Pose2) else X_BC.T
    c = np.cos(poses[:, 2])
    s = np.sin(poses[:, 2])
    x = poses[:, 0] + c * dx - s * dy
    y = poses[:, 1] + s * dx + c * dy
    return np.stack([x, y, poses[:, 2] + turn], axis=1)


def planar_poses(positions: Array) -> Array:
    """Return (N, 3) x, y [m], yaw [rad] of (N, 7) quaternions (w, x, y, z) and
    positions.
    """
    w, x, y, z = (positions[:, i] for i in range(4))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([positions[:, 4], positions[:, 5], yaw], axis=1)


def ticks(record: Record) -> int:
    """Return the number of ticks that were recorded."""
    return len(record.arrays.get("time", ()))


def in_phase(record: Record, *names: str) -> Mask:
    """Return which ticks (N,) are in one of the named phases."""
    wanted = [i for i, phase in enumerate(PHASES) if phase in names]
    return np.isin(record.arrays["phase"], wanted)


def contact_phase(record: Record) -> Mask:
    """Return which ticks (N,) lie from the first to the last of phase "move" of a
    grasp, regained contacts included.
    """
    mask = np.zeros(ticks(record), dtype=bool)
    move = in_phase(record, "move")
    # a grasp ends where its tips are drawn back
    number = np.cumsum(
        np.diff(in_phase(record, "release").astype(np.int8), prepend=0) < 0
    )
    for i in np.unique(number):
        (at,) = np.nonzero(move & (number == i))
        if len(at):
            mask[at[0] : at[-1] + 1] = True
    return mask


def by_grasp(plan: Plan, record: Record) -> list[tuple[Plan, Record]]:
    """Return the plan of each grasp that was begun, and what was recorded of it."""
    of = []
    leg = record.arrays["leg"]
    for grasp in plan.by_placement:
        at = np.isin(leg, [stretch.leg for stretch in grasp.segments])
        if at.any():
            rows = {
                k: v[at] for k, v in record.arrays.items() if not k.startswith("plan_")
            }
            stretch = np.isin(record.arrays["plan_stretch"], rows["stretch"])
            rows |= {
                k: record.arrays[k][stretch] for k in ("plan_path", "plan_stretch")
            }
            of.append((grasp, replace(record, arrays=rows)))
    return of


def tracked_poses(task: Task, record: Record) -> Array:
    """Return X_WV (N, 3): the tracking point, as planned for the stretch of each tick,
    and its heading.
    """
    return compose(
        compose(record.arrays["object_pose"], task.object.X_GB),
        record.arrays["vehicle_frame"],
    )


def stretch_paths(record: Record) -> list[Array]:
    """Return the reference path of each stretch of the plan: (K, 3) poses of V in the
    world.
    """
    path = record.arrays["plan_path"]
    of = record.arrays["plan_stretch"]
    return [path[of == i] for i in range(1 + int(of.max(initial=-1)))]


def path_errors(task: Task, record: Record) -> Array:
    """Return the distance [m] (N,) of the tracking point to the path of the stretch
    that it is on.
    """
    tracked = tracked_poses(task, record)[:, :2]
    out = np.empty(ticks(record))
    for i, path in enumerate(stretch_paths(record)):
        at = record.arrays["stretch"] == i
        out[at] = distance_to_polyline(tracked[at], path[:, :2])
    return out


def path_length(path: MotionPath) -> float:
    """Return the way [m] of the tracking point along a path; a turn on the spot is
    none.
    """
    if isinstance(path, ArcPath):
        return path.length
    return sum(math.hypot(vx, vy) * length for (vx, vy, _), length in path.pieces)


def contact_forces(
    plan: Plan, record: Record, name: str = "measured_force"
) -> tuple[Array, Array]:
    """Return the normal (N, C) and the two tangential components (N, C, 2) [N] of
    forces ON the object.

    For C contacts, each of its own arm. Side contact: along the face's inward normal;
    to the left of it, and up. Top contact: down; x and y in B. ``name`` is the record's
    array, world axes.
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
            normals[:, i], tangents[:, i, 0], tangents[:, i, 1] = -z, x, y
        else:
            n = contact.normal
            normals[:, i] = n[0] * x + n[1] * y
            tangents[:, i, 0], tangents[:, i, 1] = -n[1] * x + n[0] * y, z
    return normals, tangents


def surface_coordinates(task: Task, record: Record, contact: Contact) -> Array:
    """Return where on the object's surface the tip of ``contact`` touches: (N, 2) [m].

    Side contact: along the face (round a cylinder: the arc) and up; top contact: x and
    y in B. A sphere touches a flat face at the foot of its centre, whatever the force,
    so that the tip's centre decides.
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
    n = contact.normal
    along = -n[1] * x + n[0] * y
    if isinstance(task.object.shape, Cylinder):
        inward = -(n[0] * x + n[1] * y)
        along = task.object.shape.radius * np.arctan2(along, inward)
    return np.stack([along, tip[:, 2]], axis=1)


def travel(points: Array, play: float = 0.0) -> Array:
    """Return the way (N,) that ``points`` (N, k) have gone so far, less jitter within
    ``play`` [same unit].

    A follower is dragged along like a stone on a string of length ``play``: what stays
    within that distance moves it not at all, however often; a long way counts but for
    ``play``, a reversal but for twice that.
    """
    way = np.zeros(len(points))
    if len(points) == 0:
        return way
    if play <= 0.0:
        way[1:] = np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))
        return way
    follower = np.array(points[0], dtype=np.float64)
    total = 0.0
    for i in range(1, len(points)):
        gap = points[i] - follower
        distance = float(np.sqrt(gap @ gap))
        if distance > play:
            follower += (1.0 - play / distance) * gap
            total += distance - play
        way[i] = total
    return way


def slip(plan: Plan, record: Record, index: int) -> Array:
    """Return the cumulative slip [m] (N,) of contact ``index`` along the surface, in
    phase "move" while its tip touches.

    Each stretch of unbroken contact is taken by itself: where the tip lands after a
    loss is no slip. Jitter below ``SLIP_PLAY`` is not summed (see ``travel``). A tip
    that rolls counts as one that slips.
    """
    normals, _ = contact_forces(plan, record)
    touching = in_phase(record, "move") & (normals[:, index] >= CONTACT_FORCE)
    points = surface_coordinates(plan.task, record, plan.contacts[index])
    out = np.zeros(ticks(record))
    before = 0.0
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], touching, [False]]).astype(np.int8))
    )
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        way = before + travel(points[start:stop], SLIP_PLAY)
        out[start:stop], out[stop:] = way, way[-1]
        before = float(way[-1])
    return out


def distance_to_polyline(points: Array, line: Array) -> Array:
    """Return the distance [m] (N,) of ``points`` (N, 2) to the nearest point of a
    polyline (K, 2), K >= 2.
    """
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
