"""The nearest wrench of the cone of two side contacts, for wrenches outside of it: the
answer of ``allocation.projections.WrenchCone.nearest``.

Source: docs/mechanics.md, section 6. Distances are in the norm diag(1, 1, 1/rho^2).
"""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.allocation.projections import FLAT
from pushpressslide.core.formulas import Column, where


class Edge(NamedTuple):
    """One edge of a contact's friction cone."""

    fx: Column  # force for a normal force of 1 N
    fy: Column
    turn: Column  # its moment over rho
    square: Column  # of (fx, fy, turn)
    inverse: Column  # 1 / square


def edge_of(
    px: Column, py: Column, nx: Column, ny: Column, friction: Column, rho: Column
) -> Edge:
    """Return the left edge of a cone; the right one with the negative friction."""
    fx = nx - friction * ny
    fy = ny + friction * nx
    turn = (px * fy - py * fx) / rho
    square = square_of(fx, fy, turn)
    return Edge(fx, fy, turn, square, 1.0 / square)


class Nearest(NamedTuple):
    """The nearest wrench so far: parts of at most two edges, and its squared distance."""

    distance: Column
    first: Column
    second: Column
    first_edge: Column  # number of the edge, -1: none
    second_edge: Column


def edge_parts(
    fx: Column, fy: Column, z: Column, edges: tuple[Edge, Edge, Edge, Edge]
) -> tuple[Column, Column, Column, Column]:
    """Return how much of each edge is in the nearest wrench of the cone.

    The nearest of the four edges and their six pairs, as ``WrenchCone.nearest``; ``z``
    is the moment over rho.
    """
    a, b, c, d = edges
    best = Nearest(square_of(fx, fy, z), 0.0, 0.0, -1.0, -1.0)
    best = with_edge(best, 0.0, fx, fy, z, a)
    best = with_edge(best, 1.0, fx, fy, z, b)
    best = with_edge(best, 2.0, fx, fy, z, c)
    best = with_edge(best, 3.0, fx, fy, z, d)
    best = with_edges(best, (0.0, 1.0), fx, fy, z, a, b)
    best = with_edges(best, (0.0, 2.0), fx, fy, z, a, c)
    best = with_edges(best, (0.0, 3.0), fx, fy, z, a, d)
    best = with_edges(best, (1.0, 2.0), fx, fy, z, b, c)
    best = with_edges(best, (1.0, 3.0), fx, fy, z, b, d)
    best = with_edges(best, (2.0, 3.0), fx, fy, z, c, d)
    return (
        edge_part(best, 0.0),
        edge_part(best, 1.0),
        edge_part(best, 2.0),
        edge_part(best, 3.0),
    )


def edge_part(best: Nearest, edge: float) -> Column:
    """Return the part of the edge of this number."""
    one = where(best.first_edge == edge, best.first, 0.0)
    return one + where(best.second_edge == edge, best.second, 0.0)


def with_edge(
    best: Nearest, number: float, fx: Column, fy: Column, z: Column, edge: Edge
) -> Nearest:
    """Return the nearest wrench so far, or that along one edge."""
    k = (edge.fx * fx + edge.fy * fy + edge.turn * z) * edge.inverse
    distance = square_of(fx - k * edge.fx, fy - k * edge.fy, z - k * edge.turn)
    better = (k > 0.0) & (distance < best.distance)
    return Nearest(
        where(better, distance, best.distance),
        where(better, k, best.first),
        best.second,
        where(better, number, best.first_edge),
        best.second_edge,
    )


def with_edges(
    best: Nearest,
    numbers: tuple[float, float],
    fx: Column,
    fy: Column,
    z: Column,
    a: Edge,
    b: Edge,
) -> Nearest:
    """Return the nearest wrench so far, or that between two edges."""
    k, m = pair_parts(fx, fy, z, a, b)
    distance = square_of(
        fx - k * a.fx - m * b.fx,
        fy - k * a.fy - m * b.fy,
        z - k * a.turn - m * b.turn,
    )
    better = (k > 0.0) & (m > 0.0) & (distance < best.distance)
    return Nearest(
        where(better, distance, best.distance),
        where(better, k, best.first),
        where(better, m, best.second),
        where(better, numbers[0], best.first_edge),
        where(better, numbers[1], best.second_edge),
    )


def square_of(x: Column, y: Column, z: Column) -> Column:
    """Return the square of a vector."""
    return x * x + y * y + z * z


def pair_parts(
    fx: Column, fy: Column, z: Column, a: Edge, b: Edge
) -> tuple[Column, Column]:
    """Return the parts of two edges in the nearest wrench of their plane; zero where
    they span none.
    """
    nx = a.fy * b.turn - a.turn * b.fy
    ny = a.turn * b.fx - a.fx * b.turn
    nz = a.fx * b.fy - a.fy * b.fx
    area = square_of(nx, ny, nz)
    spans = area >= FLAT * FLAT * a.square * b.square
    product = a.fx * b.fx + a.fy * b.fy + a.turn * b.turn
    on_a = a.fx * fx + a.fy * fy + a.turn * z
    on_b = b.fx * fx + b.fy * fy + b.turn * z
    inverse = where(spans, 1.0 / area, 0.0)
    k = (b.square * on_a - product * on_b) * inverse
    m = (a.square * on_b - product * on_a) * inverse
    return k, m
