"""One task through the whole pipeline: select, plan, run on an engine, measure, write
everything that a user looks at.
"""

from __future__ import annotations

import importlib.metadata
import platform
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from itertools import chain, groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.record import Record
from pushpressslide.core.refusal import Refusal, literal
from pushpressslide.core.task import Task
from pushpressslide.jobs.interrupt import Interrupt, Interrupted
from pushpressslide.modes.base import ENOUGH
from pushpressslide.selection.planner import plan_of, refusal, usable
from pushpressslide.selection.select import placements, select

if TYPE_CHECKING:
    from pushpressslide.sim.joints.placements import GraspPaths

# choices of a mode that are judged in full where the first have no joint path
MORE = 3 * ENOUGH

Engine = Literal["drake", "planar"]
Progress = Callable[[float, float], None]
Told = Callable[[str], None]
Problems = dict[tuple[str, tuple[Contact, ...], str, str], InfeasibleTaskError]


def versions() -> dict[str, str]:
    """Return the versions that a result depends on."""
    out = {"python": platform.python_version()}
    for name in ("pushpressslide", "drake", "numpy"):
        try:
            out[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            out[name] = "unknown"
    return out


def simulate(
    task: Task,
    *,
    engine: Engine = "drake",
    seed: int = 0,
    force: bool = False,
    progress: Progress | None = None,
    models: str = "generated",
    choices: list[Choice] | None = None,
    interrupt: Interrupt | None = None,
    live: Told | None = None,
) -> tuple[Plan, Record, list[Choice]]:
    """Select, plan and run; the choices come back with the reasons why better-ranked
    ones were passed over.

    On Drake a choice must also have a joint path: the first that has one is run.
    ``force`` runs the best choice that has a path even where it was judged infeasible.
    ``interrupt``: Ctrl-C while the engine runs ends the run at its next tick, with
    reason "interrupted"; without it, Ctrl-C raises. ``live`` is told the address where
    the run can be watched (Drake only). Raises InfeasibleTaskError where nothing can do
    the task.
    """
    held, stop = (
        (interrupt.held, interrupt) if interrupt is not None else (nullcontext, bool)
    )
    # the others are for where there is no joint path
    enough = 1 if engine == "planar" else ENOUGH
    judged = list(select(task, enough) if choices is None else choices)
    by_grasp = [list(of) for _, of in groupby(judged, key=lambda choice: choice.leg)]
    candidates = [usable(task, of, force=force) for of in by_grasp]
    if engine == "planar":
        from pushpressslide.planar.engine import run as run_planar

        made = plan_of(task, [of[0] for of in candidates])
        with held():
            return (
                made,
                run_planar(made, seed=seed, progress=progress, stop=stop),
                judged,
            )
    from pushpressslide.sim.engine import run as run_drake
    from pushpressslide.sim.joints.placements import GraspPaths

    paths = GraspPaths(force)
    for number, of in enumerate(by_grasp):
        problems: Problems = {}
        done = _add_first(paths, task, of, problems)
        if not done and choices is None and not all(choice.evaluated for choice in of):
            of[:] = placements(task, MORE)[number]
            done = _add_first(paths, task, of, problems)
        if not done:
            if len(problems) == 1:
                raise next(iter(problems.values()))
            raise InfeasibleTaskError(
                refusal(task, list(chain.from_iterable(by_grasp)))
            )
    judged = list(chain.from_iterable(by_grasp))
    made = Plan(task, tuple(s for part in paths.plans for s in part.segments))
    with held():
        record = run_drake(
            made,
            seed=seed,
            progress=progress,
            models=models,
            paths=paths.paths,
            stop=stop,
            live=live,
        )
    return made, record, judged


def _add_first(
    paths: GraspPaths, task: Task, of: list[Choice], problems: Problems
) -> bool:
    """Add the first of a grasp's choices that has a joint path, and return whether
    there is one; write into ``of`` and ``problems`` what the others lack, which are not
    tried again.
    """
    for i, choice in enumerate(of):
        if not choice.segments or not (choice.feasible or paths.force):
            continue
        key = (choice.mode, choice.contacts, choice.label, choice.merits)
        try:
            if key not in problems:
                paths.add(plan_of(task, [choice]).by_placement[0])
                return True
        except InfeasibleTaskError as error:
            problems[key] = error
        why = str(problems[key]).split(": ", 1)[-1]
        of[i] = choice.refused(Refusal("joint_path", literal(why)))
    return False


def run(
    what: Task | Plan,
    *,
    engine: Engine = "drake",
    seed: int = 0,
    progress: Progress | None = None,
    models: str = "generated",
) -> Record:
    """Run a plan, or select, plan and run a task, and return the record of what
    happened.

    Raises InfeasibleTaskError before anything moves where it cannot be done.
    """
    if isinstance(what, Task):
        return simulate(
            what, engine=engine, seed=seed, progress=progress, models=models
        )[1]
    if engine == "planar":
        from pushpressslide.planar.engine import run as run_planar

        return run_planar(what, seed=seed, progress=progress)
    from pushpressslide.sim.engine import run as run_drake

    return run_drake(what, seed=seed, progress=progress, models=models)


def run_task(
    task: Task,
    *,
    engine: Engine = "drake",
    seed: int = 0,
    out: Path | None = None,
    mode: str | None = None,
    force: bool = False,
    live: Told | None = None,
    video: bool = False,
    progress: Progress | None = None,
    models: str = "generated",
) -> dict[str, Any]:
    """Run ``task`` and return its result; with ``out`` also leave all files of a run
    there.

    ``mode`` restricts the choice to one mode; ``live`` is told the address where the
    run can be watched. Raises InfeasibleTaskError before anything moves where nothing
    can do the task, and Interrupted on Ctrl-C once the engine runs, after record and
    result so far are written.
    """
    from pushpressslide.report.metrics import result as measure

    if mode is not None:
        task = replace(task, modes=(mode,))
    interrupt = Interrupt()
    plan, record, choices = simulate(
        task,
        engine=engine,
        seed=seed,
        force=force,
        progress=progress,
        models=models,
        interrupt=interrupt,
        live=live,
    )
    with interrupt.held():
        result = measure(task, plan, record, versions())
        if out is not None:
            write_data(out, task, plan, record, result, choices)
    kept = "" if out is None else f"; record and result so far are in {out}"
    if interrupt():
        raise Interrupted(f"interrupted{kept}")
    if out is not None:
        try:
            write_pages(out, task, plan, record, choices, models=models, video=video)
        except KeyboardInterrupt:
            raise Interrupted(
                f"interrupted; record and result are in {out}, its pages not all"
            ) from None
    return result


PAGES = ("replay.html", "report.html", "run.webp", "plan.png")


def write_data(
    out: Path,
    task: Task,
    plan: Plan,
    record: Record,
    result: dict[str, Any],
    choices: list[Choice],
) -> None:
    """Write task, plan, record and result of a run into ``out``, after taking away an
    older run's pages.
    """
    from pushpressslide.report.files import save_run

    out.mkdir(parents=True, exist_ok=True)
    for name in PAGES:
        (out / name).unlink(missing_ok=True)
    for plot in (out / "plots").glob("*.png"):
        plot.unlink()
    save_run(out, task, plan, record, result, choices)


def write_pages(
    out: Path,
    task: Task,
    plan: Plan,
    record: Record,
    choices: list[Choice],
    *,
    models: str = "generated",
    video: bool = False,
) -> None:
    """Write the pictures, replay and report of a run whose data are in ``out``, each
    whole or not at all.
    """
    from pushpressslide.report.page import write_report
    from pushpressslide.report.plan_files import write_plan

    write_plan(plan, out, choices)
    if record.engine == "drake":
        from pushpressslide.sim.view.replay import write_replay

        write_replay(task, plan, record, out, models=models)
        if video:
            from pushpressslide.sim.view.frames import write_video

            write_video(task, plan, record, out, models=models)
    else:
        from pushpressslide.planar.replay import write_replay as write_planar_replay

        write_planar_replay(task, plan, record, out)
    write_report([out])
