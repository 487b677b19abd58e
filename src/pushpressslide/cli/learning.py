"""Command that writes demonstrations for learning."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli.app import answer, command, task_of
from pushpressslide.cli.folders import hold, results_folder
from pushpressslide.cli.options import Force, Json, Quiet, Sets, TaskName
from pushpressslide.cli.shell import progress_bar
from pushpressslide.core.errors import PushPressSlideError

FILE = "demonstrations.npz"


@dataclass(frozen=True)
class DemonstrateOptions:
    """Argument and options of ``pps demonstrate``, in the order of its help."""

    task: TaskName
    episodes: Annotated[
        int, typer.Option("--episodes", min=1, max=100_000, help="Number of episodes.")
    ] = 100
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Of the first reset; the next follow.")
    ] = 0
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="File of the demonstrations, ends in .npz [in a new folder in runs/].",
        ),
    ] = None
    exact: Annotated[
        bool,
        typer.Option("--exact", help="On the exact limit surface: slower."),
    ] = False
    lerobot: Annotated[
        Path | None,
        typer.Option(
            "--lerobot",
            metavar="DIR",
            help="Also write a data set of LeRobot, version 3, into this folder.",
        ),
    ] = None
    sets: Sets = None
    as_json: Json = False
    quiet: Quiet = False
    force: Force = False


@command
def demonstrate(options: DemonstrateOptions) -> None:
    """Write demonstrations of a task of one push, to learn from.

    The controller of mode rear_push plays; docs/learning.md says what the file holds.
    """
    from pushpressslide.learning import demonstrations
    from pushpressslide.learning.lerobot import check_folder, write_lerobot
    from pushpressslide.learning.push_task import push_task

    push = push_task(task_of(options.task, options.sets))
    path = _file(options, push.task.name)
    if options.lerobot is not None:
        check_folder(options.lerobot)
        hold(options.lerobot)
    seeds = range(options.seed, options.seed + options.episodes)
    label = f"{options.episodes} episodes of {push.task.name}"
    with progress_bar(label, not options.quiet) as progress:
        shown = demonstrations.demonstrate(push, seeds, progress, options.exact)
    shown.write(path)
    if options.lerobot is not None:
        write_lerobot(shown, options.lerobot, push.task.description or push.task.name)
    reached = int(shown.success.sum())
    frames = len(shown.actions)
    data = {
        "schema": 1,
        "task": push.task.name,
        "episodes": options.episodes,
        "first_seed": options.seed,
        "successes": reached,
        "frames": frames,
        "file": str(path),
    }
    text = f"{reached} of {options.episodes} episodes reach the goal, {frames} frames"
    answer(data, options, lambda: typer.echo(f"{text}\n{path}"))


def _file(options: DemonstrateOptions, name: str) -> Path:
    """File to write, checked before any episode is played."""
    out = options.out
    if out is None:
        return results_folder(None, f"demonstrate-{name}", options.force) / FILE
    if out.suffix != ".npz":
        raise PushPressSlideError(
            f"--out: {str(out)!r} is not allowed; allowed: a name that ends in .npz"
        )
    lock = f".{out.name}.lock"
    folder = results_folder(out.parent, name, options.force, (out.name,), lock)
    return folder / out.name
