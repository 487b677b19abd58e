"""The command ``pps``. Everything heavy is imported inside the command that uses it, so that help answers at once."""

from __future__ import annotations

import importlib
import json
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from pushpressslide.core.errors import PushPressSlideError, Shown, SimulationError, TaskError

if TYPE_CHECKING:
    from pushpressslide.core.task import Task

REACHED, MISSED, WRONG_INPUT, INTERNAL_ERROR, INTERRUPTED = 0, 1, 2, 3, 130


class Engine(StrEnum):
    """What the task is run on."""

    drake = "drake"
    planar = "planar"


class Models(StrEnum):
    """Whose robot models are used on Drake."""

    generated = "generated"
    drake_models = "drake_models"


class Commands(TyperGroup):
    """The commands, with the exit statuses and the one-line errors that they promise."""

    def main(
        self, args: Any = None, prog_name: str | None = None, *rest: Any, standalone_mode: bool = True, **extra: Any
    ) -> Any:
        """Run the command of ``args`` (default: the process's) and exit with its status."""
        words = list(sys.argv[1:] if args is None else args)
        status = INTERNAL_ERROR
        try:
            answer = super().main(words or ["--help"], prog_name or "pps", *rest, standalone_mode=False, **extra)
            status = answer if isinstance(answer, int) else REACHED
            if status == INTERRUPTED:
                _complain("interrupted")
        except (KeyboardInterrupt, typer.Abort):
            _complain("interrupted")
            status = INTERRUPTED
        except Exception as error:
            status = _explain(error, "--json" in words)
        if not standalone_mode:
            return status
        sys.exit(status)


def _complain(line: str) -> None:
    typer.echo(f"pps: {' '.join(line.split())}", err=True)


def _explain(error: Exception, as_json: bool) -> int:
    """Say in one line on stderr what went wrong; return the exit status."""
    usage = getattr(error, "format_message", None)
    if usage is not None:
        _complain(usage())
        return WRONG_INPUT
    if isinstance(error, PushPressSlideError) and not isinstance(error, SimulationError):
        _complain(str(error))
        return WRONG_INPUT
    text = " ".join(f"{type(error).__name__}: {error}".split())
    if os.environ.get("PPS_TRACEBACK"):
        import traceback

        traceback.print_exception(error)
    _complain(f"internal error: {text[:400]} (PPS_TRACEBACK=1 shows where)")
    if as_json:
        failure = {"schema": 1, "success": False, "reason": {"code": "internal_error", "text": text}}
        typer.echo(json.dumps(failure))
    return INTERNAL_ERROR


app = typer.Typer(
    cls=Commands,
    help="Push, press and slide objects with one or two robot arms. TASK: a shipped task's name, or a YAML file.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

TaskName = Annotated[str, typer.Argument(metavar="TASK", help="Name of a shipped task, or path of a YAML file.")]
Sets = Annotated[list[str], typer.Option("--set", metavar="A.B=C", help="Override a field of the task; repeatable.")]
ModeName = Annotated[str | None, typer.Option("--mode", metavar="NAME", help="Use this contact mode only.")]
EngineName = Annotated[Engine, typer.Option("--engine", help="Physics engine.")]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seeds everything random.")]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder of the results [a new one in runs/].")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON and nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Replace a result that is in the folder already.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]


def main() -> None:
    """Entry point of the command ``pps``."""
    app()


def _version(wanted: bool) -> None:
    if wanted:
        import pushpressslide

        typer.echo(pushpressslide.__version__)
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
) -> None: ...


def _load(name: str, sets: list[str], mode: str | None = None) -> Task:
    from pushpressslide.pipeline.task_file import load_task

    return load_task(name, [*sets, f"modes={json.dumps([mode])}"] if mode is not None else sets)


def _folder(out: Path | None, name: str, force: bool, results: tuple[str, ...] = ("result.json",)) -> Path:
    """Return the folder for results, not made yet; it is checked that it may be made and holds no result."""
    if out is None:
        stamp = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
        out, n = Path("runs") / stamp, 1
        while out.exists():
            n += 1
            out = Path("runs") / f"{stamp}-{n}"
    held = [result for result in results if (out / result).exists()]
    if held and not force:
        raise TaskError("pps", "--out", str(out), f"it holds {held[0]} already; give another folder, or --force")
    above = next(path for path in (out, *out.absolute().parents) if path.exists())
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise TaskError("pps", "--out", str(out), "allowed: a folder that can be written, or a new one")
    return out


def _later(module: str, name: str, command: str) -> Callable[..., Any]:
    """Return a function of a part that this version may lack."""
    path = f"pushpressslide.{module}"
    try:
        return getattr(importlib.import_module(path), name)  # type: ignore[no-any-return]
    except ModuleNotFoundError as error:
        if not path.startswith(error.name or "?"):
            raise
        raise PushPressSlideError(f"{command}: not part of this version yet") from None


@contextmanager
def _progress(label: str, shown: bool) -> Iterator[Callable[[float, float], None]]:
    """Show a bar with the time left on stderr, if that is a terminal; yields the function that moves it."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    visible = shown and sys.stderr.isatty()
    with Progress(*columns, console=Console(stderr=True), transient=True, disable=not visible) as bar:
        item = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(item, completed=min(done, total), total=total)


def _show(value: Any) -> None:
    from pushpressslide.report.files import to_json

    typer.echo(to_json(value), nl=False)


@app.command()
def modes(as_json: Json = False) -> None:
    """Show the library of contact modes."""
    from pushpressslide.modes import MODES
    from pushpressslide.report import console

    rows = console.mode_rows(MODES.values())
    _show(rows) if as_json else console.print_rows(rows)


@app.command()
def tasks(as_json: Json = False) -> None:
    """Show the tasks that ship with the package."""
    from pushpressslide.pipeline.task_file import load_task, shipped_tasks

    found = {name: load_task(name).description for name in shipped_tasks()}
    if as_json:
        typer.echo(json.dumps(found, indent=2))
        return
    width = max(map(len, found), default=0)
    for name, description in found.items():
        typer.echo(f"{name:<{width}}  {description}")


@app.command()
def select(
    task: TaskName, sets: Sets = [], out: Out = None, as_json: Json = False, force: Force = False
) -> int:  # fmt: skip
    """Rank the contact modes for a task, with the number that decides."""
    from pushpressslide.pipeline.planner import refusal
    from pushpressslide.pipeline.selection import select as rank
    from pushpressslide.report import console
    from pushpressslide.report.files import to_json, write_whole

    loaded = _load(task, sets)
    folder = _folder(out, f"select-{loaded.name}", force, ("select.json", "result.json"))
    choices = rank(loaded)
    rows = console.choice_rows(choices)
    write_whole(folder / "select.json", to_json({"schema": 1, "task": loaded.name, "choices": rows}))
    _show(rows) if as_json else console.print_choices(choices)
    if any(choice.feasible for choice in choices):
        return REACHED
    _complain(refusal(loaded, choices))
    return WRONG_INPUT


@app.command()
def plan(
    task: TaskName,
    mode: ModeName = None,
    sets: Sets = [],
    out: Out = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Plan only: writes plan.json and plan.png."""
    from pushpressslide.pipeline.planner import plan as make_plan
    from pushpressslide.pipeline.selection import select as rank
    from pushpressslide.report.plan_files import plan_to_dict, write_plan

    loaded = _load(task, sets, mode)
    folder = _folder(out, f"plan-{loaded.name}", force, ("plan.json", "result.json"))
    choices = rank(loaded)
    made = make_plan(loaded, choices[0])
    write_plan(made, folder, choices)
    if as_json:
        _show(plan_to_dict(made, choices))
        return
    typer.echo(f"{made.choice.mode}: {made.choice.reason}")
    typer.echo(f"path {made.path.length:.3f} m in {made.profile.duration:.1f} s")
    typer.echo(folder / "plan.png")


@app.command()
def run(
    task: TaskName,
    engine: EngineName = Engine.drake,
    mode: ModeName = None,
    seed: Seed = 0,
    out: Out = None,
    sets: Sets = [],
    as_json: Json = False,
    quiet: Quiet = False,
    live: Annotated[bool, typer.Option("--live", help="Watch in Meshcat while it runs.")] = False,
    video: Annotated[bool, typer.Option("--video", help="Also write an animation.")] = False,
    models: Annotated[Models, typer.Option("--models", help="Robot models on Drake.")] = Models.generated,
    anyway: Annotated[bool, typer.Option("--anyway", help="Run the best choice even if judged infeasible.")] = False,
    force: Force = False,
) -> int:
    """Run a task: select, plan, track and execute in a physics engine; writes report, replay and record."""
    loaded = _load(task, sets, mode)
    folder = _folder(out, loaded.name, force)
    if engine is Engine.planar and (live or video):
        raise TaskError("pps", "--live" if live else "--video", Shown("with --engine planar"), "allowed: --engine drake")
    from pushpressslide.experiments.run import run_task

    with _progress(f"{loaded.name} on {engine.value}", not quiet) as progress:
        result = run_task(
            loaded, engine=engine.value, seed=seed, out=folder, mode=mode, force=anyway, live=live, video=video,
            progress=progress, models=models.value,
        )  # fmt: skip
    if as_json:
        _show(result)
    elif not quiet:
        from pushpressslide.report import console

        console.print_result(result, folder)
    if result["reason"]["code"] == "interrupted":
        return INTERRUPTED
    return REACHED if result["success"] else MISSED
