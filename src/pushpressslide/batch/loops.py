"""Formulas compiled by numba, the extra ``fast``: it is imported at the first use, and
what it compiles is kept on disk.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.batch.fast import compiler, installed, loaded, without_numba
from pushpressslide.core.formulas import COMPILED, Columns, Formula

__all__ = ["compiler", "installed", "loaded"]
by_numpy = without_numba

LANES = 64  # rows that a loop takes at a time
# The arithmetic stands in a loop of its own, of fixed length and on memory of its own:
# so the compiler may work on several rows at once.
LOOP = """
def {name}({parameters}):
    {numbers}
    x = np.zeros(({inputs}, {lanes}))
    y = np.zeros(({outputs}, {lanes}))
    n = r0.shape[-1]
    for start in range(0, n, {lanes}):
        size = min(n - start, {lanes})
        {loads}
        for j in range({lanes}):
            {results} = formula({arguments})
        {stores}
"""
# An index without a sign needs no look at whether it counts from the end.
MOVE = """
        for j in range(size):
            i = np.uint64(start + j)
            {moves}"""


class Layout(NamedTuple):
    """What a loop goes over."""

    groups: tuple[type[Columns], ...]  # NamedTuples that the formula is given
    # of each group: t a table, else for each field c a column in one piece, v one with
    # gaps, s a single number
    letters: tuple[str, ...]
    results: tuple[tuple[str, int], ...]  # NumPy's letter, and the columns; 0: one only

    def text(self, name: str) -> str:
        """Return the loop as Python."""
        arguments, loads = self._inputs()
        lanes = [f"y[{k}, j]" for k in range(self._lane(len(self.results)))]
        stores = [
            [f"{place} = {lane}"]
            for place, lane in zip(self._places(), lanes, strict=True)
        ]
        parameters = [name for name, _ in self._arrays()]
        parameters += [f"r{i}" for i in range(len(self.results))]
        return LOOP.format(
            name=name,
            parameters=", ".join(parameters),
            numbers="\n    ".join(self._numbers()),
            inputs=max(sum(map(len, loads)), 1),
            outputs=len(lanes),
            lanes=LANES,
            loads=_moves(loads),
            results="".join(f"{lane}, " for lane in lanes),
            arguments=arguments,
            stores=_moves(stores),
        )

    def _arrays(self) -> Iterator[tuple[str, str]]:
        """Yield name and letter of each array that the loop is given: a table, the
        columns, and the numbers of a group.
        """
        for group, letters in enumerate(self.letters):
            if letters == "t":
                yield f"t{group}", "t"
                continue
            for k, letter in enumerate(letters):
                if letter != "s":
                    yield f"c{group}_{k}", letter
            if "s" in letters:
                yield f"s{group}", "s"

    def _numbers(self) -> Iterator[str]:
        """Yield a line for each single number."""
        for group, letters in enumerate(self.letters):
            fields = [k for k, letter in enumerate(letters) if letter == "s"]
            for place, k in enumerate(fields):
                yield f"s{group}_{k} = s{group}[{place}]"

    def _inputs(self) -> tuple[str, list[list[str]]]:
        """Return the formula's arguments, and how their lanes are filled for row i: what
        goes together in a loop.
        """
        groups = []
        loads: list[list[str]] = []
        number = 0
        for group, letters in enumerate(self.letters):
            items = []
            together = []
            for k in range(len(self.groups[group]._fields)):  # type: ignore[attr-defined]
                if letters != "t" and letters[k] == "s":
                    items.append(f"s{group}_{k}")
                    continue
                source = f"t{group}[i, {k}]" if letters == "t" else f"c{group}_{k}[i]"
                together.append(f"x[{number}, j] = {source}")
                items.append(f"x[{number}, j]")
                number += 1
            groups.append(f"g{group}({', '.join(items)})")
            loads += [together] if letters == "t" else [[one] for one in together]
        return ", ".join(groups), loads

    def _lane(self, result: int) -> int:
        """Return the number of the first lane of a result."""
        return sum(columns or 1 for _, columns in self.results[:result])

    def _places(self) -> list[str]:
        """Return where each number that the formula returns goes for row i."""
        return [
            f"r{number}[{k}, i]" if columns else f"r{number}[i]"
            for number, (_, columns) in enumerate(self.results)
            for k in range(columns or 1)
        ]

    def signature(self, numba: ModuleType) -> Any:
        """Return the loop's types: read-only arrays in, contiguous ones out."""
        array = numba.types.Array
        types = {
            "t": array(numba.float64, 2, "C", readonly=True),
            "c": array(numba.float64, 1, "C", readonly=True),
            "v": array(numba.float64, 1, "A", readonly=True),
            "s": array(numba.float64, 1, "C", readonly=True),
        }
        inputs = [types[letter] for _, letter in self._arrays()]
        outputs = [
            array(numba.from_dtype(np.dtype(char)), 2 if columns else 1, "C")
            for char, columns in self.results
        ]
        return numba.void(*inputs, *outputs)


def _moves(groups: Sequence[Sequence[str]]) -> str:
    """Return a loop for each group of moves."""
    line = "\n" + 12 * " "
    return "".join(MOVE.format(moves=line.join(group)) for group in groups).strip()


@cache
def compiled_loop(formula: Formula, layout: Layout) -> Callable[..., None]:
    """Return the compiled loop of a formula over rows.

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
    with _interleaved(2):
        out: Callable[..., None] = compiled(loop)
    return out


@contextmanager
def _interleaved(vectors: int) -> Iterator[None]:
    """Let LLVM do so many vectors of rows side by side in loops that are compiled inside.

    A formula is a long chain of operations that wait for each other; meanwhile the
    processor does those of the next vector, if it finds them near enough. numba has no
    way to say so of one loop, hence an option of LLVM as a whole.
    """
    set_option = importlib.import_module("llvmlite.binding").set_option
    set_option("", f"-force-vector-interleave={vectors}")
    try:
        yield
    finally:
        set_option("", "-force-vector-interleave=0")  # as LLVM sees fit


def registered(numba: ModuleType, formula: Formula) -> list[FunctionType]:
    """Return a formula and all that it calls, after numba was told to compile them."""
    parts = list(_called(formula))
    for part in parts:
        _register(numba, part)
    return parts


@cache
def _register(numba: ModuleType, part: FunctionType) -> None:
    """Tell numba how to compile a function."""
    body = COMPILED.get(part, part)
    overload = numba.extending.overload
    overload(
        part, jit_options={"error_model": "numpy", "forceinline": True}, strict=False
    )(lambda *_: body)


def digest_name(
    formula: Formula, texts: Sequence[str], parts: Sequence[Callable[..., Any]]
) -> str:
    """Return the name of a loop: the formula's and a digest of all that goes into it,
    this file and the ``texts`` and ``parts`` of the loop.
    """
    here = Path(__file__).read_text(encoding="utf-8")
    sources = "".join([here, *texts, *map(inspect.getsource, parts)])
    digest = hashlib.sha256(sources.encode()).hexdigest()
    return f"{formula.__name__}_{digest[:16]}"


def loop_of_text(
    formula: Formula, name: str, text: str, scope: Mapping[str, Any]
) -> Callable[..., None]:
    """Return a loop over ``formula`` from its text, as if it stood in the formula's
    place: numba keeps what it compiles beside that file, and reads the lines there.
    """
    names = {
        **scope,
        "formula": formula,
        "np": np,
        "__name__": formula.__module__,
    }
    lines_before = "\n" * (formula.__code__.co_firstlineno - 1)
    exec(compile(lines_before + text, inspect.getfile(formula), "exec"), names)
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
        body = COMPILED.get(function, function)
        if body is not function:
            waiting.append(body)
        names = (body.__globals__.get(name) for name in body.__code__.co_names)
        waiting += [value for value in names if isinstance(value, FunctionType)]
