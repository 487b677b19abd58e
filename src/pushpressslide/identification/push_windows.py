"""Pairs of wrench and motion from streams, one for each window of a push.

A push is an interval of contact, which is divided into windows of equal motion. Each
window gives the mean wrench, and the motion as a straight line through its poses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.pose import Point
from pushpressslide.identification.clock_offset import (
    ClockOffset,
    OffsetFit,
    touching_force,
)
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.pairs import LENGTH, Pairs, rotated
from pushpressslide.identification.streams import LONGEST_GAP, Stream, Streams
from pushpressslide.identification.tip_contact import TipContact

# [m] smallest motion (x, y, LENGTH yaw) in a window; noise of 0.3 mm turns its
# direction by 2 degrees
WINDOW = 0.01
LEAST_POSES = 6  # smallest number of poses in a window
FREE_GAP = 5e-3  # [m] gap above which the tip is free: the force is its bias
LEAST_FREE = 20  # smallest number of samples for a bias
NEAR = (
    8e-3  # [m] of a gap that contact may seem to have, by errors of outline and radius
)
LEAST_NEAR = 0.6  # share of the contact with the tip within NEAR
FAR = 0.3  # [m] smallest gap of a recording with wrong units
PULLING = math.radians(60.0)  # from the face's normal: the force has other axes


@dataclass(frozen=True, eq=False)
class PushedWindows:
    """Windows of the pushes in a recording."""

    pairs: Pairs
    numbers: NDArray[np.intp]  # (n,) number of each window's push
    offset: ClockOffset
    normals: Array  # (n, 2) mean unit normal of the contact, in B, into the object
    travels: Array  # (n,) [m] travel of the contact along the face
    refused: tuple[str, ...]  # omitted windows and pushes, and why
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Aligned:
    """Object, tip and force of a recording on the arm's clock."""

    source: str
    object: Stream
    tip: Stream
    force: Stream
    offset: ClockOffset
    notes: tuple[str, ...]


def push_windows(
    streams: Streams, tip_contact: TipContact, center: Point, options: LogOptions
) -> PushedWindows:
    """Windows of a complete recording. ``center`` [m] is the centre of mass in G.

    Raises PushPressSlideError for streams without common times or without contact, and
    if units or axes cannot be right for a push.
    """
    aligned = align(streams, tip_contact, options)
    found = _Windows(aligned, tip_contact, np.array(center))
    rows = []
    refused = []
    for number, (first, last) in enumerate(_pushes(aligned), 1):
        windows, reason = found.of_push(first, last)
        rows += [(number, row) for row in windows]
        if reason:
            refused.append(f"push {number} at {first:.2f} s: {reason}")
    if not rows:
        reason = refused[0] if refused else "the tip never pushes"
        raise PushPressSlideError(f"{streams.source}: no push can be used ({reason})")
    numbers = np.array([number for number, _ in rows])
    table = np.array([row for _, row in rows])
    pairs = Pairs(table[:, :3], table[:, 3:6], table[:, 6:8], table[:, 8])
    _check_axes(streams.source, pairs, table[:, 9:11])
    return PushedWindows(
        pairs,
        numbers,
        aligned.offset,
        table[:, 9:11],
        table[:, 11],
        tuple(refused),
        aligned.notes,
    )


def align(streams: Streams, tip_contact: TipContact, options: LogOptions) -> _Aligned:
    """Streams of a recording on the arm's clock, with unbiased forces of the tip on the
    object in world axes.

    Raises PushPressSlideError as ``push_windows``.
    """
    placed, tip, force = streams.object, streams.tip, streams.force
    if placed is None or tip is None or force is None:
        raise PushPressSlideError(
            f"{streams.source}: {', '.join(streams.missing)} missing"
        )
    given = options.offset
    for name, stream in (("object", placed), ("tip", tip), ("force", force)):
        _check_rate(streams.source, name, stream)
    _check_overlap(streams.source, placed.shifted(given or 0.0), tip, force)
    _check_reach(streams.source, placed, tip, tip_contact)
    force = _in_world(streams, force, options)
    force, note = _without_bias(placed.shifted(given or 0.0), tip, force, tip_contact)
    if given is None:
        fit = OffsetFit(streams.source, placed, tip, force, tip_contact)
        offset = fit.offset()
    else:
        offset = ClockOffset(given)
    placed = placed.shifted(offset.seconds)
    _check_contact(streams.source, placed, tip, force, tip_contact)
    return _Aligned(
        streams.source,
        placed,
        tip,
        force,
        offset,
        (*streams.notes, *((f"{streams.source}: {note}",) if note else ())),
    )


def _in_world(streams: Streams, force: Stream, options: LogOptions) -> Stream:
    """Force of the tip on the object in world axes."""
    values = force.values if options.force_on == "object" else -force.values
    if options.force_frame == "world":
        return Stream(force.times, values)
    if streams.tip_yaw is None:
        raise PushPressSlideError(
            f"{streams.source}: column tip_yaw is missing; --force-frame tip needs the "
            "orientation of the tip"
        )
    yaw = streams.tip_yaw
    turns = Stream(yaw.times, np.unwrap(yaw.values[:, 0])[:, None]).values_at(
        force.times
    )
    return Stream(force.times, rotated(values, turns[:, 0]))


def _without_bias(
    placed: Stream, tip: Stream, force: Stream, tip_contact: TipContact
) -> tuple[Stream, str]:
    """Force minus its median while the tip is free, and a note if the tip is never
    free.
    """
    times = force.times
    known = tip.covers(times) & placed.covers(times)
    gaps = tip_contact.gaps(times[known], tip, placed)
    free = np.flatnonzero(known)[gaps > FREE_GAP]
    if len(free) < LEAST_FREE:
        return force, "the tip is never free; forces are assumed to have no bias."
    bias = np.median(force.values[free], axis=0)
    return replace(force, values=force.values - bias), ""


def _check_rate(source: str, name: str, stream: Stream) -> None:
    """Raise PushPressSlideError if samples are too far apart."""
    step = float(np.median(np.diff(stream.times)))
    if step > LONGEST_GAP:
        raise PushPressSlideError(
            f"{source}: the samples of {name} are {step:.3g} s apart; allowed: "
            f"at most {LONGEST_GAP:g} s; --unit time=ms reads milliseconds (also us, ns)"
        )


def _check_overlap(source: str, placed: Stream, tip: Stream, force: Stream) -> None:
    first = max(stream.times[0] for stream in (placed, tip, force))
    last = min(stream.times[-1] for stream in (placed, tip, force))
    if last > first:
        return
    spans = ", ".join(
        f"{name} {stream.times[0]:.6g} to {stream.times[-1]:.6g} s"
        for name, stream in (("object", placed), ("tip", tip), ("force", force))
    )
    raise PushPressSlideError(
        f"{source}: the streams have no time in common: {spans}; --offset S is added to "
        "the object's"
    )


def _check_reach(
    source: str, placed: Stream, tip: Stream, tip_contact: TipContact
) -> None:
    """Raise PushPressSlideError if the tip is never near the object."""
    times = tip.times[(tip.times >= placed.times[0]) & (tip.times <= placed.times[-1])]
    if not len(times):
        return
    nearest = float(tip_contact.gaps(times, tip, placed).min())
    if nearest > FAR:
        raise PushPressSlideError(
            f"{source}: the tip never comes within {nearest:.3g} m of the object; "
            "allowed: metres in one frame; --unit object=mm --unit tip=mm reads millimetres"
        )


def _check_contact(
    source: str, placed: Stream, tip: Stream, force: Stream, tip_contact: TipContact
) -> None:
    """Raise PushPressSlideError if the tip is not at the side of the shape while it
    pushes.
    """
    size = np.hypot(*force.values.T)
    known = tip.covers(force.times) & placed.covers(force.times)
    times = force.times[known & (size > touching_force(force))]
    if not len(times):
        return
    gaps = np.abs(tip_contact.gaps(times, tip, placed))
    near = float((gaps < NEAR).mean())
    if near < LEAST_NEAR:
        raise PushPressSlideError(
            f"{source}: the tip is within {1e3 * NEAR:g} mm of the shape's side in "
            f"{100.0 * near:.0f} % of the contact, with a median gap of "
            f"{1e3 * float(np.median(gaps)):.0f} mm; allowed: at least "
            f"{100.0 * LEAST_NEAR:g} %; the tip must push the side, and the pose must be "
            "that of the shape's frame G"
        )


def _check_axes(source: str, pairs: Pairs, normals: Array) -> None:
    """Raise PushPressSlideError if the forces do not point into the object."""
    along = (pairs.wrenches[:, :2] * normals).sum(1)
    angle = np.arccos(along / np.hypot(*pairs.wrenches[:, :2].T).clip(1e-12))
    typical = float(np.median(angle))
    if typical <= PULLING:
        return
    remedy = "--force-frame tip turns forces from the tip's axes"
    if typical > math.pi - PULLING:
        remedy = "--force-on tip reads the force on the tip"
    raise PushPressSlideError(
        f"{source}: the force is {math.degrees(typical):.0f} degrees off the normal into "
        f"the object; allowed: the force on the object in world axes; {remedy}"
    )


def _pushes(aligned: _Aligned) -> list[tuple[float, float]]:
    """Intervals of contact [s], from the force."""
    times = aligned.force.times
    size = np.hypot(*aligned.force.values.T)
    touching = size > touching_force(aligned.force)
    # a moment without force, or a gap in the stream, does not end a push
    edges = np.diff(np.concatenate([[False], touching, [False]]).astype(int))
    starts = times[np.flatnonzero(edges == 1)]
    ends = times[np.flatnonzero(edges == -1) - 1]
    pushes: list[tuple[float, float]] = []
    for first, last in zip(starts, ends, strict=True):
        if pushes and first - pushes[-1][1] < LONGEST_GAP:
            pushes[-1] = (pushes[-1][0], last)
        else:
            pushes.append((first, last))
    return pushes


@dataclass(frozen=True, eq=False)
class _Windows:
    """Division of pushes into windows."""

    aligned: _Aligned
    tip_contact: TipContact
    center: Array  # (2,) [m] centre of mass in G

    def of_push(self, first: float, last: float) -> tuple[list[Array], str]:
        """Figures (12,) of each window of a push, and the reason if windows are
        missing.

        They are fx, fy, tau, dx, dy, yaw, contact x, y, height, the normal, and the
        contact's travel along the face.
        """
        times = self.aligned.object.times
        inside = np.flatnonzero((times >= first) & (times <= last))
        if len(inside) < LEAST_POSES:
            return [], f"{len(inside)} poses"
        poses = self.aligned.object.values[inside]
        ends = _cuts(poses * (1.0, 1.0, LENGTH))
        if len(ends) < 2:
            moved = 1e3 * float(
                np.linalg.norm((poses[-1] - poses[0]) * (1.0, 1.0, LENGTH))
            )
            return [], f"moved {moved:.1f} mm, less than {1e3 * WINDOW:g} mm"
        rows = []
        reason = ""
        for a, b in pairwise(ends):
            row = self._row(inside[a : b + 1])
            if isinstance(row, str):
                reason = row
            else:
                rows.append(row)
        return rows, reason

    def _row(self, inside: NDArray[np.intp]) -> Array | str:
        """Figures of one window, or the reason why it is invalid."""
        aligned = self.aligned
        times = aligned.object.times[inside]
        if (np.diff(times) > LONGEST_GAP).any():
            return f"a gap of over {LONGEST_GAP:g} s between poses"
        force = aligned.force
        samples = np.flatnonzero((force.times >= times[0]) & (force.times <= times[-1]))
        clock = force.times[samples]
        covered = aligned.tip.covers(clock) & force.covers(clock)
        if len(clock) < LEAST_POSES or not covered.all():
            return f"a gap of over {LONGEST_GAP:g} s in force or tip"
        motion, pose = _line(times, aligned.object.values[inside], clock)
        tip = aligned.tip.values_at(clock)
        contact = self.tip_contact.contacts(tip[:, :2], pose)
        if abs(float(np.median(contact.gaps))) > NEAR:
            gap = 1e3 * float(np.median(contact.gaps))
            return f"the tip is {gap:.0f} mm off the side"
        points = contact.points - self.center
        forces = rotated(force.values[samples], -pose[:, 2])
        torque = points[:, 0] * forces[:, 1] - points[:, 1] * forces[:, 0]
        middle = 0.5 * (pose[0, 2] + pose[-1, 2])
        com = rotated(np.tile(self.center, (2, 1)), pose[[0, -1], 2])
        shift = motion[:2] + com[1] - com[0]
        normal = contact.normals.mean(0)
        travel = points[-3:].mean(0) - points[:3].mean(0)
        wrench = [*forces.mean(0), torque.mean()]
        twist = [*rotated(shift, -middle), motion[2]]
        face = [*(normal / np.linalg.norm(normal)), float(np.linalg.norm(travel))]
        return np.array([*wrench, *twist, *points.mean(0), tip[:, 2].mean(), *face])


def _cuts(poses: Array) -> list[int]:
    """Indices that cut poses (n, 3) [m] into windows of at least ``WINDOW`` and
    ``LEAST_POSES``.

    The object's rest before and after the motion belongs to no window.
    """
    cuts: list[int] = []
    start = _first_motion(poses)
    if start is None:
        return cuts
    cuts.append(start)
    for i in range(start, len(poses)):
        far = np.linalg.norm(poses[i] - poses[cuts[-1]]) >= WINDOW
        if far and i - cuts[-1] >= LEAST_POSES - 1:
            cuts.append(i)
    return cuts


def _first_motion(poses: Array) -> int | None:
    """Index of the first pose after a motion by a tenth of a window, or None."""
    moved = np.linalg.norm(poses - poses[: LEAST_POSES // 2].mean(0), axis=1)
    moving = np.flatnonzero(moved > 0.1 * WINDOW)
    return int(moving[0]) if len(moving) else None


def _line(times: Array, poses: Array, clock: Array) -> tuple[Array, Array]:
    """Motion (3,) on a straight line fitted to ``poses``, between the ends of
    ``clock``, and the poses (m, 3) on the line at ``clock`` (m,) [s].
    """
    middle = times.mean()
    matrix = np.column_stack([np.ones(len(times)), times - middle])
    fitted = np.linalg.lstsq(matrix, poses, rcond=None)[0]
    on_line = fitted[0] + np.outer(clock - middle, fitted[1])
    return fitted[1] * (clock[-1] - clock[0]), on_line
