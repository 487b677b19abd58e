"""Kernels compiled over rows by numba.

Only this module imports numba. It is imported at the first call of a batch.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any, cast

import numba
import numpy as np
from llvmlite.binding import set_option
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from pushpressslide import kernels
from pushpressslide.batch import fast
from pushpressslide.kernels.kernel import APART, COMPILED, KERNELS, SUMS, WIDE

TABLE = types.Array(numba.float64, 2, "A", readonly=True)
RESULTS = types.Array(numba.float64, 2, "C")

# freedoms of the compiler in a sum: another order, and fused products and sums
REORDERED = {"reassoc", "contract", "nsz", "arcp"}

LANES = 64  # rows that a loop takes at a time

Like = tuple[Any, ...]
Loop = Callable[..., None]


@intrinsic
def taken(typingctx: Any, row: Any, like: Any) -> Any:
    """Numbers of a row (k,) as a tuple, nested like ``like``."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        """Emit the loads."""
        cell = _cells(context, builder, signature.args[0], arguments[0])

        def built(kind: Any) -> Any:
            """Next number, or a tuple of the next numbers."""
            if isinstance(kind, types.BaseTuple):
                parts = [built(part) for part in kind.types]
                return context.make_tuple(builder, kind, parts)
            return builder.load(cell())

        return built(like)

    return like(row, like), code


@intrinsic
def stored(typingctx: Any, row: Any, values: Any) -> Any:
    """Write the numbers of a nested tuple into a row (k,), one after the other."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        """Emit the stores."""
        cell = _cells(context, builder, signature.args[0], arguments[0])

        def write(kind: Any, value: Any) -> None:
            """Write a number, or all of a tuple."""
            if isinstance(kind, types.BaseTuple):
                parts = cgutils.unpack_tuple(builder, value)
                for part, inner in zip(kind.types, parts, strict=True):
                    write(part, inner)
                return
            builder.store(context.cast(builder, value, kind, types.float64), cell())

        write(values, arguments[1])
        return context.get_dummy_value()

    return types.none(row, values), code


@intrinsic
def copied(typingctx: Any, target: Any, tables: Any, row: Any, likes: Any) -> Any:
    """Copy the numbers of one row of all ``tables``, table by table, into the row
    ``target``.

    Each table contributes as many numbers as its member of ``likes`` holds.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        """Emit loads and stores."""
        to = _cells(context, builder, signature.args[0], arguments[0])
        parts = cgutils.unpack_tuple(builder, arguments[1])
        for kind, table, like in zip(tables.types, parts, likes.types, strict=True):
            array = context.make_array(kind)(context, builder, table)
            along, across = cgutils.unpack_tuple(builder, array.strides)
            start = builder.mul(along, arguments[2])
            for place in range(_width(like)):
                offset = builder.add(start, builder.mul(across, across.type(place)))
                cell = cgutils.pointer_add(builder, array.data, offset)
                builder.store(builder.load(cell), to())
        return context.get_dummy_value()

    return types.none(target, tables, row, likes), code


def _width(kind: Any) -> int:
    """Number of values in a nested tuple, or in a value of its type."""
    parts = kind.types if isinstance(kind, types.BaseTuple) else kind
    return sum(map(_width, parts)) if isinstance(parts, tuple) else 1


def _cells(context: Any, builder: Any, kind: Any, row: Any) -> Callable[[], Any]:
    """Function that returns the address of a row's next number at each call."""
    array = context.make_array(kind)(context, builder, row)
    (stride,) = cgutils.unpack_tuple(builder, array.strides)
    place = 0

    def cell() -> Any:
        """Address of the next number."""
        nonlocal place
        offset = builder.mul(stride, stride.type(place))
        place += 1
        return cgutils.pointer_add(builder, array.data, offset)

    return cell


@cache
def loop_over(
    kernel: Callable[..., Any],
    heads: tuple[Like, ...],
    like: Like,
    kinds: tuple[tuple[str, int], ...] = (),
) -> Loop:
    """Loop of a kernel over the rows of tables.

    Each table is nested like its member of ``heads``; the parameters that all rows
    share are nested like ``like``. ``kinds`` gives the NumPy type letter and the number
    of axes of each array.

    numba caches compiled code beside this file, or in the user's cache, by the loop's
    name. The name holds a digest of all kernels, so that a change recompiles them.
    """
    for function in KERNELS:
        _register(function)
    loop = _loop(kernel, heads, like)
    loop.__qualname__ = f"{kernel.__name__}_{_digest()}"
    tables = types.UniTuple(TABLE, len(heads))
    arrays = types.Tuple([_array(letter, axes) for letter, axes in kinds])
    signature = numba.void(tables, TABLE, arrays, RESULTS)
    begun = perf_counter()
    with _vectors(4 if kernel in WIDE else 0):
        out = numba.njit(signature, cache=True, error_model="numpy")(loop)
    if not out.stats.cache_hits:
        fast.note_compiled(perf_counter() - begun)
    return cast(Loop, out)


@contextmanager
def _vectors(width: int) -> Iterator[None]:
    """Let LLVM process ``width`` rows at once in loops compiled inside the block.

    A width of 0 leaves the choice to LLVM, which then assumes that half of the code
    behind branches is skipped at no cost. numba has no setting for a single loop, so
    LLVM's global option is changed.
    """
    set_option("", f"-force-vector-width={width}")
    try:
        yield
    finally:
        set_option("", "-force-vector-width=0")


def _array(letter: str, axes: int) -> types.Array:
    """Type of a contiguous, read-only array."""
    return types.Array(numba.from_dtype(np.dtype(letter)), axes, "C", readonly=True)


@cache
def call_of(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel compiled for single calls with the argument types of its first call."""
    for function in KERNELS:
        _register(function)

    def call_kernel(*arguments: Any) -> Any:
        """Call the kernel."""
        return kernel(*arguments)

    call_kernel.__qualname__ = f"call_of_{kernel.__name__}_{_digest()}"
    out: Callable[..., Any] = numba.njit(cache=True, error_model="numpy")(call_kernel)
    return out


# A loop takes some rows at a time. Their numbers are first put side by side, in memory
# of its own, so that the compiler may work on several rows at once.


def _loop(kernel: Callable[..., Any], heads: tuple[Like, ...], like: Like) -> Loop:
    """Loop of a kernel. Results that depend only on the shared parameters are computed
    once.
    """
    head = sum(heads, ())
    width = _width(head)

    def loop(rows: Any, figures: Any, arrays: Any, out: Any) -> None:
        """Write the kernel's results for all rows."""
        given = taken(figures[0], like)
        x = np.zeros((width, LANES))
        y = np.zeros((len(out), LANES))
        for start in range(0, out.shape[1], LANES):
            size = min(LANES, out.shape[1] - start)
            for j in range(size):
                copied(x[:, j], rows, start + j, heads)
            for j in range(size):
                stored(y[:, j], kernel(*(taken(x[:, j], head) + given + arrays)))
            for k in range(len(out)):
                for j in range(size):
                    out[np.uint64(k), np.uint64(start + j)] = y[k, j]

    return loop


@cache
def _register(function: Callable[..., Any]) -> None:
    """Register a kernel with numba for compilation."""
    options: dict[str, Any] = {"error_model": "numpy"}
    if function not in APART:
        options["forceinline"] = True
    if function in SUMS:
        options["fastmath"] = REORDERED
    body = COMPILED.get(function, function)
    overload(function, jit_options=options, strict=False)(lambda *_, **__: body)


@cache
def _digest() -> str:
    """Digest of this file and of all kernels."""
    texts = hashlib.sha256(Path(__file__).read_bytes())
    for folder in sorted(kernels.__path__):
        for file in sorted(Path(folder).glob("*.py")):
            texts.update(file.read_bytes())
    return texts.hexdigest()[:16]
