"""``pps robot``: the contents of a robot's file, the assumptions, and the arm's
abilities.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pushpressslide.cli.app import app, print_json
from pushpressslide.cli.options import Json
from pushpressslide.cli.text import print_text

if TYPE_CHECKING:
    from pushpressslide.core.scene import Robot
    from pushpressslide.robots.facts import RobotFacts
    from pushpressslide.robots.kinematics import ArmKinematics
    from pushpressslide.robots.sheet import Workspace


@app.command()
def robot(
    model: Annotated[
        str, typer.Argument(help="A shipped arm, as ur5e, or a URDF, SDF or MJCF file.")
    ],
    link: Annotated[
        str | None,
        typer.Option(help="Link or frame that carries the tip; by default the last."),
    ] = None,
    radius: Annotated[float, typer.Option(help="Radius of the tip [m].")] = 0.02,
    length: Annotated[float, typer.Option(help="Length of its rod [m].")] = 0.15,
    out: Annotated[Path, typer.Option(help="Folder of the picture.")] = Path("runs"),
    as_json: Json = False,
) -> None:
    """Show a robot: joints, limits, masses, assumptions, reach and largest forces.

    Prints the robots: lines of a task, and draws ready posture and workspace.
    """
    from pushpressslide.core.whole_file import write_whole
    from pushpressslide.report.robot_figure import robot_figure
    from pushpressslide.report.style import png
    from pushpressslide.robots.arm_files import arm_kinematics
    from pushpressslide.robots.sheet import workspace

    own = _robot(model, link, radius, length)
    kin = arm_kinematics(own)
    space = workspace(kin)
    data = sheet_data(kin, space, robot_lines(own, model, kin.facts))
    folder = out / f"robot-{Path(model).stem}"
    folder.mkdir(parents=True, exist_ok=True)
    picture = write_whole(folder / "robot.png", png(robot_figure(kin, space)))
    if as_json:
        print_json({**data, "picture": str(picture)})
        return
    _print(kin.facts, data)
    typer.echo(picture)


def _robot(model: str, link: str | None, radius: float, length: float) -> Robot:
    """The robot of a task that the command describes."""
    from pushpressslide.core.scene import MODELS, Robot, Tip
    from pushpressslide.robots.description import last_link

    if model in MODELS:
        return Robot(model, tip_radius=radius, tip_length=length)
    tip = Tip(link or last_link(model), radius=radius, length=length)
    return Robot(str(Path(model).resolve()), tip=tip)


def robot_lines(robot: Robot, model: str, facts: RobotFacts) -> str:
    """The ``robots`` field of a task file for this robot, with ``model`` as given."""
    from pushpressslide.core.scene import MODELS, TIP_LENGTH, TIP_RADIUS
    from pushpressslide.robots.sheet import limits_to_fill

    prefix = "" if robot.tip is not None else "tip_"
    tip = [] if robot.tip is None else [f"link: {robot.tip.link}"]
    for name, value, default in (
        ("radius", robot.tip_radius, TIP_RADIUS),
        ("length", robot.tip_length, TIP_LENGTH),
    ):
        if value != default:
            tip.append(f"{prefix}{name}: {value:g}")
    words = [f"model: {model}"]
    words += tip if robot.tip is None else [f"tip: {{{', '.join(tip)}}}"]
    limits = "" if model in MODELS else limits_to_fill(facts)
    if limits:
        words.append(f"limits: {limits}")
    return f"robots: [{{{', '.join(words)}}}]"


def sheet_data(kin: ArmKinematics, space: Workspace, lines: str) -> dict[str, Any]:
    """Output of ``pps robot`` as plain data."""
    import numpy as np

    from pushpressslide.robots.sheet import missing_limits

    facts = kin.facts
    reached = space.points[space.reached]
    distances = np.hypot(*reached.T[:2]) if len(reached) else np.zeros(1)
    home = [round(math.degrees(a), 1) for a in facts.home]
    return {
        "name": facts.name,
        "joints": [
            {
                "name": joint.name,
                "kind": joint.kind,
                "lower_deg": round(math.degrees(joint.lower), 1),
                "upper_deg": round(math.degrees(joint.upper), 1),
                "velocity_deg": _finite(math.degrees(joint.velocity)),
                "effort": _finite(joint.effort),
                "rotor": float(armature),
            }
            for joint, armature in zip(facts.moving, facts.armature, strict=True)
        ],
        "mass": sum(one.mass for one in facts.links),
        "home_deg": home,
        "missing": dict(missing_limits(facts)),
        "notes": list(facts.notes),
        "reach": [float(distances.min()), float(distances.max())],
        "press": _range(space.press),
        "push": _range(space.push),
        "robots": lines,
    }


def _finite(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None


def _range(values: Any) -> list[float] | None:
    """Smallest and largest of the finite values."""
    finite = [float(v) for v in values if math.isfinite(v)]
    return [min(finite), max(finite)] if finite else None


def _print(facts: RobotFacts, data: dict[str, Any]) -> None:
    """Print the properties of the robot as text: joints, mass, reach, forces, ready
    posture.
    """
    typer.echo(f"{data['name']}: {facts.size} joints, {data['mass']:.2f} kg")
    typer.echo(
        f"{'joint':28}{'range deg':>18}{'speed deg/s':>13}{'effort N m':>12}{'rotor kg m^2':>14}"
    )
    for joint in data["joints"]:
        limits = f"{joint['lower_deg']:.0f} to {joint['upper_deg']:.0f}"
        speed = (
            "none" if joint["velocity_deg"] is None else f"{joint['velocity_deg']:.0f}"
        )
        effort = "none" if joint["effort"] is None else f"{joint['effort']:g}"
        typer.echo(
            f"{joint['name'][:27]:28}{limits:>18}{speed:>13}{effort:>12}{joint['rotor']:>14.3g}"
        )
    for name, joints in data["missing"].items():
        print_text(f"missing: {name} of {', '.join(joints)} (limits)", 0)
    for note in data["notes"]:
        print_text(note, 0)
    near, far = data["reach"]
    typer.echo(f"tool down: {near:.2f} to {far:.2f} m from the base's axis")
    for name in ("press", "push"):
        if data[name] is not None:
            low, high = data[name]
            typer.echo(f"largest {name} there: {low:.0f} to {high:.0f} N")
    typer.echo(f"ready posture: home_deg: {data['home_deg']}")
    typer.echo(data["robots"])
