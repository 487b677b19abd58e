"""Run the benchmarks and print the tables of docs/allocation.md; its figure is written anew.

    python benchmarks/allocation.py [FOLDER]

FOLDER (default runs/bench-allocation) keeps the result as ``pps bench`` does.
"""

import shutil
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pushpressslide.experiments.bench import bench

DOCS = Path(__file__).parents[1] / "docs"
FIGURE = "orthogonal-pushes.png"


def table(rows: Iterable[Mapping[str, Any]]) -> str:
    """Return rows as a Markdown table, numbers to three figures."""
    rows = [{key: value for key, value in row.items() if value != ""} for row in rows]
    names = list(rows[0])
    lines = ["| " + " | ".join(names) + " |", "|---" * len(names) + "|"]
    lines += ["| " + " | ".join(shown(row.get(name)) for name in names) + " |" for row in rows]
    return "\n".join(lines)


def shown(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("runs/bench-allocation")
    result = bench(out=out)
    for name, rows in result["benchmarks"].items():
        print(f"\n{name}\n\n{table(rows)}")
    print("\n" + ", ".join(f"{name} {version}" for name, version in result["versions"].items()))
    shutil.copyfile(out / FIGURE, DOCS / "figures" / FIGURE)


if __name__ == "__main__":
    main()
