"""Every experiment of the paper, through the same pipeline as any task; one page, paper beside measured."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.whole_file import write_whole
from pushpressslide.experiments.paper import Experiment, Variant, chosen
from pushpressslide.experiments.reproduce_page import Outcome, Outcomes, write_page, write_table
from pushpressslide.experiments.run import Engine, run_task, versions
from pushpressslide.pipeline.task_file import load_task

SCHEMA = 1
JOBS = 2
KEPT = (
    "success", "reason", "motion_duration", "duration", "rms_position_error", "rms_end_effector_error",
    "rms_yaw_error", "final_position_error", "final_yaw_error", "path_rms_error", "slip_distance",
    "contact_loss_time",
)  # fmt: skip

Progress = Callable[[float, float], None]


def reproduce(
    only: list[str] | None = None,
    *,
    seed: int = 0,
    out: Path,
    engine: Engine = "drake",
    jobs: int = JOBS,
    progress: Progress | None = None,
) -> Path:
    """Run the paper's experiments and return the path of the page; ``only`` names some of them.

    Each variant leaves the files of a run in ``out``/<experiment>/<variant>; beside the page are table.md and
    result.json. A variant that misses its goal, or cannot be run at all, is reported like any other. Raises
    PushPressSlideError for a name that is not an experiment.
    """
    experiments = chosen(only)
    todo = [(experiment, variant) for experiment in experiments for variant in experiment.variants]
    outcomes: Outcomes = {}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(todo)), mp_context=context) as pool:
        waiting = {}
        for experiment, variant in todo:
            folder = out / experiment.name / variant.name
            work = pool.submit(run_variant, variant, folder, seed, engine)
            waiting[work] = (experiment.name, variant.name)
        try:
            for work in as_completed(waiting):
                outcomes[waiting[work]] = work.result()
                if progress is not None:
                    progress(len(outcomes), len(todo))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    page = write_page(experiments, outcomes, out)
    write_table(experiments, outcomes, out / "table.md")
    summary = {
        "schema": SCHEMA,
        "engine": engine,
        "seed": seed,
        "experiments": {experiment.name: _summary(experiment, outcomes) for experiment in experiments},
        "versions": versions(),
    }
    write_whole(out / "result.json", json.dumps(summary, indent=2) + "\n")
    return page


def run_variant(variant: Variant, folder: Path, seed: int, engine: Engine) -> Outcome:
    """Run one variant and leave its files in ``folder``; what cannot be run comes back as words."""
    try:
        task = load_task(variant.task, variant.overrides)
        return Outcome(folder, run_task(task, engine=engine, seed=seed, out=folder))
    except PushPressSlideError as error:
        return Outcome(folder, None, str(error))


def _summary(experiment: Experiment, outcomes: Outcomes) -> Mapping[str, Any]:
    """What result.json holds of one experiment."""
    rows = []
    for variant in experiment.variants:
        outcome = outcomes[experiment.name, variant.name]
        measured = outcome.result
        rows.append(
            {
                "variant": variant.name,
                "task": variant.task,
                "overrides": list(variant.overrides),
                "paper": {key: figure.value for key, figure in variant.paper.items()},
                "measured": None if measured is None else {key: measured[key] for key in KEPT},
                "failure": outcome.failure or None,
            }
        )
    return {"title": experiment.title, "source": experiment.source, "variants": rows}
