"""One formula, two ways to run it: NumPy on whole columns, and a loop over rows that
numba compiles.

A formula is a plain function of floats. It has no branches: ``where`` chooses between
two values that are both worked out. So NumPy can run it on columns, and numba on one
row at a time. numba is the extra ``fast``; it is imported at the first use, and what it
compiles is kept on disk.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import FunctionType, ModuleType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.core.arrays import Array

Column = Any
"""In NumPy an array (n,), one number a row, or of no dimension, the same number in
every row; in a compiled loop the number of one row.
"""
Flag = Any
"""A column of truth values."""
Rows = NDArray[np.intp]
Columns = tuple[Column, ...]
Formula = Callable[..., Columns]


def where(condition: Flag, a: Column | float, b: Column | float) -> Column:
    """Return ``a`` where the condition holds, ``b`` elsewhere."""
    return np.where(condition, a, b)


def least(a: Column | float, b: Column | float) -> Column:
    """Return the lesser of two numbers; ``b`` where one is not a number."""
    return where(a < b, a, b)


def greater(a: Column | float, b: Column | float) -> Column:
    """Return the greater of two numbers; ``b`` where one is not a number."""
    return where(a > b, a, b)


@cache
def compiler() -> ModuleType | None:
    """Return numba; None where it is not installed."""
    try:
        numba = importlib.import_module("numba")
        extending = importlib.import_module("numba.extending")
    except ImportError:
        return None

    def chosen(condition: Any, a: Any, b: Any) -> Any:
        def choose(condition: Any, a: Any, b: Any) -> Any:
            return a if condition else b

        return choose

    extending.overload(where)(chosen)
    return numba


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns side by side in one array, which loops read fastest."""

    kind: type[Columns]  # the NamedTuple that a formula is given of it
    rows: Array  # (n, k) a column for each field


Argument = Columns | Table


def run(
    formula: Formula,
    arguments: Sequence[Argument],
    results: Sequence[Column],
    rows: Rows | None = None,
) -> None:
    """Write ``formula(*arguments)`` into ``results``; of ``rows`` alone where these are
    given.

    Each argument is a NamedTuple of columns, or a table; the formula is given one row
    of each, as a NamedTuple. The results are arrays (n,) or (n, k), filled one after
    the other.
    """
    if compiler() is None:
        _run_numpy(formula, arguments, results, rows)
        return
    layout = _Layout(
        tuple(map(_kind, arguments)),
        tuple(map(_letters, arguments)),
        tuple((r.dtype.char, r.shape[1] if r.ndim == 2 else 0) for r in results),
        rows is not None,
    )
    inputs = [
        float(item) if item.ndim == 0 else item
        for argument in arguments
        for item in ((argument.rows,) if isinstance(argument, Table) else argument)
    ]
    selection = () if rows is None else (rows,)
    _compiled_loop(formula, layout)(*inputs, *results, *selection)


def _kind(argument: Argument) -> type[Columns]:
    return argument.kind if isinstance(argument, Table) else type(argument)


def _letters(argument: Argument) -> str:
    """Return a letter for each array of an argument: t table, c column, s one number."""
    if isinstance(argument, Table):
        return "t"
    return "".join("s" if c.ndim == 0 else "c" for c in argument)


def _run_numpy(
    formula: Formula,
    arguments: Sequence[Argument],
    results: Sequence[Column],
    rows: Rows | None,
) -> None:
    """Run a formula on whole columns."""
    selection = slice(None) if rows is None else rows
    inputs = []
    for argument in arguments:
        group = argument.rows.T if isinstance(argument, Table) else argument
        chosen = (c if c.ndim == 0 else c[selection] for c in group)
        inputs.append(_kind(argument)(*chosen))
    with np.errstate(all="ignore"):
        values = formula(*inputs)
    columns = [
        c for result in results for c in (result.T if result.ndim == 2 else [result])
    ]
    for column, value in zip(columns, values, strict=True):
        column[selection] = value


LOOP = """
def {name}({parameters}):
    for {index}:
        {results} = formula({arguments})
"""


@dataclass(frozen=True, slots=True)
class _Layout:
    """What a loop goes over."""

    groups: tuple[type[Columns], ...]  # NamedTuples that the formula is given
    letters: tuple[str, ...]  # of each group
    results: tuple[tuple[str, int], ...]  # NumPy's letter, and the columns; 0: one only
    selected: bool  # whether it goes over chosen rows

    def text(self, name: str) -> str:
        """Return the loop as Python."""
        inputs = [f"a{i}" for i in range(len("".join(self.letters)))]
        outputs = [f"r{i}" for i in range(len(self.results))]
        return LOOP.format(
            name=name,
            parameters=", ".join([*inputs, *outputs, *["rows"] * self.selected]),
            index="i in rows" if self.selected else "i in range(r0.shape[0])",
            results="".join(f"{item}, " for item in self._places(outputs)),
            arguments=", ".join(self._groups(iter(inputs))),
        )

    def _groups(self, inputs: Iterator[str]) -> Iterator[str]:
        """Yield each argument of the formula, at row i."""
        for number, (group, letters) in enumerate(
            zip(self.groups, self.letters, strict=True)
        ):
            items = [
                _at_row(letter, item)
                for letter, item in zip(letters, inputs, strict=False)
            ]
            if letters == "t":
                table = items[0]
                fields = group._fields  # type: ignore[attr-defined]
                items = [f"{table}[i, {k}]" for k in range(len(fields))]
            yield f"g{number}({', '.join(items)})"

    def _places(self, outputs: Sequence[str]) -> Iterator[str]:
        """Yield where each number that the formula returns goes, at row i."""
        for output, (_, columns) in zip(outputs, self.results, strict=True):
            if columns:
                yield from (f"{output}[i, {k}]" for k in range(columns))
            else:
                yield f"{output}[i]"

    def signature(self, numba: ModuleType) -> Any:
        """Return the loop's types: read-only arrays in, contiguous ones out."""
        array = numba.types.Array
        types = {
            "t": array(numba.float64, 2, "C", readonly=True),
            "c": array(numba.float64, 1, "A", readonly=True),
            "s": numba.float64,
        }
        inputs = [types[letter] for letter in "".join(self.letters)]
        outputs = [
            array(numba.from_dtype(np.dtype(char)), 2 if columns else 1, "C")
            for char, columns in self.results
        ]
        rows = [array(numba.intp, 1, "C")] * self.selected
        return numba.void(*inputs, *outputs, *rows)


def _at_row(letter: str, item: str) -> str:
    return f"{item}[i]" if letter == "c" else item


@cache
def _compiled_loop(formula: Formula, layout: _Layout) -> Callable[..., None]:
    """Return the compiled loop over rows.

    numba keeps what it compiles beside the formula's file, and names it by the loop's
    name: that holds a digest of the formula and of all that it calls, so that a change
    anywhere is compiled anew.
    """
    numba = compiler()
    assert numba is not None
    parts = registered(numba, formula)
    types = str(layout.results)
    name = digest_name(formula, [layout.text("loop"), types], [*parts, *layout.groups])
    scope = {f"g{i}": group for i, group in enumerate(layout.groups)}
    loop = loop_of_text(formula, name, layout.text(name), scope)
    compiled = numba.njit(layout.signature(numba), cache=True, error_model="numpy")
    out: Callable[..., None] = compiled(loop)
    return out


def registered(numba: ModuleType, formula: Formula) -> list[FunctionType]:
    """Return a formula and all that it calls, after numba was told to compile them."""
    parts = list(_called(formula))
    for part in parts:
        numba.extending.register_jitable(error_model="numpy")(part)
    return parts


def digest_name(
    formula: Formula, texts: Sequence[str], parts: Sequence[Callable[..., Any]]
) -> str:
    """Return the name of a loop: the formula's and a digest of all that goes into it."""
    sources = "".join([*texts, *map(inspect.getsource, parts)])
    digest = hashlib.sha256(sources.encode()).hexdigest()
    return f"{formula.__name__}_{digest[:16]}"


def loop_of_text(
    formula: Formula, name: str, text: str, scope: Mapping[str, Any]
) -> Callable[..., None]:
    """Return a loop over ``formula`` from its text, as if it stood in the formula's
    file: that is where numba looks for what it has compiled before.
    """
    names = {**scope, "formula": formula, "__name__": formula.__module__}
    exec(compile(text, inspect.getfile(formula), "exec"), names)
    loop: Callable[..., None] = names[name]
    return loop


def _called(formula: Callable[..., Any]) -> Iterator[FunctionType]:
    """Yield a formula and the functions of this package that it calls."""
    seen: set[FunctionType] = set()
    waiting: list[Any] = [formula]
    while waiting:
        function = waiting.pop()
        if function in seen:
            continue
        seen.add(function)
        yield function
        for name in function.__code__.co_names:
            value = function.__globals__.get(name)
            if isinstance(value, FunctionType) and value is not where:
                waiting.append(value)


def table(kind: type[Columns], array: Array, shape: tuple[int, ...]) -> Table:
    """Return an array (..., k) as a table of the leading ``shape``, flattened."""
    k = array.shape[-1]
    rows = np.broadcast_to(array, (*shape, k)).reshape(-1, k)
    return Table(kind, np.ascontiguousarray(rows))


def column(array: Array, shape: tuple[int, ...]) -> Column:
    """Return an array as a column of the leading ``shape``, flattened; a single number
    as it is.
    """
    if array.ndim == 0:
        return array
    return np.broadcast_to(array, shape).reshape(-1)


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
    flat = [np.empty((n, size) if size else n) for size in sizes]
    run(formula, arguments, flat)
    return [
        array.reshape((*shape, size) if size else shape)
        for array, size in zip(flat, sizes, strict=True)
    ]


NamedColumns = TypeVar("NamedColumns", bound=Columns)


def columns_of(figures: NamedColumns, shape: tuple[int, ...]) -> NamedColumns:
    """Return figures as columns of the leading ``shape``; single numbers as they are."""
    return type(figures)(*(column(figure, shape) for figure in figures))


def leading_shape(figures: Columns) -> tuple[int, ...]:
    """Return the leading shape of figures."""
    return np.broadcast_shapes(*(np.shape(figure) for figure in figures))
