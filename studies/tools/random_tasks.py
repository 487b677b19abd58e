"""Draw the tables of studies/docs/random-tasks.md, and write the page from their rows.

    python studies/tools/random_tasks.py run [--jobs N] [TABLE ...]
    python studies/tools/random_tasks.py write

``run`` goes on where it ended: the rows of a table, in studies/docs/data/TABLE.jsonl,
count as long as the package's sources are those that made them. One table is complete
before the next begins. sources.json beside them says which commit has those sources,
and how they solve contacts in Drake. ``write`` renews the page and the README between
their marks; it runs nothing.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import pushpressslide
from pushpressslide.jobs import sampling
from pushpressslide.jobs.summary import interval, share, summarise
from pushpressslide_studies.paper.documents import renewed

DATA = Path("studies/docs/data")
PAGE = Path("studies/docs/random-tasks.md")
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


@dataclass(frozen=True)
class Sources:
    """The sources of the package that made the rows of a table."""

    key: str  # of the rows
    commit: str
    date: str  # of the commit
    contact: str  # how Drake solves contacts in them
    # samples of a table whose rows were not kept; 0 where they are
    attempted: int = 0
    reached: int = 0


MODES = (
    ("rear_push", "rear-push-rear", 60),
    ("press_slide", "press-slide", 60),
    ("parallel_push", "parallel-push", 40),
    ("orthogonal_push", "orthogonal-push", 40),
    ("bimanual_press_slide", "bimanual-slide", 40),
)
KNOWN_SEEDS = (2400, 2401, 1972, 1973, 1974, 1975, 1976)
KNOWN = tuple(
    Table(name, what, task, seed, attempts, sets, refusals=REFUSALS)
    for seed, (name, what, task, attempts, sets) in zip(
        KNOWN_SEEDS,
        (
            *((mode, f"`{mode}`", task, count, ALONE) for mode, task, count in MODES),
            ("open-one-arm", "no mode given, one arm", "press-slide", 40, OPEN),
            ("open-two-arms", "no mode given, two arms", "bimanual-slide", 40, OPEN),
        ),
        strict=True,
    )
)
# as many samples as are likely to have so many refused ones
REFUSED = tuple(
    replace(
        table,
        name=f"{table.name}-refused",
        seed=1960 + i,
        attempts=0,
        samples=samples,
    )
    for i, (table, samples) in enumerate(
        zip(KNOWN, (15, 18, 7, 12, 10, 22, 32), strict=True)
    )
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
    """Run what is missing of a table, and publish its rows with their sources."""
    from pushpressslide import load_task
    from pushpressslide.jobs.sweep import SweepOptions, sweep

    commit, date = commit_of_sources()
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
            key = publish(rows, table.rows)
            note(table, Sources(key, commit, date, contact_solver()))


def publish(rows: Path, published: Path) -> str:
    """Write the rows of the last sweep in ``rows`` to ``published``: those of earlier
    sources stand behind no table any more. The key of the rows.
    """
    lines = rows.read_text().splitlines(keepends=True)
    key = str(json.loads(lines[-1])["key"])
    published.write_text(
        "".join(line for line in lines if json.loads(line)["key"] == key)
    )
    return key


def commit_of_sources() -> tuple[str, str]:
    """The commit that changed the package last, and its date."""
    folder = Path(pushpressslide.__file__).parent

    def git(*words: str) -> str:
        call = ["git", "-C", str(folder), *words, "--", "."]
        return subprocess.run(call, check=True, capture_output=True, text=True).stdout

    if git("status", "--porcelain"):
        raise SystemExit(f"{folder}: not committed; rows have to name their sources")
    commit, date = git("log", "-1", "--abbrev=7", "--format=%h %cs").split()
    return commit, date


@cache
def contact_solver() -> str:
    """How the sources at hand solve contacts in Drake, by Drake's name for it."""
    from pydrake.multibody.plant import MultibodyPlant

    from pushpressslide.sim.contact import solve_contacts

    plant = MultibodyPlant(time_step=0.001)
    solve_contacts(plant)
    return str(plant.get_discrete_contact_approximation().name)


def all_sources() -> dict[str, Sources]:
    """Sources by the names of tables."""
    path = DATA / "sources.json"
    if not path.exists():
        return {}
    facts = json.loads(path.read_text(encoding="utf-8"))
    return {name: Sources(**fact) for name, fact in facts.items()}


def note(table: Table, made: Sources) -> None:
    """Write down which sources made the rows of a table, unless these rows have a note."""
    known = all_sources()
    if table.name in known and known[table.name].key == made.key:
        return
    known[table.name] = made
    facts = {name: asdict(one) for name, one in sorted(known.items())}
    text = json.dumps(facts, indent=1)
    (DATA / "sources.json").write_text(text + "\n", encoding="utf-8")


def sources_of(table: Table) -> Sources | None:
    """The sources that made the published rows of a table, if noted."""
    made = all_sources().get(table.name)
    rows, _ = read(table)
    if made is None or not rows or rows[-1]["key"] != made.key:
        return None
    return made


def is_older(made: Sources) -> bool:
    """Whether sources solve contacts in another way than those at hand."""
    return made.contact != contact_solver()


def named(made: Sources | None) -> str:
    """Sources in words."""
    if made is None:
        return "unknown"
    older = ", older contact solver" if is_older(made) else ""
    return f"{made.commit} of {made.date}{older}"


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
    """Return the lines of a table of tables; those that were not begun say so."""
    out = [
        "| tasks for | seed | drawn | attempted | reached | of the attempted | at the "
        "first attempt | median error | worst error | refusals run anyway that missed "
        "| sources |",
        "|" + 11 * "---|",
    ]
    for table in tables:
        counted, forced = read(table)
        if not counted:
            out.append(not_drawn(table, 11))
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
            named(sources_of(table)),
        )
        out.append("| " + " | ".join(map(str, cells)) + " |")
    return out


def lines_of_all(tables: Iterable[Table]) -> list[str]:
    """Return the lines of a table of tables that count all tasks drawn; those that were
    not begun say so.
    """
    out = [
        "| tasks for | seed | drawn | reached | of all drawn | refused | missed | failed "
        "| with 1, 2, 3 and more motions | recoveries | planning time, median and 95th "
        "percentile | median error | overlap of 0.95 | sources |",
        "|" + 14 * "---|",
    ]
    for table in tables:
        counted, _ = read(table)
        if not counted:
            out.append(not_drawn(table, 14))
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
            named(sources_of(table)),
        )
        out.append("| " + " | ".join(map(str, cells)) + " |")
    return out


def not_drawn(table: Table, columns: int) -> str:
    """The line of a table that was not begun, or whose rows were not kept."""
    begin = f"| {table.what} | {table.seed} |"
    made = all_sources().get(table.name)
    if made is None or not made.attempted:
        return f"{begin} not drawn yet |" + (columns - 3) * " |"
    found = f" {made.reached} of {made.attempted} attempted; rows not kept |"
    return begin + found + (columns - 4) * " |" + f" {named(made)} |"


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
    """Counts of the chosen modes, of tasks that allow any."""
    counts: Counter[str] = Counter()
    for table in KNOWN:
        if table.sets == OPEN:
            counts.update(
                m for row in read(table)[0] for m in set(row.get("modes", ()))
            )
    if not counts:
        return []
    chosen = ", ".join(f"`{mode}` {n}" for mode, n in counts.most_common())
    return [f"Where no mode was given, chosen were: {chosen}."]


def section(title: str, lines: Sequence[str]) -> list[str]:
    """Return a section with a table."""
    return [f"### {title}", "", *lines, ""]


def on_older_sources() -> list[str]:
    """What tables by sources with another contact solver say of today's; no line where
    there are none.
    """
    made = [one for table in TABLES if (one := sources_of(table)) is not None]
    older = sorted({f"`{one.contact}`" for one in made if is_older(one)})
    if not older:
        return []
    marked = sum(map(is_older, made))
    return [
        f"**{marked} of {len(made)} tables are by an older contact solver.** Their column "
        f'"sources" says so: in those commits Drake solves contacts by {", ".join(older)}, '
        f"in today's by `{contact_solver()}`. They do not say how often today's sources "
        "reach.",
        "",
    ]


def page() -> list[str]:
    """The lines of the page between its marks."""
    keys = sorted({str(row["key"]) for t in TABLES for row in read(t)[0][-1:]})
    return [
        *on_older_sources(),
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
        f"The rows are in [data](data); keys of the sweeps: {', '.join(keys)}.",
    ]


def write() -> None:
    """Renew the page and the README."""
    renew(PAGE, "rates", page())
    renew(README, "fact", [fact()])


def renew(page: Path, mark: str, lines: Sequence[str]) -> None:
    """Write lines between the marks of a page."""
    old = page.read_text(encoding="utf-8")
    page.write_text(renewed(old, mark, "\n".join(lines)), encoding="utf-8")


def fact() -> str:
    """The README's first fact: what came of tasks of which no mode was given."""
    tables = [table for table in KNOWN if table.sets == OPEN]
    summary = summarise([row for table in tables for row in read(table)[0]], ())
    position = 1e3 * summary["final_position_error"]["median"]
    yaw = math.degrees(summary["final_yaw_error"]["median"])
    tried = summary["attempted"]
    low, high = (100.0 * share for share in summary["reached_interval"])
    return (
        f"- **It arrives.** Of {summary['drawn']} random tasks with no mode given, {tried} "
        f"were attempted; {summary['refused']} were refused before anything moved. "
        f"{summary['reached']} of the {tried} ended within 10 mm and 2° in Drake (95 % "
        f"interval {low:.0f} to {high:.0f} %), half of them within {position:.1f} mm and "
        f"{yaw:.1f}°{by_older(tables)}. The objects: {drawn_objects()} "
        "([random tasks](studies/docs/random-tasks.md))."
    )


def drawn_objects() -> str:
    """The ranges of the objects that are drawn where no mode is given."""
    (low, high), (low_two, high_two) = (sampling.ANY_SIZE[arms] for arms in (1, 2))
    masses = [mass for bounds in sampling.ANY_MASS.values() for mass in bounds]
    friction = " to ".join(map(str, sampling.SUPPORT_FRICTION))
    return (
        f"boxes, prisms and cylinders of {100 * low:.0f} to {100 * high:.0f} cm (for two "
        f"arms {100 * low_two:.0f} cm to {high_two:.0f} m) and {min(masses)} to "
        f"{max(masses):.0f} kg, on supports of friction {friction}"
    )


def by_older(tables: Iterable[Table]) -> str:
    """Words for tables of which one is by sources with another contact solver."""
    made = map(sources_of, tables)
    older = any(one is not None and is_older(one) for one in made)
    return " (run with an older contact solver)" if older else ""


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
