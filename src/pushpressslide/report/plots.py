"""Figures of a run over time: errors, forces, joint torques, speeds; and several runs
in one figure.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import series, style
from pushpressslide.report.metrics import robot_facts
from pushpressslide.report.plane import path_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Maker = Callable[[Task, Plan, Record], "Figure | None"]
MOST_POINTS = 20000  # of a curve; more than a figure can show
LEAST_REACH = (
    # [mm], [deg] that an axis of errors spans at least, so that a trifle does not fill
    # the panel
    0.1
)
MEASURED: dict[str, Any] = {"color": style.BLUE}
COMMANDED: dict[str, Any] = {"color": style.ORANGE, "lw": 1.0, "ls": "--"}


def figures(task: Task, plan: Plan, record: Record) -> dict[str, Figure]:
    """Return every figure that the record has the data for, by name, in the order to be
    shown.
    """
    from pushpressslide.report.axle_figures import axle_over_time

    if series.ticks(record) < 2:
        return {}
    of_all: dict[str, Maker] = {
        "path": path_figure,
        "errors": errors_figure,
        "tracking": tracking_figure,
    }
    of_grasp: dict[str, Maker] = {"axle": axle_over_time, "forces": forces_figure}
    of_arms: dict[str, Maker] = {"torques": torques_figure, "speeds": speeds_figure}
    grasps = series.by_grasp(plan, record)
    made = {name: maker(task, plan, record) for name, maker in of_all.items()}
    for i, (grasp, part) in enumerate(grasps):
        number = f"-{i + 1}" if len(grasps) > 1 else ""
        made |= {
            f"{name}{number}": maker(task, grasp, part)
            for name, maker in of_grasp.items()
        }
    made |= {name: maker(task, plan, record) for name, maker in of_arms.items()}
    return {name: figure for name, figure in made.items() if figure is not None}


def write_plots(task: Task, plan: Plan, record: Record, out: Path) -> list[Path]:
    """Write every figure as a PNG into folder ``out``; return their paths."""
    return [
        write_whole(out / f"{name}.png", style.png(figure))
        for name, figure in figures(task, plan, record).items()
    ]


def errors_figure(task: Task, plan: Plan, record: Record) -> Figure:
    """Return position and yaw error against the reference at the same time, with the
    goal's tolerance.
    """
    made, (top, bottom) = style.figure(2, 4.6)
    time, position, yaw = timed_errors(record)
    top.plot(*_thin(time, 1e3 * position), color=style.BLUE, label="object")
    bottom.plot(*_thin(time, np.degrees(yaw)), color=style.BLUE, label="object")
    tolerance = task.tolerance
    top.axhline(
        1e3 * tolerance.position,
        color=style.ORANGE,
        ls="--",
        lw=1.1,
        label="tolerance at the goal",
    )
    for sign in (-1.0, 1.0):
        bottom.axhline(
            sign * np.degrees(tolerance.yaw),
            color=style.ORANGE,
            ls="--",
            lw=1.1,
            label="tolerance at the goal" if sign > 0.0 else None,
        )
    top.set_ylabel("position error [mm]")
    bottom.set_ylabel("yaw error [deg]")
    _time_axis([top, bottom], record, "Error against the reference at the same time")
    top.set_ylim(bottom=0.0)
    return made


def tracking_figure(task: Task, plan: Plan, record: Record) -> Figure:
    """Return the tracking law's own errors: along and left of the path, and heading."""
    made, axes = style.figure(3, 5.6)
    move = series.in_phase(record, "move")
    time = record.arrays["time"]
    errors = np.where(move[:, None], record.arrays["tracking_error"], np.nan)
    names = ("along the path [mm]", "left of the path [mm]", "heading [deg]")
    for ax, name, values, color in zip(
        axes,
        names,
        (1e3 * errors[:, 0], 1e3 * errors[:, 1], np.degrees(errors[:, 2])),
        style.CYCLE,
        strict=False,
    ):
        ax.plot(*_thin(time, values), color=color)
        ax.axhline(0.0, color=style.GREY, lw=0.7)
        ax.set_ylabel(name)
        reach = max(LEAST_REACH, 1.1 * float(np.nanmax(np.abs(values), initial=0.0)))
        ax.set_ylim(-reach, reach)
    _time_axis(axes, record, "Tracking point: path minus actual")
    return made


def forces_figure(task: Task, plan: Plan, record: Record) -> Figure | None:
    """Return commanded and measured contact forces, normal and tangential, with the
    true friction cone.

    Two panels for each contact. A press is set beside its planned load, its shear
    beside the friction disc.
    """
    contacts = plan.contacts
    if not contacts:
        return None
    made, axes = style.figure(2 * len(contacts), 1.0 + 2.2 * 2 * len(contacts))
    time = record.arrays["time"]
    normals, tangents = series.contact_forces(plan, record)
    asked_n, asked_t = series.contact_forces(plan, record, "command_force")
    quiet = ~series.in_phase(record, "touch", "move", "release")
    for values in (normals, tangents):
        values[quiet] = np.nan
    for i, contact in enumerate(contacts):
        upper = axes[2 * i]
        lower = axes[2 * i + 1]
        which = f"arm {contact.arm}: " if len(task.robots) > 1 else ""
        upper.plot(*_thin(time, normals[:, i]), label="measured", **MEASURED)
        upper.plot(*_thin(time, asked_n[:, i]), label="commanded", **COMMANDED)
        edge = task.contact_friction * np.maximum(np.nan_to_num(normals[:, i]), 0.0)
        if contact.kind == "top":
            loads = _by_stretch(plan, record, partial(_load, i))
            upper.plot(
                *_thin(time, loads),
                color=style.BLACK,
                lw=1.3,
                ls=":",
                label="planned load",
            )
            upper.set_ylabel(f"{which}press [N]")
            lower.set_ylabel(f"{which}shear [N]")
            _band(
                lower,
                time,
                np.zeros_like(edge),
                edge,
                f"friction disc, mu = {task.contact_friction:g}",
            )
            lower.plot(
                *_thin(time, np.linalg.norm(tangents[:, i], axis=1)),
                label="measured",
                **MEASURED,
            )
            lower.plot(
                *_thin(time, np.linalg.norm(asked_t[:, i], axis=1)),
                label="commanded",
                **COMMANDED,
            )
        else:
            upper.set_ylabel(f"{which}normal [N]")
            lower.set_ylabel(f"{which}tangential [N]")
            _band(
                lower,
                time,
                -edge,
                edge,
                f"friction cone, mu = {task.contact_friction:g}",
            )
            lower.plot(
                *_thin(time, tangents[:, i, 0]), label="measured, left", **MEASURED
            )
            lower.plot(
                *_thin(time, asked_t[:, i, 0]), label="commanded, left", **COMMANDED
            )
            if np.nanmax(np.abs(tangents[:, i, 1]), initial=0.0) > 1e-6:
                lower.plot(
                    *_thin(time, tangents[:, i, 1]),
                    color=style.PURPLE,
                    lw=0.9,
                    label="measured, up",
                )
    _time_axis(axes, record, "Contact force of the tip on the object")
    return made


def _load(i: int, stretch: Segment) -> float:
    return stretch.contacts[i].load


def torques_figure(task: Task, plan: Plan, record: Record) -> Figure | None:
    """Return joint torques as shares of their limits; None for an engine without
    joints.
    """
    arms = [i for i in range(len(task.robots)) if f"joint_torque_{i}" in record.arrays]
    limits = {}
    for i in arms:
        facts = robot_facts(task.robots[i])
        if (
            facts is not None
            and facts.size == record.arrays[f"joint_torque_{i}"].shape[1]
        ):
            limits[i] = facts.effort_limit
    if not limits:
        return None
    made, axes = style.figure(len(limits), 0.8 + 2.5 * len(limits))
    for ax, (i, effort) in zip(axes, limits.items(), strict=True):
        shares = 100.0 * record.arrays[f"joint_torque_{i}"] / effort
        for j in range(shares.shape[1]):
            ax.plot(
                *_thin(record.arrays["time"], shares[:, j]),
                color=style.CYCLE[j % 7],
                lw=1.1,
                label=f"joint {j + 1}",
            )
        reach = 1.1 * float(np.nanmax(np.abs(shares), initial=1.0))
        if reach > 70.0:
            for sign in (-100.0, 100.0):
                ax.axhline(sign, color=style.BLACK, ls="--", lw=1.0)
        ax.set_ylim(-reach, reach)
        ax.set_ylabel(
            ("" if len(limits) == 1 else f"arm {i}: ") + "torque [% of limit]"
        )
    _time_axis(axes, record, "Joint torques")
    return made


def speeds_figure(task: Task, plan: Plan, record: Record) -> Figure:
    """Return the speed of the tracking point and the object's yaw rate."""
    made, (top, bottom) = style.figure(2, 4.4)
    time = record.arrays["time"]
    twist = record.arrays["object_twist"]
    arm = (
        series.tracked_poses(task, record)[:, :2] - record.arrays["object_pose"][:, :2]
    )
    planned = _by_stretch(
        plan,
        record,
        lambda p: (
            p.profile.cruise * series.path_length(p.path) / (p.path.length or 1.0)
        ),
    )
    speed = np.hypot(
        twist[:, 0] - twist[:, 2] * arm[:, 1], twist[:, 1] + twist[:, 2] * arm[:, 0]
    )
    top.plot(*_thin(time, 1e3 * speed), color=style.BLUE, label="tracking point")
    top.plot(
        *_thin(time, 1e3 * planned),
        color=style.ORANGE,
        ls="--",
        lw=1.1,
        label="planned cruise",
    )
    bottom.plot(*_thin(time, np.degrees(twist[:, 2])), color=style.BLUE, label="object")
    top.set_ylabel("speed [mm/s]")
    bottom.set_ylabel("yaw rate [deg/s]")
    top.set_ylim(bottom=0.0)
    _time_axis([top, bottom], record, "Speeds")
    return made


def comparison_plot(
    runs: Sequence[tuple[str, Record, Task, Plan]], *, title: str = ""
) -> Figure:
    """Return position and yaw error of several runs over the time since their motion
    began.
    """
    made, (top, bottom) = style.figure(2, 4.8)
    for (label, record, _, _), color, dash in zip(
        runs,
        (c for _ in runs for c in style.CYCLE),
        (d for d in ("-", "--", ":", "-.") for _ in style.CYCLE),
        strict=False,
    ):
        if series.ticks(record) < 2:
            continue
        time, position, yaw = timed_errors(record)
        start = time[np.argmax(series.in_phase(record, "move"))]
        top.plot(
            *_thin(time - start, 1e3 * position), color=color, ls=dash, label=label
        )
        bottom.plot(
            *_thin(time - start, np.degrees(yaw)), color=color, ls=dash, label=label
        )
    top.set_ylabel("position error [mm]")
    bottom.set_ylabel("yaw error [deg]")
    bottom.set_xlabel("time since the motion began [s]")
    bottom.axhline(0.0, color=style.GREY, lw=0.7)
    top.set_ylim(bottom=0.0)
    top.set_xlim(left=0.0)
    style.title(top, title or "Error against the reference at the same time")
    style.legend(top)
    return made


def timed_errors(record: Record) -> tuple[Array, Array, Array]:
    """Return time [s], position error [m] and signed yaw error [rad] against the
    reference at the same time.

    All (N,), NaN outside phase "move", where there is no reference to be held against.
    """
    offset = record.arrays["object_pose"] - record.arrays["reference_pose"]
    move = series.in_phase(record, "move")
    position = np.where(move, np.hypot(offset[:, 0], offset[:, 1]), np.nan)
    return (
        record.arrays["time"],
        position,
        np.where(move, series.wrap_angles(offset[:, 2]), np.nan),
    )


def _thin(time: Array, values: Array) -> tuple[Array, Array]:
    step = max(1, len(time) // MOST_POINTS)
    return time[::step], values[::step]


def _band(ax: Axes, time: Array, low: Array, high: Array, label: str) -> None:
    sampled, bottom = _thin(time, low)
    ax.fill_between(
        sampled,
        bottom,
        _thin(time, high)[1],
        color=style.GREEN,
        alpha=0.14,
        lw=0,
        label=label,
    )


def _by_stretch(plan: Plan, record: Record, value: Callable[[Segment], float]) -> Array:
    """Return at every tick (N,) of the move its stretch's value; NaN in a second
    attempt, not in the plan.
    """
    number = record.arrays["stretch"]
    out = np.full(series.ticks(record), np.nan)
    for grasp, part in series.by_grasp(plan, record):
        for i, stretch in enumerate(
            grasp.segments, start=int(part.arrays["stretch"][0])
        ):
            out[(number == i) & series.in_phase(record, "move")] = value(stretch)
    return out


def _time_axis(axes: Sequence[Axes], record: Record, title: str) -> None:
    for i, ax in enumerate(axes):
        style.shade_phases(ax, record, label=i == 0)
        style.legend(ax)
    style.title(axes[0], title, pad=18)
    axes[-1].set_xlabel("time [s]")
