"""Formulas on columns: run by NumPy on whole columns, or by a loop over rows that numba
compiles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch import loops
from pushpressslide.batch.formulas import Column, Columns, Formula
from pushpressslide.core.arrays import Array

EVERY = slice(None)
Stage = tuple[int, Formula]
"""A formula for the rows that have this status so far."""


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns side by side in one array, which loops read fastest; or numbers."""

    kind: type[Columns]  # the NamedTuple that a formula is given of it
    rows: Array  # (n, k) a column for each field; (k,) one number for each


Argument = Columns | Table


def run(
    formula: Formula,
    arguments: Sequence[Argument],
    results: Sequence[Column],
    stages: Sequence[Stage] = (),
    status: int = 0,
) -> None:
    """Write ``formula(*arguments)`` into ``results``; then that of each stage, in the
    rows that have its status in the result number ``status``.

    Each argument is a NamedTuple of columns, or a table; the formula is given one row
    of each, as a NamedTuple. The results are arrays (n,) or (k, n), filled one after
    the other.
    """
    if loops.compiler() is None:
        _run_numpy(formula, arguments, results)
        _run_stages(stages, arguments, results, results[status])
        return
    letters = tuple(map(_letters, arguments))
    layout = loops.Layout(
        tuple(map(_kind, arguments)),
        letters,
        tuple((r.dtype.char, len(r) if r.ndim == 2 else 0) for r in results),
        tuple(code for code, _ in stages),
        status,
    )
    inputs: list[Array] = []
    for argument, letter in zip(arguments, letters, strict=True):
        inputs += _arrays(argument, letter)
    formulas = (formula, *(later for _, later in stages))
    loops.compiled_loop(formulas, layout)(*inputs, *results)


def _kind(argument: Argument) -> type[Columns]:
    return argument.kind if isinstance(argument, Table) else type(argument)


def _letters(argument: Argument) -> str:
    """Return the letters of ``loops.Layout``."""
    if isinstance(argument, Table):
        return "t" if argument.rows.ndim == 2 else "s" * len(argument.rows)
    return "".join(map(_letter, argument))


def _letter(column: Column) -> str:
    """Return the letter of a column; one that repeats a number counts as this number."""
    if column.ndim == 0:
        return "s"
    if column.flags.c_contiguous:
        return "c"
    return "v" if column.strides[0] else "s"


def _arrays(argument: Argument, letters: str) -> list[Array]:
    """Return the arrays that a loop is given of an argument: a table, or the columns
    and the single numbers.
    """
    if isinstance(argument, Table):
        return [argument.rows]
    columns = []
    numbers = []
    for column, letter in zip(argument, letters, strict=True):
        if letter == "s":
            numbers.append(column if column.ndim == 0 else column[0])
        else:
            columns.append(column)
    return [*columns, np.array(numbers)] if numbers else columns


def _run_numpy(
    formula: Formula,
    arguments: Sequence[Argument],
    results: Sequence[Column],
    rows: NDArray[np.intp] | slice = EVERY,
) -> None:
    """Run a formula on whole columns."""
    inputs = []
    for argument in arguments:
        group = argument.rows.T if isinstance(argument, Table) else argument
        chosen = (c if c.ndim == 0 else c[rows] for c in group)
        inputs.append(_kind(argument)(*chosen))
    with np.errstate(all="ignore"):
        values = formula(*inputs)
    columns = [
        c for result in results for c in (result if result.ndim == 2 else [result])
    ]
    for column, value in zip(columns, values, strict=True):
        column[rows] = value


def _run_stages(
    stages: Sequence[Stage],
    arguments: Sequence[Argument],
    results: Sequence[Column],
    statuses: Column,
) -> None:
    """Run each stage on the rows that have its status."""
    codes = [code for code, _ in stages]
    if not codes or statuses.max(initial=min(codes) - 1) < min(codes):
        return
    for code, formula in stages:
        rows = (statuses == code).nonzero()[0]
        if len(rows):
            _run_numpy(formula, arguments, results, rows)


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


def figures(*values: ArrayLike) -> tuple[Array, ...]:
    """Return numbers and sequences as arrays of floats."""
    return tuple(np.asarray(value, dtype=np.float64) for value in values)


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
    kind = type(figures)
    if not any(figure.ndim for figure in figures):
        return Table(kind, np.array(figures))
    return kind(*(column(figure, shape) for figure in figures))


def leading_shape(figures: Columns) -> tuple[int, ...]:
    """Return the leading shape of figures."""
    return np.broadcast_shapes(*{figure.shape for figure in figures})
