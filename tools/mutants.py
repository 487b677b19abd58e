"""Mutation testing: does a small fault in the physics, or in the control, turn a test
red?

    python tools/mutants.py [--only physics|control] [--seed N] [--samples N]
                            [--out FILE] [--processes N]

A mutant is one module with one small fault. The faults are listed in ``mutations.py``.
Packages stand in groups, and a seeded sample of all mutants of each group is drawn. Each
mutant is run against the short tests of its own package, without a random choice of
examples. Nothing is written to the sources: the mutated module is put in by an import
hook in a forked process.

Results go to a file with one row per mutant. A row counts as long as neither the package
nor its tests have changed, so that an interrupted command goes on where it was. Mutants
that no test can tell from the original stand in ``equivalent_mutants.toml``, with the
reason. The exit status is 1 if in a group too few of the others are killed, or too many
are named equivalent.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.machinery
import importlib.util
import json
import multiprocessing as mp
import os
import random
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from multiprocessing.connection import Connection, wait
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import hypothesis
import numpy as np  # noqa: F401  (imported once, before all forks)
import pytest
import scipy.optimize  # noqa: F401
from mutations import Mutation, mutate, mutations

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "src"
STUDIES = ROOT / "studies"
TESTS = (ROOT / "tests", STUDIES / "tests")  # with a folder for each package
EQUIVALENT = ROOT / "tools" / "equivalent_mutants.toml"
LEAST_KILLED = 0.9  # share of the mutants that are not equivalent
MOST_EQUIVALENT = 0.1  # share of the sample


@dataclass(frozen=True)
class Group:
    """Packages whose mutants one sample is drawn from."""

    packages: tuple[str, ...]
    samples: int
    slower: float  # a mutant that takes this many times the tests' own time is killed


GROUPS = {
    "physics": Group(("mechanics", "allocation", "rom", "tracking"), 300, 10.0),
    "control": Group(("control", "execution"), 120, 5.0),
}


@dataclass(frozen=True)
class Row:
    """What became of one mutant."""

    seed: int
    sources: str  # hash of the package and its tests
    mutant: dict[str, Any]
    outcome: str  # survived, killed, timeout
    test: str  # the first one that failed
    seconds: float


class MutatedModule(importlib.machinery.SourceFileLoader):
    """Import hook that gives one module mutated code."""

    def __init__(self, mutation: Mutation) -> None:
        self.module = ".".join(Path(mutation.file).with_suffix("").parts)
        super().__init__(self.module, str(SOURCES / mutation.file))
        self.tree = mutate(SOURCES, mutation)

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the spec of the mutated module, None for any other."""
        if fullname != self.module:
            return None
        return importlib.util.spec_from_file_location(fullname, self.path, loader=self)

    def get_code(self, fullname: str) -> CodeType:
        """Return the mutated code."""
        return compile(self.tree, self.path, "exec")


class FirstFailure:
    """pytest plugin that keeps the name of the first test that fails."""

    def __init__(self) -> None:
        self.test = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Take one report."""
        if report.failed and not self.test:
            self.test = report.nodeid


def run_tests(package: str, mutation: Mutation | None, answer: Connection) -> None:
    """Send exit status and first failing test of a package's short tests.

    In a process of its own.
    """
    sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    sys.path[:0] = [str(SOURCES), str(STUDIES / "src")]
    if mutation is not None:
        sys.meta_path.insert(0, MutatedModule(mutation))
    failure = FirstFailure()
    options = ["-m", "not long", "-x", "-q", "-p", "no:cacheprovider"]
    options += ["--hypothesis-profile", "mutants", "--capture", "no"]
    status = 0
    for files in ordered_tests(package, mutation):
        status = int(pytest.main([*options, *map(str, files)], plugins=[failure]))
        if status not in (0, 5):  # 5: all of these tests are long
            break
    answer.send((status, failure.test))


def ordered_tests(package: str, mutation: Mutation | None) -> list[list[Path]]:
    """Return the test files of a package: first that of the mutated module, then those
    that name it, then the others.

    Each part is collected only if the one before finds nothing.
    """
    parts: list[list[Path]] = [[], [], []]
    found = (sorted((folder / package).glob("test_*.py")) for folder in TESTS)
    for path in chain.from_iterable(found):
        place = 2
        if mutation is not None and path.stem == f"test_{Path(mutation.file).stem}":
            place = 0
        elif mutation is not None and f"{package}.{Path(mutation.file).stem} " in (
            path.read_text("utf-8")
        ):
            place = 1
        parts[place].append(path)
    return [part for part in parts if part]


@dataclass
class Job:
    """One forked process that runs tests."""

    package: str
    mutation: Mutation | None
    limit: float  # [s]

    def start(self) -> None:
        """Fork."""
        self.began = time.monotonic()
        self.answer, far = mp.Pipe(duplex=False)
        arguments = (self.package, self.mutation, far)
        self.process = mp.get_context("fork").Process(target=run_tests, args=arguments)
        self.process.start()
        far.close()

    def outcome(self) -> tuple[str, str, float] | None:
        """Return outcome, failing test and seconds; None while it runs.

        Raises RuntimeError if pytest could not run the tests at all.
        """
        seconds = time.monotonic() - self.began
        if self.process.is_alive() and seconds < self.limit:
            return None
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
            return "timeout", "", seconds
        try:
            status, test = self.answer.recv()
        except EOFError:
            self.process.join()
            if self.process.exitcode == 1:  # an exception outside of the tests
                raise RuntimeError(f"the tests did not run: {self.mutation}") from None
            return "killed", "the process ended", seconds
        if status not in (0, 1, 2, 5):
            raise RuntimeError(f"pytest ended with status {status}: {self.mutation}")
        return ("survived" if status in (0, 5) else "killed"), test, seconds


def own_time(package: str) -> float:
    """Return the seconds that a package's tests take without a mutation.

    Raises RuntimeError if they fail.
    """
    job = Job(package, None, 3600.0)
    job.start()
    job.process.join()
    found = job.outcome()
    if found is None or found[0] != "survived":
        raise RuntimeError(f"the tests of {package} fail without a mutation: {found}")
    return found[2]


def hashes(packages: Sequence[str]) -> dict[str, str]:
    """Return one hash of sources and tests per package."""
    found = {}
    for package in packages:
        digest = hashlib.sha256()
        for folder in (SOURCES / "pushpressslide", *TESTS):
            for path in sorted((folder / package).rglob("*.py")):
                digest.update(path.read_bytes())
        found[package] = digest.hexdigest()[:16]
    return found


def known_rows(path: Path, seed: int, sources: dict[str, str]) -> dict[str, Row]:
    """Return the rows of a file that still count, by mutant."""
    rows = {}
    for line in path.read_text("utf-8").splitlines() if path.exists() else []:
        row = Row(**json.loads(line))
        mutation = Mutation(**row.mutant)
        if row.seed == seed and row.sources == sources[mutation.package]:
            rows[str(mutation)] = row
    return rows


def run_sample(
    group: Group, sample: list[Mutation], arguments: argparse.Namespace
) -> dict[str, Row]:
    """Run what has no row yet; return all rows by mutant."""
    sources = hashes(group.packages)
    rows = known_rows(arguments.out, arguments.seed, sources)
    pending = [mutation for mutation in sample if str(mutation) not in rows]
    packages = sorted({mutation.package for mutation in pending})
    limits = {package: group.slower * own_time(package) for package in packages}
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    running: list[Job] = []
    while pending or running:
        while pending and len(running) < arguments.processes:
            mutation = pending.pop(0)
            job = Job(mutation.package, mutation, limits[mutation.package])
            job.start()
            running.append(job)
        wait([job.process.sentinel for job in running], timeout=1.0)
        for job in list(running):
            ended = job.outcome()
            if ended is None or job.mutation is None:
                continue
            running.remove(job)
            outcome, test, seconds = ended
            hashed = sources[job.package]
            mutant = asdict(job.mutation)
            row = Row(arguments.seed, hashed, mutant, outcome, test, round(seconds, 2))
            rows[str(job.mutation)] = row
            with arguments.out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(row)) + "\n")
            print(f"{outcome:8s} {seconds:5.1f} s  {job.mutation}", flush=True)
    return rows


def equivalent_mutants() -> dict[tuple[str, ...], str]:
    """Return the reasons by file, function, fault and number."""
    table = tomllib.loads(EQUIVALENT.read_text("utf-8"))
    return {
        (m["file"], m["function"], m["fault"], str(m.get("number", 0))): m["reason"]
        for m in table.get("mutant", [])
    }


def report(sample: list[Mutation], rows: dict[str, Row]) -> bool:
    """Print what survived and the shares; return whether they are as wanted."""
    reasons = equivalent_mutants()
    counts: Counter[str] = Counter()
    for mutation in sample:
        outcome = rows[str(mutation)].outcome
        if outcome == "survived" and mutation.key in reasons:
            outcome = "equivalent"
        elif outcome == "survived":
            print(f"survived: {mutation}")
        counts[outcome] += 1
    killed = counts["killed"] + counts["timeout"]
    others = len(sample) - counts["equivalent"]
    print(
        f"{len(sample)} mutants: {killed} killed ({counts['timeout']} by the time "
        f"limit), {counts['survived']} survived, {counts['equivalent']} equivalent; "
        f"{killed / others:.1%} of {others} killed"
    )
    enough = killed >= LEAST_KILLED * others
    few = counts["equivalent"] <= MOST_EQUIVALENT * len(sample)
    return enough and few


def passed(name: str, arguments: argparse.Namespace) -> bool:
    """Run and report the sample of a group; return whether its shares are as wanted."""
    group = GROUPS[name]
    candidates = [m for package in group.packages for m in mutations(SOURCES, package)]
    number = arguments.samples or group.samples
    print(f"{name}: {len(candidates)} mutants, of which {number} are drawn")
    sample = random.Random(arguments.seed).sample(candidates, number)
    return report(sample, run_sample(group, sample, arguments))


def main() -> None:
    """Run the samples and report them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--only", choices=sorted(GROUPS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, help="of each group, for another number")
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "mutants.jsonl")
    parser.add_argument("--processes", type=int, default=1)
    arguments = parser.parse_args()
    hypothesis.settings.register_profile(
        "mutants",
        deadline=None,
        derandomize=True,
        phases=[hypothesis.Phase.explicit, hypothesis.Phase.generate],
    )
    names = [arguments.only] if arguments.only else list(GROUPS)
    good = [passed(name, arguments) for name in names]
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
