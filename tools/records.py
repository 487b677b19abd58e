"""Store what the sources do to many tasks, and tell later where others do otherwise.

    python tools/records.py store [--part PART]
    python tools/records.py compare [--part PART]

The parts, in tools/records/PART.json: plans and refusals of random tasks (``plans``),
shipped tasks on the planar engine (``planar``) and some of them in Drake (``drake``),
random runs on the planar engine (``random``). A run is kept as its end and as digests
of its arrays, a plan as its segments in plain numbers: equal to the last bit or not. A
run that is no longer equal shows by how much its object's path differs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import pushpressslide as pps
from pushpressslide.jobs.sampling import random_task

FOLDER = Path("tools/records")
SEED = 510  # of the random tasks
PLANS = 200  # of five shipped tasks in turn
RUNS = 40
BASES = (
    "rear-push-rear",
    "press-slide",
    "parallel-push",
    "orthogonal-push",
    "bimanual-slide",
)
# one of each mode, and two of several motions
IN_DRAKE = (
    *BASES,
    "pivot",
    "tool-use",
    "slot",
    "hand-over",
)
ARRAYS = ("time", "object_pose", "tip_position", "command_force", "progress")
EVERY = 50  # ticks between the poses that are kept

Facts = dict[str, Any]


def shipped() -> list[str]:
    """Names of all tasks of the package."""
    return sorted(path.stem for path in Path("src/pushpressslide/tasks").glob("*.yaml"))


def drawn(index: int) -> pps.Task:
    """One of the random tasks."""
    base = pps.load_task(BASES[index % len(BASES)], ("modes=null",))
    return random_task(base, index, SEED, "any")


def plan_facts(plan: pps.Plan) -> list[Facts]:
    """The segments of a plan in plain numbers."""
    return [
        {
            "mode": segment.mode,
            "points": [list(contact.point) for contact in segment.contacts],
            "loads": [contact.load for contact in segment.contacts],
            "pieces": [str(piece) for piece in segment.path.sections],
            "length": segment.path.length,
            "goal": [segment.goal.x, segment.goal.y, segment.goal.yaw],
        }
        for segment in plan.segments
    ]


def planned(task: pps.Task) -> Facts:
    """The plan of a task, or why there is none."""
    try:
        return {"segments": plan_facts(pps.plan(task))}
    except pps.PushPressSlideError as error:
        return {"refused": str(error)}


def run_facts(task: pps.Task, engine: str) -> Facts:
    """How a run ends, digests of its arrays, and its object's poses now and then."""
    try:
        record = pps.run(task, engine=engine)
    except pps.PushPressSlideError as error:
        return {"refused": str(error)}
    arrays = {name: record.arrays[name] for name in ARRAYS if name in record.arrays}
    return {
        "reason": record.reason,
        "text": record.reason_text,
        "digests": {name: digest(values) for name, values in arrays.items()},
        "poses": np.round(arrays["object_pose"][::EVERY], 7).tolist(),
    }


def digest(values: np.ndarray) -> str:
    """Some letters that differ for arrays which differ in a bit."""
    return hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()[:16]


def runs(names: list[str], engine: str) -> Iterator[tuple[str, Facts]]:
    """Shipped tasks on an engine."""
    for name in names:
        yield name, run_facts(pps.load_task(name), engine)


def random_runs() -> Iterator[tuple[str, Facts]]:
    """Random tasks on the planar engine."""
    for index in range(RUNS):
        yield f"random-{index:03d}", run_facts(drawn(index), "planar")


def plans() -> Iterator[tuple[str, Facts]]:
    """Plans of random tasks, and of all shipped ones."""
    for index in range(PLANS):
        yield f"random-{index:03d}", planned(drawn(index))


PARTS: Mapping[str, Callable[[], Iterator[tuple[str, Facts]]]] = {
    "plans": plans,
    "planar": lambda: runs(shipped(), "planar"),
    "drake": lambda: runs(list(IN_DRAKE), "drake"),
    "random": random_runs,
}


def difference(old: Facts, new: Facts) -> str:
    """What is otherwise, in a line; empty where nothing is."""
    if old == new:
        return ""
    if "poses" not in old or "poses" not in new:
        keys = [key for key in {**old, **new} if old.get(key) != new.get(key)]
        return "; ".join(f"{key}: {old.get(key)} -> {new.get(key)}" for key in keys)
    ticks = min(len(old["poses"]), len(new["poses"]))
    apart = np.abs(np.subtract(old["poses"][:ticks], new["poses"][:ticks]))
    x, y, yaw = apart.max(axis=0)
    return (
        f"{old['text']} -> {new['text']}; up to {1e3 * max(x, y):.4f} mm and "
        f"{np.degrees(yaw):.4f} deg apart"
    )


def store(part: str) -> None:
    """Write the facts of a part."""
    FOLDER.mkdir(exist_ok=True)
    lines = []
    for name, facts in PARTS[part]():
        print(part, name, facts.get("reason", facts.get("refused", "planned")))
        lines.append(f"{json.dumps(name)}: {json.dumps(facts)}")
    (FOLDER / f"{part}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n")


def compare(part: str) -> int:
    """Print what is otherwise than stored; return of how many."""
    stored = json.loads((FOLDER / f"{part}.json").read_text())
    otherwise = 0
    for name, facts in PARTS[part]():
        said = difference(stored[name], json.loads(json.dumps(facts)))
        otherwise += bool(said)
        print(part, name, said or "equal", flush=True)
    print(f"{part}: {otherwise} of {len(stored)} are otherwise")
    return otherwise


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("command", choices=("store", "compare"))
    parser.add_argument("--part", choices=tuple(PARTS), action="append")
    asked = parser.parse_args()
    parts = asked.part or list(PARTS)
    if asked.command == "store":
        for part in parts:
            store(part)
        return
    if sum(compare(part) for part in parts):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
