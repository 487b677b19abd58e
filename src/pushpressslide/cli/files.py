"""Commands on task files: a new one, a shipped one, and the schema of their fields."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli.app import app, print_json
from pushpressslide.cli.options import TaskName


@app.command()
def new(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="YAML file to write.")],
    force: Annotated[
        bool, typer.Option("--force", help="Replace a file that is there already.")
    ] = False,
) -> None:
    """Write a task file with every field, to start from."""
    from pushpressslide.core.errors import PushPressSlideError
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.taskfile.starter import starter

    if file.exists() and not force:
        raise PushPressSlideError(f"{file}: is there already; --force replaces it")
    if not file.parent.is_dir():
        raise PushPressSlideError(f"{file}: there is no folder {file.parent}")
    name = re.sub(r"[^A-Za-z0-9_.-]+", "-", file.stem).strip("-")
    if not re.match(r"[A-Za-z]", name):
        name = f"task-{name}".strip("-")
    write_whole(file, starter(name[:64], str(file)).encode())
    typer.echo(file)


@app.command()
def show(
    task: TaskName,
    full: Annotated[
        bool, typer.Option("--full", help="With every field, defaults too.")
    ] = False,
) -> None:
    """Print the file of a task."""
    from pushpressslide.taskfile.load import dump_task, file_of, load_task

    # loaded in any case, so that only a valid task is printed
    loaded = load_task(task)
    text = (
        dump_task(loaded) if full else file_of(Path(task)).read_text(encoding="utf-8")
    )
    typer.echo(text, nl=False)


@app.command()
def schema() -> None:
    """Print the JSON Schema of task files, for editors."""
    from pushpressslide.taskfile.json_schema import json_schema

    print_json(json_schema())
