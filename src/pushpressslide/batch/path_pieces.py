"""Paths of arcs and lines on arrays: where each of many vehicles is beside the piece that
it is on. Source: ``core.path``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.batch.angles import arctan2, cos, sin
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, greater, least, where
from pushpressslide.core.path import ArcPath


class Piece(NamedTuple):
    """The piece of its path that a vehicle is on, and the bends at its two ends."""

    x: Column  # [m] its start, in the world
    y: Column
    yaw: Column  # [rad]
    start: Column  # [m] arc length there
    end: Column  # [m] arc length at its end; infinite on the line after the path
    curvature: Column  # [1/m]
    change: Column  # [1/m] of the curvature at its start
    room: Column  # [m] from there to the nearer end of the path
    next_change: Column  # the same at its end
    next_room: Column


class Beside(NamedTuple):
    """Where the nearest point of the piece is."""

    progress: Column  # [m] arc length
    left: Column  # [m] of the path from the vehicle
    yaw: Column  # [rad] of the path
    curvature: Column  # [1/m]


def pieces_of(path: ArcPath) -> Array:
    """Return the pieces (10, p + 1) of a path, the line after its end the last: the
    fields of ``Piece``.
    """
    rows = []
    pieces = (*path.pieces, (0.0, math.inf))
    curvatures = [curvature for curvature, _ in path.pieces]
    # the path's own ends bend nothing
    changes = [0.0, *np.diff(curvatures).tolist(), 0.0, 0.0]
    rooms = [min(s, path.length - s) for s, _ in path.starts] + [0.0]
    for i, ((curvature, length), (s, pose)) in enumerate(
        zip(pieces, path.starts, strict=True)
    ):
        bends = (changes[i], rooms[i], changes[i + 1], rooms[i + 1])
        rows.append((pose.x, pose.y, pose.yaw, s, s + length, curvature, *bends))
    return np.array(rows).T.copy()


def beside(x: Column, y: Column, progress: Column, piece: Piece) -> Beside:
    """Return the nearest point of ``piece`` to (x, y) [m], of a vehicle that was at
    arc length ``progress`` [m]; beyond its end the piece goes on.
    """
    c = cos(piece.yaw)
    s = sin(piece.yaw)
    along = c * (x - piece.x) + s * (y - piece.y)
    aside = c * (y - piece.y) - s * (x - piece.x)
    k = piece.curvature
    bent = k != 0.0
    per = 1.0 / where(bent, k, 1.0)
    across = 1.0 - k * aside
    guess = k * (progress - piece.start)  # of the circle's turns that one is meant
    turn = arctan2(k * along, across)
    turn = turn - 2.0 * math.pi * np.floor((turn - guess) / (2.0 * math.pi) + 0.5)
    out = np.sqrt(k * k * along * along + across * across)
    return Beside(
        piece.start + where(bent, turn * per, along),
        where(bent, (out - 1.0) * per, -aside),
        piece.yaw + where(bent, turn, 0.0),
        k,
    )


def eased(at: Beside, half: Column, piece: Piece) -> Beside:
    """Return heading and curvature of the path averaged over ``half`` [m] before and
    behind: of the two bends at the ends of the piece.
    """
    yaw, curvature = bend(at.progress - piece.start, half, piece.change, piece.room)
    end = where(piece.end < math.inf, piece.end, 0.0)
    ahead, bent = bend(at.progress - end, half, piece.next_change, piece.next_room)
    return Beside(
        at.progress,
        at.left,
        at.yaw + yaw + ahead,
        at.curvature + curvature + bent,
    )


def bend(
    off: Column, half: Column, change: Column, room: Column
) -> tuple[Column, Column]:
    """Return what a bend adds to heading [rad] and curvature [1/m], ``off`` [m] beyond
    it.
    """
    near = least(half, room)
    left = greater(near - np.abs(off), 0.0)
    share = 0.5 * left / where(near > 0.0, near, 1.0)
    return 0.5 * change * left * share, change * where(off < 0.0, share, -share)
