"""Figures of a run over time: errors, forces, joint torques, speeds.

One further figure compares the errors of several runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.record import Record
from pushpressslide.core.scene import arm_title
from pushpressslide.core.task import Robot
from pushpressslide.report import series, style
from pushpressslide.report.arm_metrics import facts_if_readable
from pushpressslide.report.axle_figures import axle_over_time
from pushpressslide.report.plane import path_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# [mm], [deg] that an axis of errors spans at least, so that a trifle does not fill it
LEAST_SPAN = 0.1
EMPTY = 1e-3  # [mm], [deg], [deg/s] a curve that stays below it has no panel
HIGH_TORQUE = 70.0  # [% of the limit] above which the limits are drawn too
LEAST_UPWARD_FORCE = 1e-6  # [N] above which the upward component is drawn
MEASURED: dict[str, Any] = {"color": style.BLUE}
COMMANDED: dict[str, Any] = {"color": style.ORANGE, "lw": 1.0, "ls": "--"}
TOLERANCE: dict[str, Any] = {"color": style.ORANGE, "ls": "--", "lw": 1.1}


def figures(plan: Plan, record: Record) -> dict[str, Figure]:
    """All figures for which the record has data, by name, in page order."""
    if series.ticks(record) < 2:
        return {}
    made: dict[str, Figure | None] = {
        "path": path_figure(plan, record),
        "errors": errors_figure(plan, record),
        "tracking": tracking_figure(plan, record),
    }
    placements = series.by_placement(plan, record)
    for i, (placement, part) in enumerate(placements):
        number = f"-{i + 1}" if len(placements) > 1 else ""
        made[f"axle{number}"] = axle_over_time(placement, part)
        made[f"forces{number}"] = forces_figure(placement, part)
    made["torques"] = torques_figure(plan, record)
    made["speeds"] = speeds_figure(plan, record)
    return {name: figure for name, figure in made.items() if figure is not None}


def errors_figure(plan: Plan, record: Record) -> Figure:
    """Position and yaw error over time, with the goal's tolerance.

    The errors are relative to the reference at the same time.
    """
    made, (top, bottom) = style.figure(2, 4.6)
    time, position, yaw = series.timed_errors(record)
    top.plot(*style.thin(time, 1e3 * position), color=style.BLUE, label="object")
    bottom.plot(*style.thin(time, np.degrees(yaw)), color=style.BLUE, label="object")
    label = "tolerance at the goal"
    tolerance = np.degrees(plan.task.tolerance.yaw)
    top.axhline(1e3 * plan.task.tolerance.position, label=label, **TOLERANCE)
    bottom.axhline(-tolerance, **TOLERANCE)
    bottom.axhline(tolerance, label=label, **TOLERANCE)
    top.set_ylabel("position error [mm]")
    bottom.set_ylabel("yaw error [deg]")
    style.time_axis(
        [top, bottom], record, "Error against the reference at the same time"
    )
    top.set_ylim(bottom=0.0)
    return made


def tracking_figure(plan: Plan, record: Record) -> Figure | None:
    """Errors of the tracking law: along the path, to the left of it, and in heading.

    Errors that are always zero are omitted. None if all are.
    """
    move = series.in_phase(record, "move")
    time = record.arrays["time"]
    errors = np.where(move[:, None], record.arrays["tracking_error"], np.nan)
    along, left, heading = errors.T
    panels = [
        (name, values, color)
        for name, values, color in (
            ("along the path [mm]", 1e3 * along, style.BLUE),
            ("left of the path [mm]", 1e3 * left, style.ORANGE),
            ("heading [deg]", np.degrees(heading), style.GREEN),
        )
        if np.nanmax(np.abs(values), initial=0.0) > EMPTY
    ]
    if not panels:
        return None
    made, axes = style.figure(len(panels), 1.0 + 1.55 * len(panels))
    for ax, (name, values, color) in zip(axes, panels, strict=True):
        ax.plot(*style.thin(time, values), color=color)
        ax.axhline(0.0, color=style.GREY, lw=0.7)
        ax.set_ylabel(name)
        span = max(LEAST_SPAN, 1.1 * float(np.nanmax(np.abs(values))))
        ax.set_ylim(-span, span)
    style.time_axis(axes, record, "Tracking point: path minus actual")
    return made


@dataclass(frozen=True, slots=True)
class ContactForces:
    """Forces (N,) [N] of one contact over time, NaN before and after the contact."""

    name: str  # of the arm, put before the labels; empty if there is only one
    time: Array  # [s]
    normal: Array  # measured
    tangent: Array  # (N, 2) measured
    commanded_normal: Array
    commanded_tangent: Array  # (N, 2)
    planned_load: Array
    friction: float  # coefficient of tip and object, true

    @property
    def max_friction(self) -> Array:
        """Largest tangential force (N,) [N] that the measured normal force allows."""
        return np.asarray(self.friction * np.maximum(np.nan_to_num(self.normal), 0.0))


def forces_figure(plan: Plan, record: Record) -> Figure | None:
    """Commanded and measured contact forces with the true friction cone.

    Each contact has two panels, for the normal and the tangential force. A press is
    compared with its planned load, and its shear with the friction disc. None for a
    plan without contacts.
    """
    contacts = plan.contacts
    if not contacts:
        return None
    made, axes = style.figure(2 * len(contacts), 1.0 + 2.2 * 2 * len(contacts))
    normals, tangents = series.contact_forces(plan, record)
    asked_normals, asked_tangents = series.contact_forces(plan, record, "command_force")
    quiet = ~series.in_phase(record, "touch", "move", "release")
    normals[quiet] = np.nan
    tangents[quiet] = np.nan
    for i, contact in enumerate(contacts):
        forces = ContactForces(
            f"{arm_title(contact.arm)}: " if len(plan.task.robots) > 1 else "",
            record.arrays["time"],
            normals[:, i],
            tangents[:, i],
            asked_normals[:, i],
            asked_tangents[:, i],
            _by_segment(plan, record, partial(_load, i)),
            plan.task.contact_friction,
        )
        draw = _draw_press if contact.kind == "top" else _draw_push
        draw(axes[2 * i], axes[2 * i + 1], forces)
    style.time_axis(axes, record, "Contact force of the tip on the object")
    return made


def _draw_normal(ax: Axes, forces: ContactForces, label: str) -> None:
    ax.plot(*style.thin(forces.time, forces.normal), label="measured", **MEASURED)
    asked = style.thin(forces.time, forces.commanded_normal)
    ax.plot(*asked, label="commanded", **COMMANDED)
    ax.set_ylabel(f"{forces.name}{label} [N]")


def _draw_press(upper: Axes, lower: Axes, forces: ContactForces) -> None:
    """Draw press and shear of a top contact."""
    time = forces.time
    _draw_normal(upper, forces, "press")
    load = style.thin(time, forces.planned_load)
    upper.plot(*load, color=style.BLACK, lw=1.3, ls=":", label="planned load")
    lower.set_ylabel(f"{forces.name}shear [N]")
    limit = forces.max_friction
    label = f"friction disc, mu = {forces.friction:g}"
    _band(lower, time, np.zeros_like(limit), limit, label)
    for tangent, label, options in (
        (forces.tangent, "measured", MEASURED),
        (forces.commanded_tangent, "commanded", COMMANDED),
    ):
        shear = np.linalg.norm(tangent, axis=1)
        lower.plot(*style.thin(time, shear), label=label, **options)


def _draw_push(upper: Axes, lower: Axes, forces: ContactForces) -> None:
    """Draw the normal and the tangential force of a side contact."""
    time = forces.time
    _draw_normal(upper, forces, "normal")
    lower.set_ylabel(f"{forces.name}tangential [N]")
    limit = forces.max_friction
    _band(lower, time, -limit, limit, f"friction cone, mu = {forces.friction:g}")
    left, up = forces.tangent.T
    asked = forces.commanded_tangent[:, 0]
    lower.plot(*style.thin(time, left), label="measured, left", **MEASURED)
    lower.plot(*style.thin(time, asked), label="commanded, left", **COMMANDED)
    if np.nanmax(np.abs(up), initial=0.0) > LEAST_UPWARD_FORCE:
        shown = style.thin(time, up)
        lower.plot(*shown, color=style.PURPLE, lw=0.9, label="measured, up")


def _load(i: int, segment: Segment) -> float:
    return segment.contacts[i].load


def torques_figure(plan: Plan, record: Record) -> Figure | None:
    """Joint torques as shares of their limits. None if the record has no joints."""
    shares = _torque_shares(plan.task.robots, record)
    if not shares:
        return None
    made, axes = style.figure(len(shares), 0.8 + 2.5 * len(shares))
    for ax, (arm, values) in zip(axes, shares.items(), strict=True):
        for j, share in enumerate(values.T):
            ax.plot(
                *style.thin(record.arrays["time"], share),
                color=style.CYCLE[j % len(style.CYCLE)],
                lw=1.1,
                label=f"joint {j + 1}",
            )
        span = 1.1 * float(np.nanmax(np.abs(values), initial=1.0))
        if span > HIGH_TORQUE:
            for limit in (-100.0, 100.0):
                ax.axhline(limit, color=style.BLACK, ls="--", lw=1.0)
        ax.set_ylim(-span, span)
        name = f"{arm_title(arm)}: " if len(shares) > 1 else ""
        ax.set_ylabel(f"{name}share of the limit [%]")
    style.time_axis(axes, record, "Joint torques, as shares of their limits")
    return made


def _torque_shares(robots: Sequence[Robot], record: Record) -> dict[int, Array]:
    """Torques (N, J) [% of the limit] of each arm whose limits are known."""
    shares = {}
    for i, robot in enumerate(robots):
        torque = record.arrays.get(f"joint_torque_{i}")
        if torque is None:
            continue
        facts = facts_if_readable(robot)
        if facts is not None and facts.size == torque.shape[1]:
            shares[i] = 100.0 * torque / facts.effort_limit
    return shares


def speeds_figure(plan: Plan, record: Record) -> Figure:
    """Speed of the tracking point, and the object's yaw rate if it turns."""
    time = record.arrays["time"]
    vx, vy, w = record.arrays["object_twist"].T
    tracked = series.tracked_poses(plan.task.scene.body, record)[:, :2]
    x, y = (tracked - record.arrays["object_pose"][:, :2]).T
    speed = np.hypot(vx - w * y, vy + w * x)
    planned = _by_segment(plan, record, _cruise)
    rate = np.degrees(w)
    turns = np.nanmax(np.abs(rate), initial=0.0) > EMPTY
    count = 2 if turns else 1
    made, axes = style.figure(count, 0.8 + 1.8 * count)
    top = axes[0]
    top.plot(*style.thin(time, 1e3 * speed), color=style.BLUE, label="tracking point")
    top.plot(*style.thin(time, 1e3 * planned), label="planned cruise", **TOLERANCE)
    top.set_ylabel("speed [mm/s]")
    top.set_ylim(bottom=0.0)
    if turns:
        axes[1].plot(*style.thin(time, rate), color=style.BLUE, label="object")
        axes[1].set_ylabel("yaw rate [deg/s]")
    style.time_axis(axes, record, "Speeds")
    return made


def _cruise(segment: Segment) -> float:
    """Planned speed [m/s] of the tracking point. 0 for a path without length."""
    path = segment.path
    return segment.profile.cruise * path.distance / (path.length or 1.0)


def comparison_plot(runs: Sequence[tuple[str, Record]], *, title: str = "") -> Figure:
    """Figure of the errors of several runs, over the time since their motion began."""
    made, (top, bottom) = style.figure(2, 4.8)
    looks = ((c, dash) for dash in ("-", "--", ":", "-.") for c in style.CYCLE)
    for (label, record), (color, dash) in zip(runs, looks, strict=False):
        if series.ticks(record) < 2:
            continue
        time, position, yaw = series.timed_errors(record)
        start = time[np.argmax(series.in_phase(record, "move"))]
        look: dict[str, Any] = {"color": color, "ls": dash, "label": label}
        top.plot(*style.thin(time - start, 1e3 * position), **look)
        bottom.plot(*style.thin(time - start, np.degrees(yaw)), **look)
    top.set_ylabel("position error [mm]")
    bottom.set_ylabel("yaw error [deg]")
    bottom.set_xlabel("time since the motion began [s]")
    bottom.axhline(0.0, color=style.GREY, lw=0.7)
    top.set_ylim(bottom=0.0)
    top.set_xlim(left=0.0)
    style.title(top, title or "Error against the reference at the same time")
    style.legend(top)
    return made


def _band(ax: Axes, time: Array, low: Array, high: Array, label: str) -> None:
    sampled, bottom = style.thin(time, low)
    _, top = style.thin(time, high)
    look: dict[str, Any] = {"color": style.GREEN, "alpha": 0.14, "lw": 0}
    ax.fill_between(sampled, bottom, top, label=label, **look)


def _by_segment(plan: Plan, record: Record, value: Callable[[Segment], float]) -> Array:
    """Value (N,) of the followed segment at every tick of the move.

    NaN in a second attempt, whose segments are not in the plan.
    """
    number = record.arrays["stretch"]
    out = np.full(series.ticks(record), np.nan)
    for placement, part in series.by_placement(plan, record):
        for i, segment in enumerate(
            placement.segments, start=int(part.arrays["stretch"][0])
        ):
            out[(number == i) & series.in_phase(record, "move")] = value(segment)
    return out
