"""Formulas on columns: run by NumPy on whole columns, or by a loop over rows that numba
compiles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from pushpressslide.batch import loops
from pushpressslide.batch.rows import figures as figures
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, Formula


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns side by side in one array, which loops read fastest."""

    kind: type[Columns]  # the NamedTuple that a formula is given of it
    rows: Array  # (n, k) a column for each field


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """Columns that are single numbers, all of them."""

    columns: Columns


Argument = Columns | Table | Numbers


def run(
    formula: Formula, arguments: Sequence[Argument], results: Sequence[Column]
) -> None:
    """Write ``formula(*arguments)`` into ``results``.

    Each argument is a NamedTuple of columns, a table or numbers; the formula is given
    one row of each, as a NamedTuple. The results are arrays (n,) or (k, n), filled one after
    the other.
    """
    if loops.compiler() is None:
        _run_numpy(formula, arguments, results)
        return
    kinds, letters, inputs = zip(*map(_for_loop, arguments), strict=True)
    lines = tuple((r.dtype.char, len(r) if r.ndim == 2 else 0) for r in results)
    layout = loops.Layout(kinds, letters, lines)
    loops.compiled_loop(formula, layout)(*chain(*inputs), *results)


def _for_loop(argument: Argument) -> tuple[type[Columns], str, list[Array]]:
    """Return the kind of an argument, its letters in ``loops.Layout``, and its arrays: a
    table, or the columns and then the numbers.

    A column that repeats a number counts as this number.
    """
    if isinstance(argument, Table):
        return argument.kind, "t", [argument.rows]
    if isinstance(argument, Numbers):
        array = np.array(argument.columns)
        return type(argument.columns), "s" * len(array), [array]
    letters = ""
    arrays = []
    numbers = []
    for column in argument:
        if column.ndim == 0:
            letters += "s"
            numbers.append(column)
        elif column.flags.c_contiguous:
            letters += "c"
            arrays.append(column)
        elif column.strides[0]:
            letters += "v"
            arrays.append(column)
        else:
            letters += "s"
            numbers.append(column[0])
    if numbers:
        arrays.append(np.array(numbers))
    return type(argument), letters, arrays


def _run_numpy(
    formula: Formula, arguments: Sequence[Argument], results: Sequence[Column]
) -> None:
    """Run a formula on whole columns."""
    inputs = [_columns(argument) for argument in arguments]
    with np.errstate(all="ignore"):
        values = formula(*inputs)
    columns = [
        c for result in results for c in (result if result.ndim == 2 else [result])
    ]
    for column, value in zip(columns, values, strict=True):
        column[:] = value


def _columns(argument: Argument) -> Columns:
    """Return what a formula is given of an argument."""
    if isinstance(argument, Numbers):
        return argument.columns
    if isinstance(argument, Table):
        return argument.kind(*argument.rows.T)
    return argument


def table(kind: type[Columns], array: Array, shape: tuple[int, ...]) -> Table:
    """Return an array (..., k) as a table of the leading ``shape``, flattened."""
    k = array.shape[-1]
    whole = array if array.shape[:-1] == shape else np.broadcast_to(array, (*shape, k))
    return Table(kind, np.ascontiguousarray(whole.reshape(-1, k)))


def table_or_columns(
    kind: type[Columns], array: Array, shape: tuple[int, ...]
) -> Argument:
    """Return an array (..., k) as ``table`` does; as columns where they lie in one
    piece each, like those of results, or repeat one number: they are not copied.
    """
    k = array.shape[-1]
    whole = array if array.shape[:-1] == shape else np.broadcast_to(array, (*shape, k))
    rows = whole.reshape(-1, k)
    if rows.strides[0] in (0, rows.itemsize) and k > 1:
        return kind(*rows.T)
    return Table(kind, np.ascontiguousarray(rows))


def column(array: Array, shape: tuple[int, ...]) -> Column:
    """Return an array as a column of the leading ``shape``, flattened; a single number
    as it is.
    """
    if array.ndim == 0:
        return array
    whole = array if array.shape == shape else np.broadcast_to(array, shape)
    return whole.reshape(-1)


def values(
    formula: Formula,
    arguments: Sequence[Argument],
    shape: tuple[int, ...],
    sizes: Sequence[int],
) -> list[Array]:
    """Return ``formula(*arguments)`` as arrays of the leading ``shape``, each with as
    many columns as ``sizes`` says; 0: one, without an axis.
    """
    n = math.prod(shape)
    flat = [np.empty((size, n) if size else n) for size in sizes]
    run(formula, arguments, flat)
    return [
        array.T.reshape((*shape, size) if size else shape)
        for array, size in zip(flat, sizes, strict=True)
    ]


def columns_of(figures: Columns, shape: tuple[int, ...]) -> Argument:
    """Return figures as columns of the leading ``shape``; single numbers as they are."""
    if not any(figure.ndim for figure in figures):
        return Numbers(figures)
    return type(figures)(*(column(figure, shape) for figure in figures))


def leading_shape(figures: Columns) -> tuple[int, ...]:
    """Return the leading shape of figures."""
    return np.broadcast_shapes(*{figure.shape for figure in figures})
