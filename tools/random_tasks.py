"""Draw the tables of docs/random-tasks.md, and write the page from their rows.

    python tools/random_tasks.py run [--jobs N] [TABLE ...]
    python tools/random_tasks.py write

``run`` goes on where it ended: the rows of a table, in docs/data/TABLE.jsonl, count as
long as the package's sources are those that made them. One table is complete before the
next begins. ``write`` renews the page and the README between their marks; it runs nothing.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pushpressslide.jobs.summary import interval, share, summarise
from pushpressslide.studies.paper.documents import renewed

DATA = Path("docs/data")
PAGE = Path("docs/random-tasks.md")
README = Path("README.md")
WORK = Path("runs/random-tasks")
SAMPLE_TIME = 600.0  # [s] that one sample may take
TOLERANCE = ("tolerance.position=0.01", "tolerance.yaw_deg=2")
OPEN = ("modes=null",)
ALONE = ("limits.legs=1",)  # a mode is measured by what one motion of it does
REFUSALS = 5  # refused samples of each table whose best choices are run all the same


@dataclass(frozen=True)
class Table:
    """One sweep whose rows are published."""

    name: str
    what: str
    task: str
    seed: int
    attempts: int = 0
    sets: tuple[str, ...] = ()
    world: str = "known"
    samples: int = 0  # where no attempts are asked for
    vary: str = "tasks"
    draw: str = "any"
    refusals: int = 0  # refused samples that are checked

    @property
    def command(self) -> str:
        """The command that draws it."""
        words = [f"pps sweep {self.task} --vary {self.vary}"]
        if self.vary == "tasks":
            words.append(f"--draw {self.draw}")
        count = f"--attempts {self.attempts}"
        if self.samples:
            count = f"--samples {self.samples}"
        words.append(f"{count} --seed {self.seed} --sample-time {SAMPLE_TIME:g}")
        if self.world != "known":
            words.append(f"--world {self.world}")
        if self.refusals:
            words.append(f"--check-refusals {self.refusals}")
        words += [f"--set {one}" for one in (*TOLERANCE, *self.sets)]
        return " ".join(words)

    @property
    def rows(self) -> Path:
        """Where its rows are published."""
        return DATA / f"{self.name}.jsonl"


MODES = (
    ("rear_push", "rear-push-rear", 60),
    ("press_slide", "press-slide", 60),
    ("parallel_push", "parallel-push", 40),
    ("orthogonal_push", "orthogonal-push", 40),
    ("bimanual_press_slide", "bimanual-slide", 40),
)
KNOWN = tuple(
    Table(name, what, task, 1970 + i, attempts, sets, refusals=REFUSALS)
    for i, (name, what, task, attempts, sets) in enumerate(
        (
            *((mode, f"`{mode}`", task, count, ALONE) for mode, task, count in MODES),
            ("open-one-arm", "any mode, one arm", "press-slide", 40, OPEN),
            ("open-two-arms", "any mode, two arms", "bimanual-slide", 40, OPEN),
        )
    )
)
# as many samples as are likely to have so many refused ones
REFUSED = tuple(
    replace(
        table,
        name=f"{table.name}-refused",
        seed=table.seed - 10,
        attempts=0,
        samples=samples,
    )
    for table, samples in zip(KNOWN, (15, 18, 7, 12, 10, 22, 32), strict=True)
)
UNCERTAIN = tuple(
    Table(f"{mode}-uncertain", f"`{mode}`", task, 1980 + i, 20, ALONE, "uncertain")
    for i, (mode, task, _) in enumerate(MODES)
)
AMONG_OBSTACLES = (
    *(
        Table(
            name,
            what,
            task,
            seed,
            sets=(f"limits.normal_force={force}",),
            samples=40,
            draw="cluttered",
        )
        for name, what, task, seed, force in (
            ("cluttered-one-arm", "a Panda", "post", 2300, 60),
            ("cluttered-two-arms", "two iiwa7", "bimanual-slide", 2301, 100),
        )
    ),
    Table("push-t", "`push-t`, other starts", "push-t", 2000, samples=40, vary="start"),
)
KNOCKS = tuple(
    Table(f"knocks-{task}", f"`{task}`", task, 2000, samples=10, vary="knocks")
    for task in (*(task for _, task, _ in MODES), "pivot")
)
TABLES = KNOWN + REFUSED + UNCERTAIN + AMONG_OBSTACLES + KNOCKS


def run(table: Table, jobs: int) -> None:
    """Run what is missing of a table, and publish its rows."""
    from pushpressslide import load_task
    from pushpressslide.jobs.sweep import SweepOptions, sweep

    folder = WORK / table.name
    folder.mkdir(parents=True, exist_ok=True)
    rows = folder / "rows.jsonl"
    if not rows.exists() and table.rows.exists():
        rows.write_bytes(table.rows.read_bytes())
    options = SweepOptions(
        samples=table.samples,
        attempts=table.attempts,
        vary=table.vary,  # type: ignore[arg-type]
        draw=table.draw,  # type: ignore[arg-type]
        world=table.world,  # type: ignore[arg-type]
        seed=table.seed,
        check_refusals=table.refusals,
        sample_time=SAMPLE_TIME,
        jobs=jobs,
    )
    task = load_task(table.task, (*TOLERANCE, *table.sets))
    try:
        sweep(task, options, folder)
    finally:
        table.rows.parent.mkdir(parents=True, exist_ok=True)
        if rows.exists():
            publish(rows, table.rows)


def publish(rows: Path, published: Path) -> None:
    """Write the rows of the last sweep in ``rows`` to ``published``: those of earlier
    sources stand behind no table any more.
    """
    lines = rows.read_text().splitlines(keepends=True)
    key = json.loads(lines[-1])["key"]
    published.write_text(
        "".join(line for line in lines if json.loads(line)["key"] == key)
    )


def read(table: Table) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the published samples of a table in their order, up to the last that
    counts, and its forced runs; of the sweep that the last row belongs to.
    """
    if not table.rows.exists():
        return [], []
    lines = [json.loads(line) for line in table.rows.read_text().splitlines()]
    key = lines[-1]["key"]
    mine = [line for line in lines if line["key"] == key]
    if not any(f"-{table.seed}-" in line.get("task", "") for line in mine):
        return [], []  # rows of another seed
    samples = {line["index"]: line for line in mine if "rank" not in line}
    counted = []
    attempted = 0
    for i in range(len(samples)):
        if i not in samples or (table.attempts and attempted == table.attempts):
            break
        counted.append(samples[i])
        attempted += samples[i]["status"] != "refused"
    return counted, [line for line in mine if "rank" in line]


def percent(share: float | None, interval: Sequence[float] | None) -> str:
    """Return a share with its interval, in percent."""
    if share is None or interval is None:
        return "-"
    low, high = interval
    return f"{100 * share:.0f} % ({100 * low:.0f} to {100 * high:.0f})"


def errors(summary: dict[str, Any], which: str) -> str:
    """Return a spread of the final errors."""
    position = summary["final_position_error"]
    yaw = summary["final_yaw_error"]
    if position is None or yaw is None:
        return "-"
    return f"{1e3 * position[which]:.1f} mm, {math.degrees(yaw[which]):.1f}°"


def reached_by(row: dict[str, Any]) -> bool:
    """Return whether a sample reached its goal."""
    return bool(row["status"] == "reached")


def lines_of(tables: Iterable[Table]) -> list[str]:
    """Return the lines of a table of tables; those that were not begun are left out."""
    out = [
        "| tasks for | seed | drawn | attempted | reached | of the attempted | at the "
        "first attempt | median error | worst error | refusals run anyway that missed |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for table in tables:
        counted, forced = read(table)
        if not counted:
            continue
        summary = summarise(counted, forced)
        checked = summary["refusals"]
        refusals = "-"
        if checked["checked"]:
            refusals = (
                f"{checked['missed']} of {checked['ran']} that could be run; "
                f"{checked['could_not_be_run']} could not"
            )
        number = f"{summary['attempted']}"
        if table.attempts > summary["attempted"]:
            number += f" of {table.attempts} so far"
        reached = percent(summary["reached_share"], summary["reached_interval"])
        cells = (
            table.what,
            table.seed,
            summary["drawn"],
            f"{number}: {percent(summary['attempted_share'], summary['attempted_interval'])}",
            summary["reached"],
            reached,
            sum(row.get("recoveries") == 0 for row in counted if reached_by(row)),
            errors(summary, "median"),
            errors(summary, "max"),
            refusals,
        )
        out.append("| " + " | ".join(map(str, cells)) + " |")
    return out


def lines_of_all(tables: Iterable[Table]) -> list[str]:
    """Return the lines of a table of tables that count all tasks drawn; those that were
    not begun are left out.
    """
    out = [
        "| tasks for | seed | drawn | reached | of all drawn | refused | missed | failed "
        "| with 1, 2, 3 and more motions | recoveries | planning time, median and 95th "
        "percentile | median error | overlap of 0.95 |",
        "|" + 13 * "---|",
    ]
    for table in tables:
        counted, _ = read(table)
        if not counted:
            continue
        summary = summarise(counted, ())
        ran = [row for row in counted if row["status"] in ("reached", "missed")]
        motions = Counter(min(3, row["legs"]) for row in ran)
        number = f"{len(counted)}"
        if len(counted) < table.samples:
            number += f" of {table.samples} so far"
        overlap = sum((row["overlap"] or 0.0) >= 0.95 for row in ran)
        cells = (
            table.what,
            table.seed,
            number,
            summary["reached"],
            percent(
                share(summary["reached"], len(counted)),
                interval(summary["reached"], len(counted)),
            ),
            summary["refused"],
            summary["missed"],
            summary["failed"],
            ", ".join(str(motions[n]) for n in (1, 2, 3)),
            sum(row["recoveries"] for row in ran),
            spread_of([row["planning_time"] for row in ran]),
            errors(summary, "median"),
            percent(share(overlap, len(counted)), interval(overlap, len(counted))),
        )
        out.append("| " + " | ".join(map(str, cells)) + " |")
    return out


def spread_of(times: Sequence[float]) -> str:
    """Return median and 95th percentile of times [s]."""
    if not times:
        return "-"
    ordered = sorted(times)
    last = ordered[int(0.95 * (len(ordered) - 1))]
    return f"{ordered[len(ordered) // 2]:.1f} s, {last:.1f} s"


def missed(tables: Iterable[Table]) -> list[str]:
    """Return a line for each attempted task that did not reach, and why."""
    out = []
    for table in tables:
        for row in read(table)[0]:
            if row["status"] in ("missed", "failed"):
                reason = " ".join(str(row["reason"]).split())
                out.append(
                    f"- {table.what}, seed {table.seed}, sample {row['index']}: {reason}"
                )
    return out or ["None."]


def modes_chosen() -> list[str]:
    """Return how often each mode was chosen where any was allowed."""
    counts: Counter[str] = Counter()
    for table in KNOWN:
        if table.sets == OPEN:
            counts.update(
                m for row in read(table)[0] for m in set(row.get("modes", ()))
            )
    if not counts:
        return []
    chosen = ", ".join(f"`{mode}` {n}" for mode, n in counts.most_common())
    return [f"Where any mode was allowed, chosen were: {chosen}."]


def section(title: str, lines: Sequence[str]) -> list[str]:
    """Return a section with a table; where no table was begun, that none was."""
    begun = len(lines) > 2  # the head and the rule below it
    return [f"### {title}", "", *(lines if begun else ["Not drawn yet."]), ""]


def write() -> None:
    """Renew the page."""
    sources = sorted({str(row["key"]) for t in TABLES for row in read(t)[0][-1:]})
    text = [
        *section("What is believed is true", lines_of(KNOWN)),
        *modes_chosen(),
        "",
        *section("Refusals alone", lines_of(REFUSED)),
        *section("An uncertain world", lines_of(UNCERTAIN)),
        *section(
            "Among obstacles, from anywhere to anywhere", lines_of_all(AMONG_OBSTACLES)
        ),
        *section("With knocks", lines_of_all(KNOCKS)),
        "### What missed",
        "",
        *missed(TABLES),
        "",
        "### Commands",
        "",
        *(f"- `{table.command}`" for table in TABLES if read(table)[0]),
        "",
        f"The rows are in [docs/data](data); keys of the sweeps: {', '.join(sources)}.",
    ]
    renew(PAGE, "rates", text)
    renew(README, "rates", short())
    renew(README, "fact", [fact()])


def renew(page: Path, mark: str, lines: Sequence[str]) -> None:
    """Write lines between the marks of a page."""
    old = page.read_text(encoding="utf-8")
    page.write_text(renewed(old, mark, "\n".join(lines)), encoding="utf-8")


def fact() -> str:
    """Return the README's first fact: what came of tasks with any object and mode."""
    rows = [row for t in KNOWN if t.sets == OPEN for row in read(t)[0]]
    summary = summarise(rows, ())
    position = 1e3 * summary["final_position_error"]["median"]
    yaw = math.degrees(summary["final_yaw_error"]["median"])
    reached = summary["reached"]
    tried = summary["attempted"]
    low, high = (100.0 * share for share in summary["reached_interval"])
    return (
        f"- **It arrives.** {reached} of {tried} unseen tasks, with any object, friction "
        "and goal and no mode given, ended within 10 mm and 2° in Drake (95 % interval "
        f"{low:.0f} to {high:.0f} %), half of them within {position:.1f} mm and "
        f"{yaw:.1f}° ([random tasks](docs/random-tasks.md))."
    )


def short() -> list[str]:
    """Return the table of the README: what reached its goal, of how many."""
    groups = (
        ("one motion of a given mode, 10 mm and 2°", KNOWN[: len(MODES)]),
        ("no mode given, the same", KNOWN[len(MODES) :]),
        ("the same as the first, in an uncertain world", UNCERTAIN),
        ("from anywhere to anywhere among obstacles, refused ones counted too", ()),
        ("knocked aside on the way", KNOCKS),
    )
    out = ["| unseen tasks | reached their goal, of so many |", "|---|---|"]
    for what, tables in groups:
        counted = [(t.what, read(t)[0]) for t in tables or AMONG_OBSTACLES]
        cells = [
            f"{name.removeprefix('any mode, ')} {sum(map(reached_by, rows))} of {number}"
            for name, rows in counted
            if (number := len(rows) if not tables else ran(rows))
        ]
        if cells:
            out.append(f"| {what} | {', '.join(cells)} |")
    return out


def ran(rows: Sequence[dict[str, Any]]) -> int:
    """Return how many samples were not refused."""
    return sum(row["status"] != "refused" for row in rows)


def main() -> None:
    """Run or write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("run", "write"))
    parser.add_argument("tables", nargs="*", metavar="TABLE")
    parser.add_argument("--jobs", type=int, default=0)
    given = parser.parse_intermixed_args()
    if given.action == "write":
        write()
        return
    for table in TABLES:
        if not given.tables or table.name in given.tables:
            run(table, given.jobs)


if __name__ == "__main__":
    main()
