"""Run the benchmarks of studies/docs/benchmarks.md, and write page and README.

    python studies/tools/benchmarks.py [run | write] [--only NAME ...]

``run`` writes studies/docs/data/bench.json and the plots, ``write`` the pages alone;
both by default. ``--only`` runs some again and keeps the figures of the others. Nothing
else should run meanwhile: all take some ten minutes.
"""

from __future__ import annotations

import argparse
import json
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide_studies.bench.bench import bench
from pushpressslide_studies.bench.pictures import ratios
from pushpressslide_studies.bench.scaling import figure
from pushpressslide_studies.cli.bench_table import HEADINGS
from pushpressslide_studies.paper.documents import renewed

NAMES = (
    "pushes",
    "presses",
    "tick",
    "mpc",
    "dubins",
    "planners",
    "engines",
    "batches",
    "runs",
    "memory",
    "truths",
    "start",
    "scaling",
)
DATA = Path("studies/docs/data/bench.json")
PAGE = Path("studies/docs/benchmarks.md")
README = Path("README.md")
FIGURES = Path("studies/docs/figures")


def run(names: Sequence[str]) -> None:
    """Run some benchmarks, and keep figures and plots."""
    out = Path("runs/benchmarks")
    out.mkdir(parents=True, exist_ok=True)
    result = bench(names, out=out)
    result["machine"] = f"{platform.machine()}, Python {platform.python_version()}"
    if set(names) != set(NAMES):
        before = json.loads(DATA.read_text(encoding="utf-8"))
        result = before | {"benchmarks": before["benchmarks"] | result["benchmarks"]}
    DATA.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    rows = result["benchmarks"]
    for made, name in ((ratios(rows), "ratios"), (figure(rows["scaling"]), "scaling")):
        if made is not None:
            write_whole(FIGURES / f"bench-{name}.png", style.png(made))


def write() -> None:
    """Renew the page."""
    result = json.loads(DATA.read_text(encoding="utf-8"))
    parts = []
    for name in NAMES:
        parts += [f"### `{name}`", "", *_table(result["benchmarks"][name]), ""]
    versions = ", ".join(f"{k} {v}" for k, v in result["versions"].items())
    parts += [
        "![Times over those of the first contestant](figures/bench-ratios.png)",
        "",
        "![Times over sizes](figures/bench-scaling.png)",
        "",
        f"Made by `python studies/tools/benchmarks.py` on {result['machine']}; {versions}.",
    ]
    _renew(PAGE, "bench", "\n".join(parts))
    _renew(README, "fast", _fact(result["benchmarks"]))


def _renew(page: Path, mark: str, text: str) -> None:
    """Write ``text`` between the marks of a page."""
    before = page.read_text(encoding="utf-8")
    page.write_text(renewed(before, mark, text), encoding="utf-8")


def _fact(benchmarks: Mapping[str, Sequence[Mapping[str, Any]]]) -> str:
    """Return the README's second fact: how long a tick takes, beside solvers."""
    pushes = {row["what"]: row for row in benchmarks["pushes"]}
    one = pushes["closed form"]["median_us"]
    solvers = (row for name, row in pushes.items() if not name.startswith("closed"))
    quickest = min(row["ratio"] for row in solvers)
    ours, _, hpipm = benchmarks["mpc"][:3]
    return (
        f"- **It is quick.** Allocating two contact forces inside their cones takes {one:.2g} µs; the "
        f"quickest solver takes {quickest:.1f} times as long. Tracking and allocation "
        f"together take {ours['median_us']:.2g} µs; one step of a model-predictive "
        f"controller takes {hpipm['ratio']:.0f} times as long "
        "([benchmarks](studies/docs/benchmarks.md))."
    )


def _table(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the lines of a table."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    keys = [key for key in keys if any(row.get(key) not in (None, "") for row in rows)]
    heads = [HEADINGS.get(key, key.replace("_", " ")) for key in keys]
    rule = [":---" if key in ("what", "task", "note") else "---:" for key in keys]
    out = [_line(heads), _line(rule)]
    return out + [_line([_text(row.get(key)) for key in keys]) for row in rows]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(value: object) -> str:
    if value is None:
        return "-"
    if not isinstance(value, float):
        return str(value)
    return format(value, ".3g") if abs(value) < 1e3 else format(value, ",.0f")


def main() -> None:
    """Do what is asked."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("action", nargs="?", choices=("run", "write"))
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES)
    asked = parser.parse_args()
    if asked.action != "write":
        run(asked.only)
    if asked.action != "run":
        write()


if __name__ == "__main__":
    main()
