"""``pps object``: how an object rests on its support, and where tips may touch it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pushpressslide.cli.app import app, print_json
from pushpressslide.cli.options import Json

if TYPE_CHECKING:
    from pushpressslide.core.task import Task
    from pushpressslide.planning.object_sheet import ObjectSheet

SUPPORT = 0.35
"""Friction of the support of an object without a task."""
MASS = 1.0
"""Mass [kg] assumed for an object given as a mesh. Base, side and top do not depend on
the mass.
"""


@app.command(name="object")
def object_(
    file: Annotated[
        str, typer.Argument(help="A mesh, a URDF, SDF or MJCF file, or a task.")
    ],
    scale: Annotated[float, typer.Option(help="One unit of the mesh [m].")] = 1.0,
    up: Annotated[str, typer.Option(help="Axis of the mesh that points up.")] = "z",
    radius: Annotated[float, typer.Option(help="Radius of the tip [m].")] = 0.02,
    friction: Annotated[float, typer.Option(help="Of the tip.")] = 0.5,
    out: Annotated[Path, typer.Option(help="Folder of the picture.")] = Path("runs"),
    as_json: Json = False,
) -> None:
    """Show an object: base, side and top, and where tips may push and press.

    The support has a friction of 0.35. A task brings its own tips and frictions.
    """
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.planning.object_sheet import object_sheet
    from pushpressslide.report.object_figure import object_figure
    from pushpressslide.report.style import png

    task = _task_of(file, scale, up, (radius, friction))
    sheet = object_sheet(task.scene, task.motion)
    data = sheet_data(task, sheet)
    folder = out / f"object-{Path(file).stem}"
    folder.mkdir(parents=True, exist_ok=True)
    figure = object_figure(task.scene, sheet)
    picture = write_whole(folder / "object.png", png(figure))
    if as_json:
        print_json({**data, "picture": str(picture)})
        return
    _print(data)
    typer.echo(picture)


def _task_of(file: str, scale: float, up: str, tip: tuple[float, float]) -> Task:
    """Task with the object of a file. For a mesh, a table and one arm are added."""
    from pushpressslide.taskfile.load import load_task, task_from_data
    from pushpressslide.taskfile.mesh_file import read_mesh, suffixes

    if Path(file).suffix.lower() not in suffixes():
        return load_task(file)
    radius, friction = tip
    path = str(Path(file).resolve())
    mesh = {"path": path, "scale": scale, "up": up}
    try:
        own_mass = read_mesh(path, scale, up).file_mass
    except ValueError:
        own_mass = None  # the task's error gives the reason
    data = {
        "name": "object",
        "object": {"shape": {"mesh": mesh}, "mass": own_mass or MASS},
        "start": {"x": 0.45, "y": 0.0},
        "goal": {"x": 0.45, "y": 0.1},
        "support": {"friction": SUPPORT},
        "contact": {"friction": friction},
        "robots": [{"model": "panda", "tip_radius": radius}],
    }
    return task_from_data(data, file)


def sheet_data(task: Task, sheet: ObjectSheet) -> dict[str, Any]:
    """Output of ``pps object`` as plain data."""
    body = task.scene.body
    return {
        "shape": body.shape.description,
        "note": body.shape.note,
        "height": body.shape.height,
        "mass": body.shape.file_mass,
        "center_of_mass": list(body.center_of_mass),
        "base": sheet.base_kind,
        "base_patches": sheet.base_patches,
        "base_area": sheet.base_area,
        "base_size": list(sheet.base_size),
        "standing": sheet.standing,
        "push": sheet.no_push is None,
        "no_push": None if sheet.no_push is None else str(sheet.no_push),
        "push_height": sheet.push_height,
        "touched_share": sheet.touched_share,
        "lean_deg": math.degrees(sheet.lean),
        "press_height": sheet.press_height,
        "press_radius": sheet.press_radius,
    }


def _print(data: dict[str, Any]) -> None:
    """Print the properties of the object's base, weight, pushes and presses as text."""
    length, width = (1e3 * value for value in data["base_size"])
    x, y = (1e3 * value for value in data["center_of_mass"])
    typer.echo(data["shape"])
    if data["note"]:
        typer.echo(f"note:   {data['note']}")
    typer.echo(
        f"base:   {length:.0f} x {width:.0f} mm, {1e4 * data['base_area']:.1f} cm^2"
    )
    if data["mass"] is not None:
        typer.echo(f"mass:   {data['mass']:g} kg, of its file")
    standing = 1e3 * data["standing"]
    typer.echo(
        f"centre: ({x:.1f}, {y:.1f}) mm, {standing:.1f} mm inside the base's hull"
    )
    height = 1e3 * data["push_height"]
    if data["push"]:
        share = 100.0 * data["touched_share"]
        lean = f"leaning by {data['lean_deg']:.0f} deg"
        typer.echo(f"push:   at {height:.0f} mm, {share:.0f} % of the side, {lean}")
    else:
        typer.echo(f"push:   no: {data['no_push']}")
    if data["press_height"] is None:
        typer.echo("press:  no: no level place on top is large enough for the tip")
    else:
        typer.echo(f"press:  at {1e3 * data['press_height']:.0f} mm")
