"""Figures of many runs and plans, to compare the library before and after a rebuild.

    python rebuild/snapshot.py plans OUT            judged choices of random tasks, no engine
    python rebuild/snapshot.py planar|drake OUT     runs of shipped and random tasks
    python rebuild/snapshot.py compare BEFORE AFTER

Every finished row is a line of OUT/<part>.jsonl; a second call goes on where the first one ended.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
import time
from pathlib import Path
from typing import Any

HOMES = {
    "sample_task": ("jobs.sweep", "experiments.sweep"),
    "simulate": ("jobs.run", "experiments.run"),
    "versions": ("jobs.run", "experiments.run"),
    "select": ("selection.select", "pipeline.selection"),
    "load_task": ("taskfile.reader", "taskfile.task_file", "pipeline.task_file"),
    "result": ("report.metrics",),
    "InfeasibleTaskError": ("core.errors",),
}
SEED = 5
DRAWN = ("rear-push-rear", "press-slide", "orthogonal-push", "parallel-push", "bimanual-slide")
VARIED = "pivot-and-move"
COUNTS = {"plans": 60, "planar": 60, "drake": 10}
TIMES = ("realtime_factor", "tick_us", "versions", "wall_time", "planning_time")


def home(name: str) -> Any:
    """Return a public name from wherever this version of the package keeps it."""
    for module in HOMES[name]:
        try:
            return getattr(importlib.import_module(f"pushpressslide.{module}"), name)
        except (ImportError, AttributeError):
            continue
    return getattr(importlib.import_module("pushpressslide"), name)


def shipped() -> list[str]:
    """Return the names of the tasks that the first version ships."""
    return [
        "bimanual-slide", "orthogonal-push", "parallel-push", "pivot-and-move", "press-fit", "press-slide-car",
        "press-slide-forklift", "press-slide-pivot", "press-slide", "rear-push-left", "rear-push-rear",
        "tool-use",
    ]  # fmt: skip


def cases(part: str) -> list[tuple[str, Any]]:
    """Return the named tasks of a part, shipped ones first, all modes interleaved."""
    load_task, sample_task = home("load_task"), home("sample_task")
    out = [(name, load_task(name)) for name in shipped()]
    for i in range(COUNTS[part]):
        for name in DRAWN:
            out.append((f"{name}#{i}", sample_task(load_task(name), "tasks", i, SEED)))
        if i < 10:
            out.append((f"{VARIED}~{i}", sample_task(load_task(VARIED), "truth", i, SEED)))
    return out


def plans_row(task: Any) -> dict[str, Any]:
    """Return what selection says of a task."""
    choices = home("select")(task)
    return {
        "choices": [
            [
                c.mode, bool(c.feasible), str(c.reason), c.path_length, c.time, c.friction_margin,
                [[k.arm, k.kind, *k.point, *k.normal, k.height, k.load] for k in c.contacts],
            ]
            for c in choices
        ]
    }  # fmt: skip


def run_row(task: Any, engine: str) -> dict[str, Any]:
    """Return the result of a run, times of the machine left out."""
    try:
        plan, record, _ = home("simulate")(task, engine=engine, seed=SEED)
    except home("InfeasibleTaskError") as error:
        return {"refused": str(error)}
    measured = home("result")(task, plan, record, home("versions")())
    return {"result": {k: v for k, v in measured.items() if k not in TIMES}}


def make(part: str, out: Path) -> None:
    """Append the rows that are missing."""
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"{part}.jsonl"
    done = {json.loads(line)["case"] for line in path.read_text().splitlines()} if path.exists() else set()
    with path.open("a") as file:
        for name, task in cases(part):
            if name in done:
                continue
            began = time.perf_counter()
            try:
                row = plans_row(task) if part == "plans" else run_row(task, part)
            except Exception as error:  # a crash is a row, so that the rest is still compared
                row = {"error": f"{type(error).__name__}: {error}"}
            row = {"case": name, "seconds": round(time.perf_counter() - began, 2), **row}
            file.write(json.dumps(row) + "\n")
            file.flush()


def differences(a: Any, b: Any, where: str = "") -> list[tuple[str, Any, Any]]:
    """Return every leaf that differs."""
    if isinstance(a, dict) and isinstance(b, dict):
        out = []
        for key in sorted({*a, *b}):
            if key not in a:
                continue  # a new figure
            out += differences(a[key], b.get(key, "absent"), f"{where}.{key}")
        return out
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return [d for i, (x, y) in enumerate(zip(a, b, strict=True)) for d in differences(x, y, f"{where}[{i}]")]
    if isinstance(a, float) and isinstance(b, float) and math.isnan(a) and math.isnan(b):
        return []
    return [] if a == b else [(where, a, b)]


def size(a: Any, b: Any) -> float:
    """Return how much two leaves differ."""
    numbers = isinstance(a, int | float) and isinstance(b, int | float)
    return abs(a - b) if numbers else math.inf


def compare(before: Path, after: Path) -> None:
    """Print, per part, how many rows are the same to the bit, and what differs in the others."""
    for part in COUNTS:
        files = [folder / f"{part}.jsonl" for folder in (before, after)]
        if not all(file.exists() for file in files):
            continue
        old, new = ({r["case"]: r for r in map(json.loads, f.read_text().splitlines())} for f in files)
        common = [name for name in old if name in new]
        same, took = 0, [0.0, 0.0]
        lines = []
        for name in common:
            a, b = old[name], new[name]
            took[0] += a.pop("seconds")
            took[1] += b.pop("seconds")
            found = differences(a, b)
            same += not found
            if found:
                found.sort(key=lambda d: -size(d[1], d[2]))
                where, x, y = found[0]
                lines.append(f"  {name}: {len(found)} leaves, most {where}: {x!r} -> {y!r}")
        print(f"{part}: {same} of {len(common)} equal; {took[0]:.0f} s -> {took[1]:.0f} s")
        print("\n".join(line[:400] for line in lines))


if __name__ == "__main__":
    if sys.argv[1] == "compare":
        compare(Path(sys.argv[2]), Path(sys.argv[3]))
    else:
        make(sys.argv[1], Path(sys.argv[2]))
