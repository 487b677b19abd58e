"""A formula of a row and a sample, summed over all samples: what integrals over a
pressure are made of.

With NumPy in blocks of rows that stay in the cache; with numba in a loop over rows and
samples, which may add up in any order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from pushpressslide.batch import loops
from pushpressslide.batch.elementwise import Table
from pushpressslide.batch.loops import digest_name, loop_of_text, registered
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Columns, Formula

BLOCK = 32  # rows that NumPy takes at a time
# what the compiler may do to a sum: another order, products and sums in one step
REORDERED = ("reassoc", "contract", "nsz", "arcp")


def sums(formula: Formula, row: Table, samples: Columns, size: int) -> Array:
    """Return the sums (n, ``size``) of ``formula(row, sample)`` over ``samples``.

    ``samples`` is a NamedTuple of arrays (m,); the formula returns ``size`` numbers.
    """
    out = np.empty((len(row.rows), size))
    if loops.compiler() is None:
        _sum_numpy(formula, row, samples, out)
    else:
        loop = _compiled_sum(formula, row.kind, type(samples), size)
        loop(row.rows, *samples, out)
    return out


def _sum_numpy(formula: Formula, row: Table, samples: Columns, out: Array) -> None:
    """Write the sums into ``out``."""
    for start in range(0, len(out), BLOCK):
        block = slice(start, start + BLOCK)
        columns = row.kind(*(c[:, None] for c in row.rows[block].T))
        with np.errstate(all="ignore"):
            parts = formula(columns, samples)
        for k, part in enumerate(parts):
            out[block, k] = part.sum(axis=1)


TEXT = """
def {name}(rows, {samples}, out):
    for i in range(out.shape[0]):
        {zeros}
        for j in range(x0.shape[0]):
            {parts} = formula(Row({fields}), Sample({items}))
            {additions}
        {stores}
"""


def _text(name: str, fields: int, samples: int, size: int) -> str:
    """Return the loop as Python."""
    numbers = range(size)
    return TEXT.format(
        name=name,
        samples=", ".join(f"x{k}" for k in range(samples)),
        zeros="; ".join(f"s{k} = 0.0" for k in numbers),
        parts="".join(f"p{k}, " for k in numbers),
        fields=", ".join(f"rows[i, {k}]" for k in range(fields)),
        items=", ".join(f"x{k}[j]" for k in range(samples)),
        additions="; ".join(f"s{k} += p{k}" for k in numbers),
        stores="; ".join(f"out[i, {k}] = s{k}" for k in numbers),
    )


@cache
def _compiled_sum(
    formula: Formula, row: type[Columns], sample: type[Columns], size: int
) -> Callable[..., None]:
    """Return the compiled loop."""
    numba = loops.compiler()
    assert numba is not None
    parts: Sequence[Callable[..., Any]] = [*registered(numba, formula), row, sample]
    fields = len(row._fields)  # type: ignore[attr-defined]
    samples = len(sample._fields)  # type: ignore[attr-defined]
    name = digest_name(
        formula, [_text("loop", fields, samples, size), *REORDERED], parts
    )
    text = _text(name, fields, samples, size)
    loop = loop_of_text(formula, name, text, {"Row": row, "Sample": sample})
    table = numba.types.Array(numba.float64, 2, "C", readonly=True)
    column = numba.types.Array(numba.float64, 1, "C", readonly=True)
    out = numba.types.Array(numba.float64, 2, "C")
    signature = numba.void(table, *[column] * samples, out)
    compiled = numba.njit(
        signature, cache=True, error_model="numpy", fastmath=set(REORDERED)
    )
    summed: Callable[..., None] = compiled(loop)
    return summed
