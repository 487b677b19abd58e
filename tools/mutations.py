"""Small faults that a test should notice, one per operator, and where they fit.

Left out are texts (strings, what is inside an f-string, the arguments of an exception),
annotations, decorators, and ``strict`` of ``zip``: no behaviour depends on them.
"""

from __future__ import annotations

import ast
import copy
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

Node = TypeVar("Node", bound=ast.AST)

BOUNDARY = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
OPPOSITE = {
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
ARITHMETIC = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
NEIGHBOURS = {
    "min": "max",
    "minimum": "maximum",
    "argmin": "argmax",
    "sin": "cos",
    "any": "all",
    "floor": "ceil",
    "fx": "fy",
    "vx": "vy",
    "x": "y",
    "left": "right",
}
NEIGHBOURS |= {second: first for first, second in NEIGHBOURS.items()}
NEGATIONS = ("opposite", "not")  # operators that negate a condition by themselves
DROPPED = ("abs", "fabs", "sqrt", "radians")  # functions whose argument stands for them


@dataclass(frozen=True)
class Mutation:
    """One fault at one place."""

    file: str  # below the sources
    line: int
    column: int
    function: str  # the function or class around it; empty: the module
    operator: str
    fault: str  # before and after
    number: int = 0  # among the same faults of the same function
    node: int = 0  # among all nodes of the module
    variant: int = 0  # among all faults of the node

    @property
    def package(self) -> str:
        """The package of the file."""
        return Path(self.file).parts[1]

    @property
    def key(self) -> tuple[str, ...]:
        """What stays the same if lines move."""
        return (self.file, self.function, self.fault, str(self.number))

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}"
        number = f" (number {self.number})" if self.number else ""
        return f"{place} {self.function or 'module'}: {self.fault}{number}"


def mutations(sources: Path, package: str) -> Iterator[Mutation]:
    """Yield all mutations of a package, in a fixed order."""
    for path in sorted((sources / "pushpressslide" / package).rglob("*.py")):
        file = path.relative_to(sources).as_posix()
        seen: Counter[tuple[str, ...]] = Counter()
        tree = ast.parse(path.read_text("utf-8"))
        for index, (node, function) in enumerate(behaviour(tree)):
            for variant, (operator, other) in enumerate(faults(node)):
                text = f"{_words(node)} -> {_words(other)}"
                at = (node.lineno, node.col_offset)
                found = Mutation(file, *at, function, operator, text)
                found = replace(
                    found, number=seen[found.key], node=index, variant=variant
                )
                seen[replace(found, number=0).key] += 1
                yield found


def mutate(sources: Path, mutation: Mutation) -> ast.Module:
    """Return the module's tree with a mutation."""
    tree = ast.parse((sources / mutation.file).read_text("utf-8"))
    node, _ = list(behaviour(tree))[mutation.node]
    _, other = list(faults(node))[mutation.variant]
    ast.copy_location(other, node)
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if value is node:
                setattr(parent, name, other)
            elif isinstance(value, list) and any(entry is node for entry in value):
                value[:] = [other if entry is node else entry for entry in value]
    return ast.fix_missing_locations(tree)


def behaviour(
    tree: ast.AST, function: str = ""
) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Yield the nodes that may be mutated, and the function or class around each."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or _is_text(node):
                continue
            inner = function
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                inner = f"{function}.{node.name}".lstrip(".")
            if isinstance(node, ast.expr | ast.stmt):
                yield node, inner
            yield from behaviour(node, inner)


def _is_text(node: ast.AST) -> bool:
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    if isinstance(node, ast.keyword):
        return node.arg == "strict"
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True
    return isinstance(node, ast.JoinedStr | ast.Raise | ast.Import | ast.ImportFrom)


def faults(node: ast.expr | ast.stmt) -> Iterator[tuple[str, ast.expr | ast.stmt]]:
    """Yield the operators that fit a node, each with what takes the node's place."""
    match node:
        case ast.Compare(ops=[operation]):
            if type(operation) in BOUNDARY:
                yield "boundary", _with(node, "ops", [BOUNDARY[type(operation)]()])
            elif type(operation) in OPPOSITE:
                yield "opposite", _with(node, "ops", [OPPOSITE[type(operation)]()])
        case ast.BinOp(op=operation) if type(operation) in ARITHMETIC:
            yield "arithmetic", _with(node, "op", ARITHMETIC[type(operation)]())
        case ast.AugAssign(op=operation) if type(operation) in ARITHMETIC:
            yield "arithmetic", _with(node, "op", ARITHMETIC[type(operation)]())
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield "sign", operand
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "not", operand
        case ast.BoolOp(op=ast.And()):
            yield "and, or", _with(node, "op", ast.Or())
        case ast.BoolOp(op=ast.Or()):
            yield "and, or", _with(node, "op", ast.And())
        case ast.Constant(value=bool(value)):
            yield "boolean", ast.Constant(not value)
        case ast.Constant(value=int(value) | float(value)):
            yield "number", ast.Constant(value + 1)
        case ast.Attribute(attr=name) if name in NEIGHBOURS:
            yield "neighbour", _with(node, "attr", NEIGHBOURS[name])
        case ast.Call(func=function, args=[argument, *_]):
            yield from _call(node, function, argument)
        case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test):
            if not any(operator in NEGATIONS for operator, _ in faults(test)):
                yield "condition", _with(node, "test", ast.UnaryOp(ast.Not(), test))
        case ast.Return(value=ast.Tuple(elts=[first, second, *others])):
            swapped = ast.Tuple([second, first, *others], ast.Load())
            yield "order", _with(node, "value", swapped)
        case ast.Expr(value=ast.Call()):
            yield "call left out", ast.Pass()
        case ast.Continue():
            yield "loop", ast.Break()
        case ast.Break():
            yield "loop", ast.Continue()


def _call(
    node: ast.Call, function: ast.expr, argument: ast.expr
) -> Iterator[tuple[str, ast.expr]]:
    name = ast.unparse(function).rpartition(".")[2]
    if name in DROPPED:
        yield "function left out", argument
    if isinstance(function, ast.Name) and name in NEIGHBOURS:
        other = ast.Name(NEIGHBOURS[name], ast.Load())
        yield "neighbour", _with(node, "func", other)


def _words(node: ast.AST) -> str:
    if isinstance(node, ast.If | ast.While):
        return f"if {ast.unparse(node.test)}"
    return ast.unparse(node)


def _with(node: Node, name: str, value: object) -> Node:
    other = copy.copy(node)
    setattr(other, name, value)
    return other
