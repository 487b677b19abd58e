"""Run every shipped task in every engine, and write studies/docs/engines.md.

    python studies/tools/engines.py

It takes some minutes. The rows are in studies/docs/data/engines.json, with the hash of
the sources that made them.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from pushpressslide.jobs.rows import source_hash
from pushpressslide.taskfile.load import load_task, shipped_tasks
from pushpressslide_studies.bench.engine_table import ENGINES, run_of, table
from pushpressslide_studies.paper.documents import renewed

DATA = Path("studies/docs/data/engines.json")
PAGE = Path("studies/docs/engines.md")


def main() -> None:
    """Run, and renew rows and page."""
    runs = []
    for engine in ENGINES:
        for name in shipped_tasks():
            runs.append(run_of(load_task(name), engine))
            print(engine, name, runs[-1].reached, flush=True)
    rows = {"source": source_hash(), "runs": [asdict(run) for run in runs]}
    DATA.write_text(json.dumps(rows, indent=1) + "\n", "utf-8")
    page = PAGE.read_text("utf-8")
    PAGE.write_text(renewed(page, "engines", table(runs)), "utf-8")


if __name__ == "__main__":
    main()
