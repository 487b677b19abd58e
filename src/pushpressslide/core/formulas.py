"""What formulas are made of: functions of numbers without branches, that NumPy runs on
whole columns and a compiled loop on one row after the other.

``where`` chooses between two values that are both worked out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numpy as np

Column = Any
"""In NumPy an array (n,), one number a row, or of no dimension, the same number in
every row; in a compiled loop the number of one row.
"""
Flag = Any
"""A column of truth values."""
Columns = tuple[Column, ...]
Formula = Callable[..., Columns]


COMPILED: dict[FunctionType, FunctionType] = {}
"""Functions that a compiled loop does in another way, and how."""


Function = TypeVar("Function", bound=Callable[..., Any])


def compiled_as(other: Callable[..., Any]) -> Callable[[Function], Function]:
    """Return a decorator: a compiled loop calls ``other`` in the function's place."""

    def marked(function: Function) -> Function:
        COMPILED[cast(FunctionType, function)] = cast(FunctionType, other)
        return function

    return marked


def chosen(condition: Flag, a: Column, b: Column) -> Column:
    """Return ``where`` of one row."""
    return a if condition else b


@compiled_as(chosen)
def where(condition: Flag, a: Column | float, b: Column | float) -> Column:
    """Return ``a`` where the condition holds, ``b`` elsewhere."""
    return np.where(condition, a, b)


def least(a: Column | float, b: Column | float) -> Column:
    """Return the lesser of two numbers; ``b`` where one is not a number."""
    return where(a < b, a, b)


def greater(a: Column | float, b: Column | float) -> Column:
    """Return the greater of two numbers; ``b`` where one is not a number."""
    return where(a > b, a, b)


_FLOATS = ModuleType("floats")  # Python finds a module's names quickest
vars(_FLOATS).update(
    sqrt=math.sqrt,
    arctanh=math.atanh,
    abs=abs,
    copysign=math.copysign,
    nan=math.nan,
)


@cache
def plain(function: Function) -> Function:
    """Return a formula for plain floats, many times as fast on them as NumPy.

    It is the same code, with ``math`` in the place of NumPy and what a compiled loop
    does in the place of ``compiled_as`` functions.
    """
    part = cast(FunctionType, function)
    body = COMPILED.get(part, part)
    scope = dict(body.__globals__)
    for name in body.__code__.co_names:
        value = scope.get(name)
        if value is np:
            scope[name] = _FLOATS
        elif isinstance(value, FunctionType):
            scope[name] = plain(value)
    return cast(Function, FunctionType(body.__code__, scope, body.__name__))
