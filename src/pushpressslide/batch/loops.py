"""Formulas compiled by numba, the extra ``fast``: it is imported at the first use, and
what it compiles is kept on disk.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from pushpressslide.batch.formulas import COMPILED, Columns, Formula

_by_numpy: ContextVar[bool] = ContextVar("by_numpy", default=False)


@contextmanager
def by_numpy() -> Iterator[None]:
    """Run formulas by NumPy inside, whether numba is installed or not."""
    token = _by_numpy.set(True)
    try:
        yield
    finally:
        _by_numpy.reset(token)


def compiler() -> ModuleType | None:
    """Return numba; None where it is not installed or not wanted."""
    return None if _by_numpy.get() else installed()


@cache
def installed() -> ModuleType | None:
    """Return numba; None where it is not installed."""
    try:
        importlib.import_module("numba.extending")
    except ImportError:
        return None
    return importlib.import_module("numba")


def loaded() -> bool:
    """Return whether numba has been imported, and is wanted."""
    return "numba" in sys.modules and compiler() is not None


LANES = 64  # rows that a loop takes at a time
# The arithmetic stands in a loop of its own, of fixed length and on memory of its own:
# so the compiler may work on several rows at once.
LOOP = """
def {name}({parameters}):
    x = np.zeros(({inputs}, {lanes}))
    y = np.zeros(({outputs}, {lanes}))
    n = {count}
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
            i = np.uint64({row})
            {target} = {source}"""


@dataclass(frozen=True, slots=True)
class Layout:
    """What a loop goes over."""

    groups: tuple[type[Columns], ...]  # NamedTuples that the formula is given
    letters: tuple[str, ...]  # of each group
    results: tuple[tuple[str, int], ...]  # NumPy's letter, and the columns; 0: one only
    selected: bool  # whether it goes over chosen rows

    def text(self, name: str) -> str:
        """Return the loop as Python."""
        parameters = [f"a{i}" for i in range(len("".join(self.letters)))]
        parameters += [f"r{i}" for i in range(len(self.results))]
        parameters += ["rows"] * self.selected
        sources, arguments = self._inputs()
        places = self._places()
        lanes = [f"y[{k}, j]" for k in range(len(places))]
        return LOOP.format(
            name=name,
            parameters=", ".join(parameters),
            inputs=max(len(sources), 1),
            outputs=len(places),
            lanes=LANES,
            count="rows.shape[0]" if self.selected else "r0.shape[-1]",
            loads=self._moves([f"x[{k}, j]" for k in range(len(sources))], sources),
            results="".join(f"{lane}, " for lane in lanes),
            arguments=", ".join(arguments),
            stores=self._moves(places, lanes),
        )

    def _moves(self, targets: Sequence[str], sources: Sequence[str]) -> str:
        """Return loops that move a column each."""
        row = "rows[start + j]" if self.selected else "start + j"
        return "".join(
            MOVE.format(row=row, target=target, source=source)
            for target, source in zip(targets, sources, strict=True)
        ).strip()

    def _inputs(self) -> tuple[list[str], list[str]]:
        """Return where the lanes come from for row i, and the formula's arguments."""
        sources: list[str] = []
        arguments = []
        number = 0
        for place, letters in enumerate(self.letters):
            items = []
            for k in range(len(self.groups[place]._fields)):  # type: ignore[attr-defined]
                letter = "t" if letters == "t" else letters[k]
                item = f"a{number}" + {"t": f"[i, {k}]", "c": "[i]", "s": ""}[letter]
                if letter != "s":
                    sources.append(item)
                    item = f"x[{len(sources) - 1}, j]"
                items.append(item)
                number += letter != "t"
            number += letters == "t"
            arguments.append(f"g{place}({', '.join(items)})")
        return sources, arguments

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


@cache
def compiled_loop(formula: Formula, layout: Layout) -> Callable[..., None]:
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
    file: that is where numba looks for what it has compiled before.
    """
    names = {
        **scope,
        "formula": formula,
        "np": np,
        "__name__": formula.__module__,
    }
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
        body = COMPILED.get(function, function)
        if body is not function:
            waiting.append(body)
        names = (body.__globals__.get(name) for name in body.__code__.co_names)
        waiting += [value for value in names if isinstance(value, FunctionType)]
