"""A joint trajectory within limits of speed, acceleration and jerk, from joint paths.

The planned joint path is a polyline. A spline of degree five through evenly spaced
points of the path rounds its corners. Spans on which the spline exceeds a limit are
given more time. Along the contact all arms share one clock, so they stay in step with
the object.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Phase
from pushpressslide.core.plan import JointPath, Plan

SPACING = 0.01  # [rad] or [m] between points, by the joint that moves most
FREE_SPEED = 0.05  # [m/s] of a tip before its touch and on its retreat
STRETCH = 1.3  # largest factor on the time of a span in one step
STEPS = 200  # largest number of steps
SAMPLES = 12  # per span, at which limits are checked
SHARE = 0.98  # usable share of a limit: a peak may lie between two samples
DEGREE = 5  # degree of the spline: its jerk is continuous


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Limits of n joints, in metres for sliding ones."""

    speed: Array  # (n,) [rad/s]
    acceleration: Array  # (n,) [rad/s^2]
    jerk: Array  # (n,) [rad/s^3]


@dataclass(frozen=True, eq=False)
class Polyline:
    """Planned joint positions of all arms, with the phase that ends at each."""

    times: Array  # (k,) [s] as planned
    joints: Array  # (k, n) [rad]
    phases: tuple[Phase, ...]  # (k,)

    def followed_by(self, other: Polyline) -> Polyline:
        """This polyline followed by ``other``, which starts where this one ends."""
        shift = self.times[-1] - other.times[0]
        return Polyline(
            np.concatenate([self.times, other.times[1:] + shift]),
            np.vstack([self.joints, other.joints[1:]]),
            (*self.phases, *other.phases[1:]),
        )


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Samples of a smooth joint trajectory."""

    times: Array  # (m,) [s]
    positions: Array  # (m, n) [rad]
    velocities: Array  # (m, n)
    accelerations: Array  # (m, n)
    phases: tuple[Phase, ...]  # (m,)
    deviation: float  # [rad] or [m] largest, from the planned path


def planned_joints(plan: Plan, paths: Sequence[JointPath]) -> Polyline:
    """Joints of all arms (one path each) over one placement: approach, touch, motion
    and retreat.
    """
    parts = [_approach(paths)]
    touching = [path for path in paths if path.touch is not None]
    if touching:
        time = max(path.gap for path in touching) / FREE_SPEED
        rows = [
            path.approach[-1:] if path.touch is None else path.touch for path in paths
        ]
        parts.append(_evenly(rows, time, "touch"))
    parts.append(_motion(plan, paths))
    retreating = [path for path in paths if path.back is not None]
    if retreating:
        time = max(path.max_retreat for path in retreating) / FREE_SPEED
        rows = [path.move[-1:] if path.back is None else path.back for path in paths]
        parts.append(_evenly(rows, time, "release"))
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.followed_by(part)
    return whole


def smooth_trajectory(
    planned: Polyline, limits: JointLimits, period: float
) -> JointTrajectory:
    """Trajectory from rest to rest along the ``planned`` joints, sampled every
    ``period`` [s] and at the end.
    """
    knots = _evenly_spaced(planned)
    steps = np.abs(np.diff(knots.joints, axis=0))
    spans = np.maximum(np.diff(knots.times), (steps / limits.speed).max(axis=1))
    for _ in range(STEPS):
        excess = _excess(_spline(knots.joints, spans), spans, limits)
        if excess.max() <= 1.0:
            break
        # neighbouring spans also shape the spline of one that is too short
        near = np.maximum.reduce([excess, np.roll(excess, 1), np.roll(excess, -1)])
        spans = spans * np.clip(near, 1.0, STRETCH)
    else:
        largest = _excess(_spline(knots.joints, spans), spans, limits).max()
        spans = spans * max(1.0, float(largest))
    return _sampled(planned, knots, spans, period)


def _approach(paths: Sequence[JointPath]) -> Polyline:
    """Approaches of all arms. An arm that arrives early waits."""
    times = np.unique(np.concatenate([path.approach_time for path in paths]))
    rows = [_interpolated(times, path.approach_time, path.approach) for path in paths]
    return Polyline(times, np.hstack(rows), _phases("approach", len(times)))


def _evenly(rows: Sequence[Array], duration: float, phase: Phase) -> Polyline:
    """Rows (k, n) of each arm, evenly spaced over a ``duration`` [s]. A single row
    stands for an arm at rest.
    """
    count = max(len(one) for one in rows)
    shares = np.linspace(0.0, 1.0, count)
    joints = [
        _interpolated(shares, np.linspace(0.0, 1.0, len(one)), one) for one in rows
    ]
    return Polyline(duration * shares, np.hstack(joints), _phases(phase, count))


def _motion(plan: Plan, paths: Sequence[JointPath]) -> Polyline:
    """Joints along the contact, at the planned times."""
    grid = max((path.arc_length for path in paths), key=len)
    joints = [_interpolated(grid, path.arc_length, path.move) for path in paths]
    clock = [0.0]
    way = [0.0]
    for segment in plan.segments:
        profile = segment.profile
        times = np.linspace(0.0, profile.duration, 200)[1:]
        clock += (clock[-1] + times).tolist()
        way += [way[-1] + profile.state_at(t)[0] for t in times.tolist()]
    scale = float(grid[-1]) / way[-1] if way[-1] > 0.0 else 1.0
    times = np.interp(grid, scale * np.array(way), np.array(clock))
    return Polyline(times, np.hstack(joints), _phases("move", len(grid)))


def _phases(phase: Phase, count: int) -> tuple[Phase, ...]:
    return (phase,) * count


def _interpolated(grid: Array, places: Array, rows: Array) -> Array:
    """``rows`` (k, n) at rising ``places`` (k,), interpolated at a ``grid`` (m,)."""
    columns = [np.interp(grid, places, column) for column in rows.T]
    joints: Array = np.stack(columns, axis=1)
    return joints


def _lengths(joints: Array) -> Array:
    """Path length (k,) of the joint that moves most, up to each row of ``joints`` (k,
    n).
    """
    steps = np.abs(np.diff(joints, axis=0)).max(axis=1)
    lengths: Array = np.concatenate([[0.0], np.cumsum(steps)])
    return lengths


def _evenly_spaced(planned: Polyline) -> Polyline:
    """Points of a polyline at most ``SPACING`` apart, without rests."""
    lengths = _lengths(planned.joints)
    count = max(8, int(np.ceil(lengths[-1] / SPACING)))
    grid = np.linspace(0.0, lengths[-1], count + 1)
    moving = np.concatenate([[True], np.diff(lengths) > 0.0])
    places = lengths[moving]
    times = np.interp(grid, places, _without_rests(planned.times, moving))
    rows = planned.joints[moving]
    behind = np.searchsorted(places, grid).clip(0, len(places) - 1)
    numbers = np.flatnonzero(moving)[behind]
    phases = tuple(planned.phases[i] for i in numbers.tolist())
    return Polyline(times, _interpolated(grid, places, rows), phases)


def _without_rests(times: Array, moving: Array) -> Array:
    """Times [s] of the moving rows, with the rests cut out."""
    spans = np.where(moving[1:], np.diff(times), 0.0)
    clock: Array = np.concatenate([[0.0], np.cumsum(spans)])[moving]
    return clock


def _spline(joints: Array, spans: Array) -> Any:
    """Spline through ``joints`` (k, n) from rest to rest."""
    from scipy.interpolate import make_interp_spline

    rest = np.zeros(joints.shape[1])
    ends = [(1, rest), (2, rest)]
    times = np.concatenate([[0.0], np.cumsum(spans)])
    return make_interp_spline(times, joints, k=DEGREE, bc_type=(ends, ends))


def _excess(spline: Any, spans: Array, limits: JointLimits) -> Array:
    """Factors (k - 1,) by which the spans are too short, at most 1 for spans that are
    long enough.
    """
    firsts = np.concatenate([[0.0], np.cumsum(spans)])[:-1]
    shares = np.linspace(0.0, 1.0, SAMPLES)
    times = (firsts[:, None] + spans[:, None] * shares).ravel()
    speed = np.abs(spline(times, 1)) / limits.speed
    acceleration = np.abs(spline(times, 2)) / limits.acceleration
    jerk = np.abs(spline(times, 3)) / limits.jerk
    worst = np.maximum.reduce([speed, np.sqrt(acceleration), np.cbrt(jerk)]).max(axis=1)
    factors: Array = worst.reshape(-1, SAMPLES).max(axis=1) / SHARE
    return factors


def _sampled(
    planned: Polyline, knots: Polyline, spans: Array, period: float
) -> JointTrajectory:
    """Samples of the spline, with their deviation from the planned path."""
    spline = _spline(knots.joints, spans)
    clock = np.concatenate([[0.0], np.cumsum(spans)])
    times = np.append(np.arange(0.0, clock[-1], period), clock[-1])
    numbers = np.searchsorted(clock, times).clip(0, len(clock) - 1)
    positions = spline(times)
    return JointTrajectory(
        times,
        positions,
        spline(times, 1),
        spline(times, 2),
        tuple(knots.phases[i] for i in numbers.tolist()),
        _deviation(planned.joints, positions),
    )


def _deviation(planned: Array, positions: Array) -> float:
    """Largest distance [rad; m of slides] of ``positions`` (m, n) from the polyline
    ``planned`` (k, n).
    """
    nearest = np.full(len(positions), np.inf)
    for a, b in pairwise(planned):
        along = b - a
        square = float(along @ along)
        if square == 0.0:
            continue
        share = ((positions - a) @ along / square).clip(0.0, 1.0)
        off = np.abs(positions - a - share[:, None] * along).max(axis=1)
        nearest = np.minimum(nearest, off)
    return float(nearest.max())
