"""All experiments of the paper, run like any task, with one page that compares the
paper with measurements.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.record import Record
from pushpressslide.core.whole_file import write_whole
from pushpressslide.jobs.engines import DEFAULT, engine_named
from pushpressslide.jobs.parallel import Progress, in_parallel
from pushpressslide.jobs.run import Output, run_task
from pushpressslide.report.files import load_run
from pushpressslide.report.metrics import installed_versions
from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper.claims import claims
from pushpressslide_studies.paper.corrections import corrections
from pushpressslide_studies.paper.evidence import Evidence, Outcome
from pushpressslide_studies.paper.experiment import Experiment, Variant
from pushpressslide_studies.paper.experiments import AXLE, chosen
from pushpressslide_studies.paper.identified_rho import identified_rho
from pushpressslide_studies.paper.one_arm import IDENTIFIED_RHO
from pushpressslide_studies.paper.page import write_page
from pushpressslide_studies.paper.pictures import write_pictures
from pushpressslide_studies.paper.table import write_table
from pushpressslide_studies.paper.virtual_axle import LIGHT, TASK, result_of, work_of

SCHEMA = 3
JOBS = 2
KEPT = (
    "success",
    "reason",
    "motion_duration",
    "duration",
    "rms_position_error",
    "rms_end_effector_error",
    "rms_yaw_error",
    "final_position_error",
    "final_yaw_error",
    "path_rms_error",
    "slip_distance",
    "contact_loss_time",
)


def reproduce(
    only: list[str] | None = None,
    *,
    seed: int = 0,
    out: Path,
    engine: str = DEFAULT,
    jobs: int = JOBS,
    progress: Progress | None = None,
) -> Path:
    """Run the paper's experiments, or those in ``only``, and return the path of the
    page.

    Up to ``jobs`` runs are executed at a time. Each variant leaves the files of its run
    in ``out``/<experiment>/<variant>, and the analysis of the axle (Drake only) leaves
    its files in ``out``/virtual-axle. table.md and result.json are next to the page. A
    variant that misses its goal, or cannot be run at all, is reported like any other.
    Raises PushPressSlideError for a name that is not an experiment.
    """
    experiments, with_axle = chosen(only)
    has_arms = engine_named(engine).has_arms
    cases = LIGHT if with_axle and has_arms else ()
    runs: dict[Any, Callable[[], Any]] = {
        (e.name, v.name): partial(
            run_variant, e, v, out / e.name / v.name, seed, engine
        )
        for e in experiments
        for v in e.variants
    }
    task = load_task(TASK)
    done = in_parallel({**runs, **work_of(task, cases)}, jobs, progress)
    axle = result_of(task, [done[case] for case in cases]) if cases else None
    evidence = Evidence({key: done[key] for key in runs}, axle)
    if axle is not None:
        write_whole(out / AXLE / "result.json", json.dumps(axle, indent=1) + "\n")
    return _write(experiments, evidence, out, engine, seed)


def _write(
    experiments: Sequence[Experiment],
    evidence: Evidence,
    out: Path,
    engine: str,
    seed: int,
) -> Path:
    """Evaluate the claims, write page, table.md and result.json, and return the page's
    path.
    """
    # of an older run: a folder that has one is complete
    (out / "result.json").unlink(missing_ok=True)
    axle = evidence.axle
    judged = claims(experiments, evidence)
    corrected = corrections()
    made_by = installed_versions()
    found = (f"{name} {version}" for name, version in made_by.items() if version)
    programs = ", ".join(found)
    footer = f"Engine {engine}, seed {seed}; {programs}."
    page = write_page(experiments, evidence, judged, corrected, out, footer)
    write_table(experiments, evidence, judged, out / "table.md")
    summary = {
        "schema": SCHEMA,
        "engine": engine,
        "seed": seed,
        "experiments": {e.name: _summary(e, evidence) for e in experiments},
        "claims": [asdict(claim) for claim in judged],
        "corrections": [asdict(row) for row in corrected],
        AXLE: None if axle is None else axle["summary"],
        "versions": made_by,
    }
    write_whole(out / "result.json", json.dumps(summary, indent=2) + "\n")
    return page


def run_variant(
    experiment: Experiment, variant: Variant, folder: Path, seed: int, engine: str
) -> Outcome:
    """Run one variant and leave its files in ``folder``, with pictures if requested.

    If a variant cannot be run, its outcome contains the text of the error.
    """
    try:
        task = load_task(variant.task, variant.settings)
        result = run_task(
            task,
            engine=engine,
            seed=seed,
            out=Output(folder),
            execution=variant.execution,
        )
    except PushPressSlideError as error:
        return Outcome(folder, None, str(error))
    if engine_named(engine).has_arms and variant.name in experiment.pictured:
        write_pictures(folder)
    run = load_run(folder)
    rho = None
    if experiment.name == IDENTIFIED_RHO.name:
        rho = identified_rho(run.plan, run.record)
    return Outcome(folder, result, rho=rho, digest=_digest(run.record))


def _digest(record: Record) -> str:
    """Hash of the object's motion in a run."""
    poses = np.ascontiguousarray(record.arrays["object_pose"])
    return hashlib.sha256(poses.tobytes()).hexdigest()


def _summary(experiment: Experiment, evidence: Evidence) -> Mapping[str, Any]:
    """Contents of result.json for one experiment."""
    rows = []
    for variant in experiment.variants:
        outcome = evidence.outcomes[experiment.name, variant.name]
        measured = outcome.result
        if measured is not None:
            measured = {key: measured[key] for key in KEPT}
        rows.append(
            {
                "variant": variant.name,
                "task": variant.task,
                "overrides": list(variant.settings),
                "execution": variant.execution.changed,
                "paper": {key: figure.value for key, figure in variant.paper.items()},
                "measured": measured,
                "failure": outcome.failure or None,
                "identified_rho": None if outcome.rho is None else asdict(outcome.rho),
            }
        )
    return {"title": experiment.title, "source": experiment.source, "variants": rows}
