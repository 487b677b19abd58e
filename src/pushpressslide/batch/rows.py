"""Kernels over rows of any leading shape: compiled by numba, the extra ``fast``, or in
Python if numba is not installed.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch import fast
from pushpressslide.core.arrays import Array

Kernel = Callable[..., tuple[Any, ...]]
AnyArray = NDArray[Any]
Like = tuple[Any, ...]
"""Nested tuples of floats, as the arguments of a kernel."""


class Figures(NamedTuple):
    """Parameters of a law: one set for all rows, or one set per row."""

    table: Array  # (..., k) the numbers of ``like``, in their order
    like: Like

    @property
    def shape(self) -> tuple[int, ...]:
        """The leading shape."""
        return self.table.shape[:-1]


NO_FIGURES = Figures(np.zeros(0), ())


def figures(*values: ArrayLike) -> tuple[Array, ...]:
    """Numbers and sequences as arrays of floats."""
    return tuple(np.asarray(value, dtype=np.float64) for value in values)


def figures_of(*groups: Any) -> Figures:
    """Parameters with their leading shape, from nested tuples of arrays (...)."""
    return Figures(_table(list(leaves(groups))), map_nested(groups, lambda _: 0.0))


def _table(columns: Sequence[ArrayLike]) -> Array:
    """Columns (...) as an array (..., k) that stores each column contiguously."""
    if not any(map(np.ndim, columns)):
        return np.array(columns, dtype=np.float64)
    shape = np.broadcast_shapes(*map(np.shape, columns))
    out = np.empty((len(columns), *shape))
    for place, column in enumerate(columns):
        out[place] = column
    return _turned(out)


def _turned(array: Array) -> Array:
    """The array with its first axis moved to the end."""
    return array.transpose(*range(1, array.ndim), 0)


def halves(vectors: Array) -> tuple[Array, Array]:
    """The two components of vectors (..., 2)."""
    return vectors[..., 0], vectors[..., 1]


def prepared(setup: Kernel, *groups: Any) -> Figures:
    """Parameters that a ``setup`` kernel computes from nested tuples of arrays (...)."""
    given = figures_of(*groups)
    width = given.table.shape[-1]
    first = given.table.reshape(-1, width)[:1].tolist() or [[1.0] * width]
    one = setup(*filled(given.like, first[0]))
    like = map_nested(one, lambda _: 0.0)
    if not given.shape:
        return Figures(_table(list(leaves(one))), like)
    columns = sum(1 for _ in leaves(one))
    return Figures(answers(setup, given, columns=columns), like)


def leaves(values: Any) -> Iterator[Any]:
    """Yield the members of nested tuples, from left to right."""
    if isinstance(values, tuple):
        for value in values:
            yield from leaves(value)
    else:
        yield values


def filled(like: Any, numbers: Sequence[float]) -> Any:
    """``numbers`` as tuples nested like ``like``."""
    each = iter(numbers)
    return map_nested(like, lambda _: next(each))


def map_nested(values: Any, number: Callable[[Any], float]) -> Any:
    """``values`` with every number mapped by ``number``, and the nesting kept."""
    if not isinstance(values, tuple):
        return number(values)
    parts = [map_nested(value, number) for value in values]
    make = getattr(type(values), "_make", tuple)
    return make(parts)


def nested(values: Any) -> Any:
    """Nested lists as nested tuples."""
    return tuple(map(nested, values)) if isinstance(values, list) else values


def spread(array: Array) -> Figures:
    """Numbers of an array (..., k) as k arguments of a kernel."""
    return Figures(array, (0.0,) * array.shape[-1])


def grouped(array: Array) -> Figures:
    """Numbers of an array (..., k) as one tuple argument of a kernel."""
    return Figures(array, ((0.0,) * array.shape[-1],))


def columns_of(*columns: Array) -> tuple[Figures, ...]:
    """Arrays (...) as separate arguments of a kernel."""
    return tuple(Figures(column[..., None], (0.0,)) for column in columns)


def stacked_arguments(*parts: Figures) -> Figures:
    """Arguments of a kernel side by side, broadcast against each other."""
    columns = [
        c for p in parts for c in p.table.transpose(-1, *range(p.table.ndim - 1))
    ]
    return Figures(_table(columns), sum((part.like for part in parts), ()))


def answers(
    kernel: Kernel,
    row: Figures | Sequence[Figures],
    figures: Figures = NO_FIGURES,
    arrays: tuple[AnyArray, ...] = (),
    *,
    columns: int,
) -> Array:
    """Results of ``kernel(*row, *figures, *arrays)`` for each row (..., ``columns``),
    with nested tuples flattened. Rows and ``figures``, the parameters, broadcast
    against each other.

    A ``row`` may consist of several sets of arguments, side by side. ``arrays`` are the
    same for all rows; in Python a kernel receives them as nested tuples.
    """
    parts = (row,) if isinstance(row, Figures) else tuple(row)
    if figures.shape:  # a row has figures of its own
        parts = (*parts, figures)
        figures = NO_FIGURES
    shape = np.broadcast_shapes(*(part.shape for part in parts))
    rows = tuple(_flat(part.table, shape) for part in parts)
    out = np.empty((columns, math.prod(shape)))
    given = tuple(np.ascontiguousarray(array) for array in arrays)
    kinds = tuple((array.dtype.char, array.ndim) for array in given)
    heads = tuple(part.like for part in parts)
    loop = _compiled(kernel, heads, figures.like, kinds)
    loop(rows, figures.table[None], given, out)
    return _turned(out.reshape(columns, *shape))


def _flat(table: Array, shape: tuple[int, ...]) -> Array:
    """A table with the leading ``shape`` as (n, k)."""
    k = table.shape[-1]
    if table.shape[:-1] != shape:
        table = np.broadcast_to(table, (*shape, k))
    return table.reshape(math.prod(shape), k)


def _compiled(
    kernel: Kernel,
    heads: tuple[Like, ...],
    like: Like,
    kinds: tuple[tuple[str, int], ...],
) -> Callable[..., None]:
    """Loop of a kernel, by numba or in Python."""
    if fast.compiler() is None:
        if fast.installed() is None:
            _say_slow()
        return _interpreted(kernel, sum(heads, ()), like)
    from pushpressslide.batch.compiled import loop_over

    return loop_over(kernel, heads, like, kinds)


@cache
def _say_slow() -> None:
    """Warn, once, that batches are slow because numba is not installed."""
    warnings.warn(
        "numba is not installed: batches run in Python, row by row; "
        "pip install 'pushpressslide[fast]'",
        stacklevel=5,
    )


def _interpreted(kernel: Kernel, head: Like, like: Like) -> Callable[..., None]:
    """Loop of a kernel in Python, in place of ``compiled.loop_over``."""

    def loop(
        rows: tuple[Array, ...],
        figures: Array,
        arrays: tuple[AnyArray, ...],
        out: Array,
    ) -> None:
        """Write the kernel's results for all rows."""
        given = filled(like, figures[0].tolist())
        rest = tuple(nested(array.tolist()) for array in arrays)
        with np.errstate(all="ignore"):  # as compiled: no number in, no number out
            for i, row in enumerate(np.concatenate(rows, axis=1).tolist()):
                answer = kernel(*filled(head, row), *given, *rest)
                out[:, i] = tuple(leaves(answer))

    return loop
