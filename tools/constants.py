"""How many tuned constants the library holds.

    python tools/constants.py [--list] [FOLDER]

A tuned constant is an upper-case name of a module or a class whose value holds a number;
names whose value follows from other names alone do not count. ``--list`` prints them.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

TRIVIAL = (0, 1, 2, -1, 0.5)
"""Numbers that tune nothing: of formulas, signs and halves."""


class Constant(NamedTuple):
    """One tuned constant."""

    place: str  # file and line
    name: str
    numbers: tuple[float, ...]


def constants(folder: Path) -> Iterator[Constant]:
    """Yield the tuned constants of all modules below ``folder``."""
    for path in sorted(folder.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        bodies = [tree.body]
        bodies += [n.body for n in ast.walk(tree) if isinstance(n, ast.ClassDef)]
        for node in (statement for body in bodies for statement in body):
            for name, value in _assigned(node):
                numbers = tuple(_numbers(value))
                if name.isupper() and set(numbers) - set(TRIVIAL):
                    place = f"{path.relative_to(folder)}:{node.lineno}"
                    yield Constant(place, name, numbers)


def _assigned(node: ast.stmt) -> Iterator[tuple[str, ast.expr]]:
    if isinstance(node, ast.AnnAssign) and node.value is not None:
        if isinstance(node.target, ast.Name):
            yield node.target.id, node.value
    elif isinstance(node, ast.Assign):
        for target in node.targets:
            if isinstance(target, ast.Name):
                yield target.id, node.value


def _numbers(value: ast.expr) -> Iterator[float]:
    for node in ast.walk(value):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield node.value


def main() -> None:
    """Print the count of a folder."""
    arguments = [word for word in sys.argv[1:] if not word.startswith("-")]
    found = list(constants(Path(arguments[0] if arguments else "src")))
    if "--list" in sys.argv:
        for constant in found:
            numbers = ", ".join(f"{number:g}" for number in constant.numbers)
            print(f"{constant.place:55s} {constant.name:28s} {numbers}")
    total = sum(len(constant.numbers) for constant in found)
    print(f"{len(found)} constants hold {total} numbers")


if __name__ == "__main__":
    main()
