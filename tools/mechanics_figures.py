"""Draw the figures of docs/mechanics.md, by the library's own functions.

    python tools/mechanics_figures.py docs/figures

The cube is 15 cm wide and pushed 7.5 cm behind its centre; the bar is the paper's, 0.6 x
0.2 m of 0.3 kg, pressed with 8 N at 0.2 m.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.friction import cone_edges, motion_cone
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_twist_direction,
    exact_wrenches,
)
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.mechanics.pressure import CELL_RADIUS, rectangle_pressure
from pushpressslide.mechanics.rho import rho_fit, rho_straight
from pushpressslide.report import style
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.rom.unicycle import Unicycle

CUBE = 0.15  # [m]
LEVER = CUBE / 2.0
MU_S = 0.3
MU_A = 0.4
LENGTH = 0.6  # [m]
WIDTH = 0.2
PRESSED = 0.2  # [m] from the CoM
LOAD = 8.0  # [N]
BAR = pps.Object(pps.Box((LENGTH, WIDTH, 0.1)), 0.3, (0.0, 0.0))
PRESS = Press(BAR, MU_S, (PRESSED, 0.0), LOAD)


def arrow(axes: Any, foot: Any, vector: Any, color: str, width: float = 1.6) -> None:
    """Draw ``vector`` from ``foot``."""
    tip = (foot[0] + vector[0], foot[1] + vector[1])
    look = {
        "arrowstyle": "-|>",
        "color": color,
        "lw": width,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    axes.annotate("", xy=tip, xytext=foot, arrowprops=look)


def outline(axes: Any, corners: Any, color: str = style.GREY, **look: Any) -> None:
    """Draw a closed line round ``corners``."""
    xs, ys = np.transpose([*corners, corners[0]])
    axes.plot(xs, ys, color=color, **look)


def plan_view(axes: Any, text: str) -> None:
    """Make a panel a plan view in metres."""
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    style.title(axes, text)


def frames() -> Any:
    """Draw the frames W, G, B and V of a pushed L, and the numbers of its faces."""
    task = pps.load_task("l-shape", ["modes=[rear_push]", "goal.yaw_deg=-20"])
    segment = pps.plan(task).segments[0]
    made, (axes,) = style.figure(height=4.6, width=7.0)
    X_WG = task.start
    corners = task.object.shape.polygon
    outline(axes, [X_WG.apply(p) for p in corners], style.BLACK, lw=1.8)
    for i, (a, b) in enumerate(zip(corners, [*corners[1:], corners[0]], strict=True)):
        middle = np.mean([a, b], axis=0)
        left = np.array([a[1] - b[1], b[0] - a[0]]) / math.dist(a, b)
        axes.text(
            *X_WG.apply(tuple(middle + 0.011 * left)), str(i), ha="center", va="center"
        )
    X_WB = X_WG.compose(task.object.X_GB)
    X_WV = X_WB.compose(segment.drive.X_BV)
    named = (
        ("W", Pose2(0.38, 0.03, 0.0), style.BLACK),
        ("G", X_WG, style.BLUE),
        ("B", X_WB, style.GREEN),
        ("V", X_WV, style.ORANGE),
    )
    for name, frame, color in named:
        for axis in ((0.05, 0.0), (0.0, 0.05)):
            arrow(axes, (frame.x, frame.y), frame.rotate(axis), color)
        axes.text(
            frame.x - 0.008,
            frame.y - 0.008,
            name,
            color=color,
            ha="right",
            va="top",
            weight="bold",
        )
    (contact,) = segment.contacts
    push = X_WB.apply(contact.point)
    normal = X_WB.rotate(contact.normal)
    arrow(
        axes,
        (push[0] - 0.06 * normal[0], push[1] - 0.06 * normal[1]),
        (0.06 * normal[0], 0.06 * normal[1]),
        style.PURPLE,
        2.4,
    )
    plan_view(axes, "Frames of a pushed object, and the numbers of its faces")
    axes.set(xlim=(0.34, 0.68), ylim=(0.0, 0.44))
    axes.grid(False)
    return made


def limit_surface() -> Any:
    """Draw two slices of the limit surface, exact and as an ellipsoid."""
    made, axes = style.figure(height=3.6, across=2, share_x=False)
    cases = (
        ("cube, load even", rectangle_pressure(CUBE, CUBE)),
        ("bar, pressed at its end", rectangle_pressure(LENGTH, WIDTH, cop=PRESS.cop)),
    )
    for ax, (text, samples) in zip(axes, cases, strict=True):
        rho = rho_fit(samples)
        angles = np.linspace(0.0, 2.0 * math.pi, 361)
        twists = np.stack(
            [np.zeros_like(angles), np.cos(angles), np.sin(angles) / rho], axis=1
        )
        exact = exact_wrenches(samples, 1.0, twists)
        ax.plot(np.cos(angles), np.sin(angles), color=style.BLUE, label="ellipsoid")
        ax.plot(exact[:, 1], exact[:, 2] / rho, color=style.ORANGE, label="exact")
        surface = EllipsoidLimitSurface(1.0, rho)
        for angle in np.radians([20.0, 50.0, 80.0]):
            wrench = Wrench(0.0, math.cos(angle), rho * math.sin(angle))
            flat = surface.twist_direction(wrench)
            true = exact_twist_direction(
                samples, Wrench(0.0, wrench.fy, wrench.tau, samples.cop)
            )
            for twist, color in ((flat, style.BLUE), (true, style.ORANGE)):
                size = math.hypot(twist.vy, rho * twist.w)
                step = (0.35 * twist.vy / size, 0.35 * rho * twist.w / size)
                arrow(ax, (wrench.fy, wrench.tau / rho), step, color, 1.2)
        ax.set(aspect="equal", xlim=(-1.15, 1.5), ylim=(-1.15, 1.5))
        ax.set_xlabel("F_y / (mu_s N)")
        ax.set_ylabel("tau / (mu_s N rho)")
        style.title(ax, f"{text}, rho {1e3 * rho:.0f} mm")
    axes[0].legend(loc="center", fontsize=8.5)
    return made


def cones() -> Any:
    """Draw the friction cone and the motion cone of a contact behind the cube."""
    rho = rho_fit(rectangle_pressure(CUBE, CUBE))
    contact = (-LEVER, 0.0)
    normal = (1.0, 0.0)
    made, (axes,) = style.figure(height=3.8, width=6.0)
    half = CUBE / 2.0
    outline(
        axes, [(-half, -half), (half, -half), (half, half), (-half, half)], style.BLACK
    )
    wedges = (
        ("motion cone", motion_cone(contact, rho, normal, MU_A), style.SKY),
        ("friction cone", cone_edges(normal, MU_A), style.AMBER),
    )
    for text, edges, color in wedges:
        angles = [math.atan2(y, x) for x, y in edges]
        bow = np.linspace(*angles, 40)
        x = [contact[0], *(contact[0] + 0.1 * np.cos(bow))]
        y = [contact[1], *(contact[1] + 0.1 * np.sin(bow))]
        size = math.degrees(max(angles))
        axes.fill(x, y, color=color, alpha=0.75, label=f"{text}, ±{size:.0f}°")
    car = RearSteerCar(contact, normal, (0.0, 0.0), rho, MU_A)
    axes.plot(0.0, 0.0, "o", color=style.BLACK, label="centre of pressure")
    axes.plot(
        car.X_BV.x, car.X_BV.y, "o", color=style.ORANGE, label="virtual front axle"
    )
    plan_view(axes, "What a rear push can give: forces and velocities")
    axes.set_xticks([-0.05, 0.0, 0.05])
    axes.set_yticks([-0.05, 0.0, 0.05])
    style.legend(axes)
    return made


def velocities(axes: Any, twist: Twist, points: Any, color: str) -> None:
    """Draw how points of a turning body move, the fastest by 40 mm."""
    moved = [twist.moved_to((x, 0.0)) for x in points]
    fastest = max(math.hypot(m.vx, m.vy) for m in moved)
    for x, m in zip(points, moved, strict=True):
        step = (0.04 * m.vx / fastest, 0.04 * m.vy / fastest)
        arrow(axes, (x, 0.0), step, color, 0.9)


def axle_panel(
    axes: Any, corners: Any, car: RearSteerCar | Unicycle, angles: Any
) -> None:
    """Draw forces of one contact, the motion under each, and the axle's velocity."""
    outline(axes, corners, style.BLACK)
    contact = car.contact
    axle = car.X_BV.x
    ends = sorted((contact[0], axle))
    points = np.unique([*np.linspace(ends[0], ends[1], 6), axle])
    for angle, color in zip(
        angles, (style.BLUE, style.GREEN, style.PURPLE), strict=True
    ):
        way = (math.cos(angle), math.sin(angle))
        wrench = Wrench(*way, contact[0] * way[1])
        surface = EllipsoidLimitSurface(1.0, car.rho, car.cop)
        velocities(axes, surface.twist_direction(wrench), points, color)
        foot = contact
        if isinstance(car, RearSteerCar):
            foot = (contact[0] - 0.07 * way[0], -0.07 * way[1])
        arrow(axes, foot, (0.07 * way[0], 0.07 * way[1]), color, 2.4)
    axes.plot(*contact, "s", color=style.BLACK, ms=6, label="contact")
    axes.plot(*car.cop, "x", color=style.BLACK, ms=8, mew=2, label="centre of pressure")
    axes.plot(axle, 0.0, "o", color=style.ORANGE, ms=9, label="virtual axle")
    axes.grid(False)


def axles() -> Any:
    """Draw the virtual axle of a pushed cube and of a pulled bar."""
    made, panels = style.figure(2, height=6.4, width=7.4, share_x=False)
    half = CUBE / 2.0
    cube = [(-half, -half), (half, -half), (half, half), (-half, half)]
    rho = rho_fit(rectangle_pressure(CUBE, CUBE))
    car = RearSteerCar((-LEVER, 0.0), (1.0, 0.0), (0.0, 0.0), rho, MU_A)
    axle_panel(panels[0], cube, car, np.radians([0.0, 15.0, -15.0]))
    panels[0].set(xlim=(-0.16, 0.11), ylim=(-0.09, 0.09))
    plan_view(panels[0], "Pushed from behind: the axle is ahead")
    a, b = LENGTH / 2.0, WIDTH / 2.0
    bar = [(-a, -b), (a, -b), (a, b), (-a, b)]
    unicycle = Unicycle(
        (PRESSED, 0.0),
        PRESS.cop,
        rho_straight(rectangle_pressure(LENGTH, WIDTH, cop=PRESS.cop)),
    )
    axle_panel(panels[1], bar, unicycle, np.radians([0.0, 45.0, -75.0]))
    panels[1].set(ylim=(-0.12, 0.12))
    plan_view(panels[1], "Pressed and pulled: the axle is behind")
    style.legend(panels[0])
    return made


def pressure() -> Any:
    """Draw the pressure along a bar under presses, and what is left of rho."""
    made, (left, right) = style.figure(height=3.4, across=2, share_x=False)
    for load, color in ((0.0, style.GREY), (2.0, style.BLUE), (8.0, style.ORANGE)):
        total = load + PRESS.weight
        cop = PRESSED * load / total
        samples = rectangle_pressure(LENGTH, WIDTH, total, (cop, 0.0), 30)
        density = samples.loads * WIDTH / (samples.radii / CELL_RADIUS) ** 2
        order = np.argsort(samples.points[:, 0])
        xs = samples.points[order, 0]
        left.plot(xs, density[order], color=color, label=f"press of {load:.0f} N")
        left.axvline(cop, color=color, ls=":", lw=1.0)
    left.set_xlabel("along the bar [m]")
    left.set_ylabel("load [N/m]")
    left.legend(fontsize=8.5)
    style.title(left, "Load, and its centre (dotted)")
    cops = np.linspace(0.0, 0.28, 57)
    rhos = [
        rho_straight(rectangle_pressure(LENGTH, WIDTH, 1.0, (c, 0.0))) for c in cops
    ]
    right.plot(cops, rhos, color=style.ORANGE)
    right.axvline(LENGTH / 6.0, color=style.GREY, ls="--", lw=1.0)
    right.text(LENGTH / 6.0 + 0.005, 0.165, "far side lifts", color=style.GREY)
    right.set_xlabel("centre of pressure [m]")
    right.set_ylabel("rho, straight [m]")
    right.set_ylim(0.0, 0.18)
    style.title(right, "What is left of rho")
    return made


def paper() -> Any:
    """Draw where the paper and the exact model have the virtual axle of its bar."""
    made, (axes,) = style.figure(height=3.8, width=8.0)
    a, b = LENGTH / 2.0, WIDTH / 2.0
    outline(axes, [(-a, -b), (a, -b), (a, b), (-a, b)], style.BLACK)
    near = math.radians(1.0)
    cop = PRESS.cop[0]
    found = (
        ("paper, as printed", -PRESS.paper_printed(), style.GREY),
        ("paper's formula, sign as it must be", PRESS.paper_axle(), style.BLUE),
        ("exact, force at the support", PRESS.axle(near, 0.0), style.GREEN),
        ("exact, tip 0.1 m high, pulled", PRESS.axle(near), style.ORANGE),
        ("exact, tip 0.1 m high, pushed", PRESS.axle(math.pi - near), style.PURPLE),
    )
    axes.plot(PRESSED, 0.0, "s", color=style.BLACK, label="contact")
    axes.plot(cop, 0.0, "x", color=style.BLACK, ms=8, mew=2, label="centre of pressure")
    axes.plot(0.0, 0.0, "+", color=style.BLACK, ms=9, mew=2, label="centre of mass")
    for i, (text, x, color) in enumerate(sorted(found, key=lambda row: -row[1])):
        height = -0.16 - 0.05 * i
        axes.plot([x, x], [0.0, height], color=color, lw=1.0)
        axes.plot(x, 0.0, "o", color=color, ms=8)
        axes.text(
            x + 0.012,
            height,
            f"{text}: {x:+.3f} m",
            color=color,
            va="center",
            fontsize=8.5,
        )
    plan_view(axes, "The virtual axle of the paper's pressed bar")
    axes.grid(False)
    axes.legend(loc="upper left", ncols=3, fontsize=8.5)
    axes.set_ylim(-0.42, 0.24)
    return made


FIGURES: dict[str, Callable[[], Any]] = {
    "frames": frames,
    "limit-surface": limit_surface,
    "cones": cones,
    "axles": axles,
    "pressure": pressure,
    "paper-axle": paper,
}


def draw(out: Path) -> list[Path]:
    """Write every figure to ``out``/mechanics-NAME.png; return their paths."""
    paths = []
    for name, figure in FIGURES.items():
        path = out / f"mechanics-{name}.png"
        path.write_bytes(style.png(figure()))
        paths.append(path)
    return paths


if __name__ == "__main__":
    for written in draw(Path(sys.argv[1])):
        print(written)
