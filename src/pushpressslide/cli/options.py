"""Arguments and options shared by several commands."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from pushpressslide.cli import complete
from pushpressslide.jobs.engines import EngineName


class Variation(StrEnum):
    """Kind of random variation between the samples of a sweep."""

    truth = "truth"
    tasks = "tasks"
    start = "start"
    knocks = "knocks"


class Drawing(StrEnum):
    """Kind of new tasks drawn by a sweep."""

    ahead = "ahead"
    any = "any"
    cluttered = "cluttered"


class World(StrEnum):
    """How the samples of a sweep differ from the planner's belief."""

    known = "known"
    uncertain = "uncertain"
    tier1 = "tier1"
    tier2 = "tier2"
    tier3 = "tier3"


class Models(StrEnum):
    """Source of the robot models used in Drake."""

    generated = "generated"
    drake_models = "drake_models"


TaskName = Annotated[
    str,
    typer.Argument(
        metavar="TASK",
        help="Name of a shipped task, as `pps tasks` lists them, or path of a YAML file.",
        autocompletion=complete.tasks,
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="A.B=C",
        help="Override a field of the task, as motion.speed=0.03; repeatable. "
        "`pps show TASK --full` lists the fields.",
    ),
]
ModeName = Annotated[
    str | None,
    typer.Option(
        "--mode",
        metavar="NAME",
        help=f"Use this contact mode only: {', '.join(complete.mode_names())}.",
        autocompletion=complete.modes,
    ),
]
Engine = Annotated[EngineName, typer.Option("--engine", help="Physics engine.")]
Seed = Annotated[
    int,
    typer.Option("--seed", metavar="N", min=0, help="Seeds everything random."),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Folder of the results [a new one in runs/]."
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON and nothing else.")
]
Force = Annotated[
    bool,
    typer.Option("--force", help="Replace a result that is in the folder already."),
]
Joints = Annotated[
    bool,
    typer.Option(
        "--joints", help="Look for the arms' joint paths, too; takes seconds."
    ),
]
Verbose = Annotated[
    bool,
    typer.Option(
        "--verbose", help="Where no mode can do the task, a table of all reasons."
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
