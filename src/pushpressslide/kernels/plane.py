"""Axes, poses and twists in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, inf, isfinite, nan, sin

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.kernel import kernel

Pose = tuple[float, float, float]
"""Pose of one frame in another: x, y [m] and yaw [rad]."""
Rate = tuple[float, float, float]
"""A twist, or a twist per metre of path: vx, vy, w."""

STRAIGHT = 1e-9  # [rad] turn below which an arc is its chord


@kernel
def in_axis(axis: Vector, v: Sequence[float]) -> Vector:
    """Components of a vector along a unit vector ``axis``, and to its left."""
    c, s = axis
    return c * v[0] + s * v[1], c * v[1] - s * v[0]


@kernel
def from_axis(axis: Vector, v: Vector) -> Vector:
    """Vector given by its components ``v`` along ``axis`` and to the left of it."""
    c, s = axis
    return c * v[0] - s * v[1], s * v[0] + c * v[1]


@kernel
def cross(a: Vector, b: Vector) -> float:
    """Z component of a x b."""
    return a[0] * b[1] - a[1] * b[0]


@kernel
def heading(yaw: float) -> Vector:
    """Unit vector at an angle [rad]. NaN for an angle that is not finite."""
    if not isfinite(yaw):
        return nan, nan
    return cos(yaw), sin(yaw)


@kernel
def flat_gap(
    tip: Vector, radius: float, normal: Vector, depth: float, ends: Vector
) -> float:
    """Gap [m] between a tip and a flat side. Infinite beyond the side's ends."""
    nx, ny = normal
    if not ends[0] <= nx * tip[1] - ny * tip[0] <= ends[1]:
        return inf
    return depth - radius - (nx * tip[0] + ny * tip[1])


@kernel
def carried(pose: Pose, rate: Rate, length: float) -> Pose:
    """Pose after a distance or time ``length`` [m or s] at a constant body twist: the
    exponential map.
    """
    return carried_from(heading(pose[2]), pose, rate, length)


@kernel
def carried_from(axis: Vector, pose: Pose, rate: Rate, length: float) -> Pose:
    """Pose after ``length`` [m], or [s], at a constant body twist, for a pose with a
    known heading vector ``axis``.
    """
    angle = rate[2] * length
    path = chord(rate, length, sin(angle), sin(0.5 * angle))
    dx, dy = from_axis(axis, path)
    return pose[0] + dx, pose[1] + dy, pose[2] + angle


@kernel
def chord(rate: Rate, length: float, sine: float, half_sine: float) -> Vector:
    """Displacement [m] in the body's initial axes. ``sine`` and ``half_sine`` are the
    sines of the turn and of half the turn.
    """
    vx, vy, w = rate
    if abs(w * length) < STRAIGHT:
        return vx * length, vy * length
    s = sine / w
    c = 2.0 * half_sine**2 / w
    return vx * s - vy * c, vx * c + vy * s
