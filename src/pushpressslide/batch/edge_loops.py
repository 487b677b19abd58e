"""``edge_friction`` made ready to be called: for one twist after the other, and compiled
for many.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np

from pushpressslide.batch import loops
from pushpressslide.core.formulas import Columns, plain
from pushpressslide.mechanics.edge_friction import friction_of_row
from pushpressslide.mechanics.face_pressure import FacePressure

ROWS = """
def {name}(edges, plane, series, twists, out):
    for i in range(out.shape[1]):
        {results} = formula(
            edges, plane, series, twists[i, 0], twists[i, 1], twists[i, 2], True
        )
"""
ROW = """
def {name}(edges, plane, series, vx, vy, w, sloped):
    return formula(edges, plane, series, vx, vy, w, sloped)
"""


def row_friction(face: FacePressure) -> Callable[[float, float, float, bool], Columns]:
    """Return ``friction_of_row`` of a twist under a face.

    Compiled where numba is loaded already, which takes longer than a run has to gain;
    the numbers are the same to the last bit.
    """
    edges = face.edges()
    series = face.series()
    if loops.loaded():
        plane = np.array(face.plane())
        return partial(compiled_row(), edges, plane, np.array(series))
    columns = tuple(map(tuple, edges.tolist()))
    return partial(plain(friction_of_row), columns, face.plane(), series)


@cache
def compiled_rows() -> Callable[..., None]:
    """Return a compiled loop over twists (n, 3), into an array (9, n)."""
    numba = loops.installed()
    assert numba is not None
    twists = numba.types.Array(numba.float64, 2, "C", readonly=True)
    out = numba.types.Array(numba.float64, 2, "C")
    results = ", ".join(f"out[{k}, i]" for k in range(9))
    return _compiled(numba, ROWS.replace("{results}", results), (twists, out))


@cache
def compiled_row() -> Callable[..., Columns]:
    """Return ``friction_of_row`` compiled."""
    numba = loops.installed()
    assert numba is not None
    speeds = (numba.float64,) * 3
    return _compiled(numba, ROW, (*speeds, numba.boolean))


def _compiled(numba: Any, text: str, arguments: tuple[Any, ...]) -> Callable[..., Any]:
    """Return a function around the formula, of edges, plane, series and ``arguments``."""
    parts = loops.registered(numba, friction_of_row)
    name = loops.digest_name(friction_of_row, [text], parts)
    body = loops.loop_of_text(friction_of_row, name, text.format(name=name), {})
    edges = numba.types.Array(numba.float64, 2, "C", readonly=True)
    plane = numba.types.Array(numba.float64, 1, "C", readonly=True)
    series = numba.types.Array(numba.complex128, 1, "C", readonly=True)
    signature = (edges, plane, series, *arguments)
    compiled: Callable[..., Any] = numba.njit(
        signature, cache=True, error_model="numpy"
    )(body)
    return compiled
