"""The command demonstrate: writes demonstrations for learning."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pushpressslide.cli.app import answer, command, task_of
from pushpressslide.cli.folders import hold, results_folder
from pushpressslide.cli.options import Force, Json, ModeName, Quiet, Sets, TaskName
from pushpressslide.cli.shell import progress_bar
from pushpressslide.cli.text import print_text
from pushpressslide.core.errors import PushPressSlideError

if TYPE_CHECKING:
    from pushpressslide.core.task import Task
    from pushpressslide.learning.demonstrations import Demonstrations, Progress
    from pushpressslide.learning.picture import Picture

REAR_PUSH = "rear_push"
FAILURES = 10  # episodes whose failures are printed
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
    mode: ModeName = None
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
    video: Annotated[
        bool,
        typer.Option("--video", help="With --lerobot: with pictures from above, too."),
    ] = False
    sets: Sets = None
    as_json: Json = False
    quiet: Quiet = False
    force: Force = False


@command
def demonstrate(options: DemonstrateOptions) -> None:
    """Write demonstrations of a task, to learn from.

    The controller of mode rear_push plays a task of one push. For any other mode the
    commands of all tips are written. docs/learning.md describes the file.
    """
    from pushpressslide.learning.lerobot import (
        check_folder,
        check_video,
        write_lerobot,
    )
    from pushpressslide.taskfile.load import check_task

    task = task_of(options.task, options.sets)
    modes = task.modes if options.mode is None else (options.mode,)
    task = check_task(replace(task, modes=modes))
    play, picture = _player(task, options)
    path = _file(options, task.name)
    if options.video:
        check_video(options.lerobot)
    if options.lerobot is not None:
        check_folder(options.lerobot)
        hold(options.lerobot)
    seeds = range(options.seed, options.seed + options.episodes)
    label = f"{options.episodes} episodes of {task.name}"
    with progress_bar(label, not options.quiet) as progress:
        shown = play(seeds, progress)
    shown.write(path)
    if options.lerobot is not None:
        text = task.description or task.name
        write_lerobot(shown, options.lerobot, text, picture if options.video else None)
    answer(_summary(shown, options, path), options, lambda: _print_summary(shown, path))


def _player(
    task: Task, options: DemonstrateOptions
) -> tuple[Callable[[Sequence[int], Progress], Demonstrations], Picture]:
    """A function that plays episodes of a task, and a function that draws their frames."""
    from pushpressslide.learning import demonstrations
    from pushpressslide.learning.picture import Camera, CommandCamera
    from pushpressslide.learning.push_task import push_task

    if task.modes is not None and REAR_PUSH not in task.modes:
        if options.exact:
            allowed = f"allowed with mode {REAR_PUSH}"
            raise PushPressSlideError(f"--exact: {allowed}")
        play = partial(demonstrations.demonstrate_commands, task)
        return play, CommandCamera(task).picture
    push = push_task(task)
    exact = options.exact
    return (
        lambda seeds, progress: demonstrations.demonstrate(
            push, seeds, progress, exact
        ),
        Camera(push).picture,
    )


def _summary(
    shown: Demonstrations, options: DemonstrateOptions, path: Path
) -> dict[str, Any]:
    """Figures of demonstrations, for --json."""
    failures = (~shown.success).nonzero()[0]
    return {
        "schema": 1,
        "task": shown.task,
        "episodes": options.episodes,
        "first_seed": options.seed,
        "successes": int(shown.success.sum()),
        "failures": {str(shown.seed[i]): str(shown.reason[i]) for i in failures},
        "frames": len(shown.actions),
        "file": str(path),
    }


def _print_summary(shown: Demonstrations, path: Path) -> None:
    """Print how many episodes succeed, and why the others fail."""
    count = len(shown.success)
    reached = f"{int(shown.success.sum())} of {count} episodes reach the goal"
    typer.echo(f"{reached}, {len(shown.actions)} frames")
    failures = (~shown.success).nonzero()[0]
    for i in failures[:FAILURES]:
        print_text(f"seed {shown.seed[i]}: {shown.reason[i]}", 4)
    if len(failures) > FAILURES:
        typer.echo(f"and {len(failures) - FAILURES} more; --json lists all")
    typer.echo(path)


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
