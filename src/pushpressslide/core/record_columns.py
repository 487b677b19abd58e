"""Names of a record's columns, for data frames and CSV files.

A name consists of body and quantity: ``object_x``, ``tip0_fx``, ``arm0_joint3_torque``.
Values are in SI units and radians, and NaN if missing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from pushpressslide.core.control import PHASES

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

POSE = ("x", "y", "yaw")
WRENCH = ("fx", "fy", "tau")
FORCE = ("fx", "fy", "fz")
POINT = ("x", "y", "z")
POSE_3D = ("qw", "qx", "qy", "qz", "x", "y", "z")

VECTORS: dict[str, tuple[str, Sequence[str]]] = {
    "object_pose": ("object", POSE),
    "object_twist": ("object", ("vx", "vy", "yaw_rate")),
    "object_pose_3d": ("object_3d", POSE_3D),
    "reference_pose": ("reference", POSE),
    "vehicle_frame": ("vehicle", POSE),
    "tracking_error": ("tracking_error", ("along", "left", "heading")),
    "wanted_wrench": ("wanted", WRENCH),
    "allocated_wrench": ("allocated", WRENCH),
}
"""First and last parts of the column names of an array (N, k)."""

TIPS: dict[str, tuple[str, Sequence[str]]] = {
    "tip_position": ("", POINT),
    "measured_force": ("", FORCE),
    "command_force": ("command_", FORCE),
    "demanded_force": ("demanded_", FORCE),
    "tip_reference": ("reference_", POINT),
    "contact_point": ("contact_", POINT),
}
"""Last parts of the column names of an array (N, A, 3), after ``tip0_``."""


def named_columns(
    arrays: Mapping[str, NDArray[np.float64]],
) -> dict[str, NDArray[np.float64] | list[str]]:
    """Columns of a record's per-tick arrays, by name.

    ``time`` is the first; phases are words.
    """
    ticks = len(arrays["time"])
    columns: dict[str, NDArray[np.float64] | list[str]] = {"time": arrays["time"]}
    for name, values in arrays.items():
        if len(values) != ticks or name == "time":
            continue
        if name == "phase":
            columns[name] = [PHASES[int(phase)] for phase in values]
            continue
        flat = values.reshape(ticks, -1)
        columns |= dict(zip(_names(name, values.shape[1:]), flat.T, strict=True))
    return columns


def _names(array: str, shape: tuple[int, ...]) -> list[str]:
    """Names of the columns of an array whose rows have the given ``shape``."""
    if array in VECTORS:
        first, ends = VECTORS[array]
        return [f"{first}_{end}" for end in ends]
    if array in TIPS:
        middle, ends = TIPS[array]
        return [f"tip{arm}_{middle}{end}" for arm in range(shape[0]) for end in ends]
    if array.startswith("body_"):
        return [f"{array}_{end}" for end in POSE_3D]
    joint = re.fullmatch(r"joint_(\w+)_(\d+)", array)
    if joint:
        quantity, arm = joint.groups()
        return [f"arm{arm}_joint{i + 1}_{quantity}" for i in range(shape[0])]
    share = re.fullmatch(r"(\w+_share)_(\d+)", array)
    if share:
        return [f"arm{share.group(2)}_{share.group(1)}"]
    if not shape:
        return [array]
    return [f"{array}_{i}" for i in range(shape[0])]
