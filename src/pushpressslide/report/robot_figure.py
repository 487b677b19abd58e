"""Picture of a robot: its ready posture from the side, and its workspace from above."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pushpressslide.report import style
from pushpressslide.robots.facts import TIP
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.sheet import Workspace


def robot_figure(kin: ArmKinematics, space: Workspace) -> Figure:
    """Ready posture and workspace of a robot with its base at the origin."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    side, top = figure.subplots(1, 2)
    _posture(side, kin)
    _workspace(top, kin, space)
    return figure


def _posture(axes: Axes, kin: ArmKinematics) -> None:
    """Draw the arm's joints in the ready posture, seen along y."""
    poses = kin.link_poses(kin.facts.home)
    chain = [kin.facts.base, *(j.child for j in kin.facts.joints), TIP]
    points = np.array([poses[link][1] for link in chain])
    axes.plot(points[:-1, 0], points[:-1, 2], "o-", color=style.GREY, lw=3.0, ms=5.0)
    axes.plot(points[-2:, 0], points[-2:, 2], color=style.BLACK, lw=2.0)
    axes.plot(*points[-1, ::2], "o", color=style.ORANGE, ms=8.0, label="tip")
    axes.axhline(0.0, color=style.BLACK, lw=0.8)
    axes.set(xlabel="x [m]", ylabel="z [m]", title="Ready posture, from the side")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left")


def _workspace(axes: Axes, kin: ArmKinematics, space: Workspace) -> None:
    """Draw the positions over the table, coloured by the largest press."""
    x, y, z = space.points.T
    ok = space.reached
    axes.plot(x[~ok], y[~ok], ".", color=style.GREY, ms=3.0, label="out of reach")
    values = np.minimum(space.press[ok], 1e4)
    dots = axes.scatter(x[ok], y[ok], c=values, s=40.0, cmap="viridis")
    axes.figure.colorbar(dots, ax=axes, label="largest press [N]")
    axes.plot(*kin.base[:2], "s", color=style.BLACK, label="base")
    height = f"{1e3 * float(z[0]):.0f} mm"
    axes.set(
        xlabel="x [m]", ylabel="y [m]", title=f"Workspace, tool down, tip at {height}"
    )
    axes.set_aspect("equal")
    axes.legend(loc="upper left")
