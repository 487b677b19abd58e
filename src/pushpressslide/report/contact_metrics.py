"""Figures of the contacts of a run: forces, friction, losses, slip."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.control.limits import MEAN_TIME
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.twist_path import screw
from pushpressslide.report import series
from pushpressslide.rom.drives import PinnedDrive

Mask = NDArray[np.bool_]

CONE_TOLERANCE = 0.02
"""Share by which a measured tangential force may exceed mu f_n before it counts as
outside the cone.
"""


STOPPING = 0.3
"""Time [s] that arms may take to stop pressing too hard."""


def contact_figures(placements: Sequence[tuple[Plan, Record]]) -> dict[str, Any]:
    """Figures of the contacts, over all placements and for each placement.

    Shares are relative to the ticks in contact.
    """
    parts = [
        _placement_figures(placement, part)
        for placement, part in placements
        if placement.contacts
    ]
    if not parts:
        return {}
    counts = [part.pop("touching") for part in parts]
    forces = [
        part["max_normal_force"]
        for part in parts
        if part["max_normal_force"] is not None
    ]
    outside = sum(
        n * (part["cone_violation_fraction"] or 0.0)
        for n, part in zip(counts, parts, strict=True)
    )
    means = [part["mean_force"] for part in parts if part["mean_force"] is not None]
    kept = [part["kept_force"] for part in parts if part["kept_force"] is not None]
    commanded = [part.pop("commanded") for part in parts]
    return {
        "max_normal_force": max(forces, default=None),
        "max_mean_normal_force": max(means, default=None),
        "max_force_without_stop": max(kept, default=None),
        "cone_use_commanded": _commanded(commanded),
        "contact_loss_time": sum(part["contact_loss_time"] for part in parts),
        "cone_violation_fraction": outside / sum(counts) if sum(counts) else None,
        "slip_distance": sum(part["slip_distance"] for part in parts),
        "contacts": [contact for part in parts for contact in part["contacts"]],
    }


def _placement_figures(plan: Plan, record: Record) -> dict[str, Any]:
    time = record.arrays["time"]
    normals, tangents = series.contact_forces(plan, record)
    move = series.in_phase(record, "move")
    contact = series.contact_phase(record)
    pressing = series.in_phase(record, "touch", "move", "release", "done")
    felt = normals[pressing]
    kept = normals[pressing & ~_stopping(plan, record)]
    step = np.diff(time, append=time[-1])
    lost = contact[:, None] & (normals < series.CONTACT_FORCE)
    touching = move[:, None] & (normals >= series.CONTACT_FORCE)
    allowed = plan.task.contact_friction * np.maximum(normals, series.CONTACT_FORCE)
    utilisation = np.linalg.norm(tangents, axis=2) / allowed
    outside = touching & (utilisation > 1.0 + CONE_TOLERANCE)
    slips = [float(series.slip(plan, record, i)[-1]) for i in range(normals.shape[1])]
    count = int(touching.sum())
    return {
        "max_normal_force": _largest(felt),
        "mean_force": _largest_mean(felt, time),
        "kept_force": _largest_mean(kept, time),
        "commanded": _outside_commanded(plan, record, touching),
        "contact_loss_time": float(step[lost.any(axis=1)].sum()),
        "cone_violation_fraction": _mean(outside[touching]),
        "slip_distance": sum(slips),
        "touching": count,
        "contacts": [
            {
                "leg": plan.segments[0].leg,
                "arm": c.arm,
                "kind": c.kind,
                "load": c.load if c.kind == "top" else None,
                "max_normal_force": _largest(felt[:, i]),
                "mean_normal_force": _mean(normals[touching[:, i], i]),
                "mean_friction_use": _mean(utilisation[touching[:, i], i]),
                "contact_loss_time": float(step[lost[:, i]].sum()),
                "cone_violation_fraction": _mean(outside[touching[:, i], i]),
                "slip_distance": slips[i],
            }
            for i, c in enumerate(plan.contacts)
        ],
    }


def _largest_mean(forces: Array, time: Array) -> float | None:
    """Largest mean of a normal force [N] over MEAN_TIME."""
    if len(time) < 2 or not len(forces):
        return None
    period = float(np.median(np.diff(time)))
    count = max(1, round(MEAN_TIME / period))
    if len(forces) < count:
        return None
    total = np.cumsum(np.vstack([np.zeros(forces.shape[1]), forces]), axis=0)
    return float((total[count:] - total[:-count]).max() / count)


def _stopping(plan: Plan, record: Record) -> Mask:
    """Ticks in which arms stop for too much force, from the window in which it is
    noticed on.
    """
    time = record.arrays["time"]
    noticed = MEAN_TIME + plan.task.sensing.delay_of_force
    stopping = np.zeros(len(time), dtype=bool)
    for breach in record.meta.get("breaches", ()):
        if breach["code"] == "force_limit":
            since = time - breach["time"]
            stopping |= (since > -noticed) & (since < STOPPING)
    return stopping


def _outside_commanded(
    plan: Plan, record: Record, touching: Mask
) -> tuple[int, int, float]:
    """Number of ticks in contact with a commanded force outside the friction cone,
    number of all ticks in contact, and the largest excess [N].

    The commanded force is feed-forward plus servo.
    """
    if "demanded_force" not in record.arrays:
        return 0, 0, 0.0
    normals, tangents = series.contact_forces(plan, record, "demanded_force")
    asked = np.linalg.norm(tangents, axis=2)
    excess = (asked - plan.task.contact_friction * np.maximum(normals, 0.0))[touching]
    if not excess.size:
        return 0, 0, 0.0
    return int((excess > 0.0).sum()), excess.size, max(0.0, float(excess.max()))


def _commanded(parts: Sequence[tuple[int, int, float]]) -> dict[str, float] | None:
    """Share of the ticks outside the cone, and the largest excess [N]."""
    ticks = sum(count for _, count, _ in parts)
    if not ticks:
        return None
    outside = sum(count for count, _, _ in parts)
    largest = max(excess for _, _, excess in parts)
    return {"share": outside / ticks, "largest_excess": largest}


def _largest(values: Array) -> float | None:
    known = values[~np.isnan(values)]
    if not known.size:
        return None
    return float(known.max())


def _mean(values: Array) -> float | None:
    if not values.size:
        return None
    return float(values.mean())


def pivots(placements: Sequence[tuple[Plan, Record]]) -> list[dict[str, Any]]:
    """Measured centre of rotation in B [m] of each placement that pins a point, with
    three points of the plan for comparison.

    These points are the pinned point, the centre of pressure, and the virtual axle
    about which the object would turn if the press did not hold it.
    """
    out = []
    for placement, record in placements:
        drive = placement.segments[0].drive
        X_GB = placement.task.X_GB
        at = np.flatnonzero(series.contact_phase(record))
        if not isinstance(drive, PinnedDrive) or len(at) == 0:
            continue
        first, last = (
            Pose2(*map(float, record.arrays["object_pose"][i])) for i in (at[0], at[-1])
        )
        vx, vy, w = screw(first.compose(X_GB), last.compose(X_GB))
        turned = (-vy / w, vx / w)
        pinned = placement.contacts[0].point
        others = {
            "center_of_pressure": drive.pressure,
            "virtual_axle": drive.axle,
        }
        out.append(
            {
                "leg": placement.segments[0].leg,
                "turn": w,
                "turned_about": turned,
                "pressed": pinned,
                **others,
                "distance": {
                    name: math.dist(turned, point)
                    for name, point in {"pressed": pinned, **others}.items()
                },
            }
        )
    return out
