"""Supports in the task file. A new kind of support needs only one more row in this
file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.task import Support
from pushpressslide.taskfile.layouts import Stand
from pushpressslide.taskfile.place import Fault
from pushpressslide.taskfile.shapes import polygon_faults


@dataclass(frozen=True, slots=True)
class SupportKind:
    """Fields in the file for a kind of support, and the frame of the support in the
    world.
    """

    needs: tuple[str, ...]  # required fields
    takes: tuple[str, ...]  # allowed fields
    # frame from pose and angle [rad]
    frame: Callable[[Stand | None, float], SupportFrame]
    stand: Callable[[SupportFrame], Stand | None]  # the pose of a frame


def _table(stand: Stand | None, angle: float) -> SupportFrame:
    return TABLE


def _wall(stand: Stand | None, angle: float) -> SupportFrame:
    return TABLE if stand is None else SupportFrame.of_wall(stand[:3], stand.yaw)


def _incline(stand: Stand | None, angle: float) -> SupportFrame:
    return SupportFrame.of_incline(angle)


def _no_stand(frame: SupportFrame) -> None:
    return None


def _stand_of_wall(frame: SupportFrame) -> Stand:
    return Stand(*frame.origin, math.atan2(frame.axes[1][2], frame.axes[0][2]))


KINDS = {
    "table": SupportKind((), ("region",), _table, _no_stand),
    "wall": SupportKind(("pose",), ("pose", "opening"), _wall, _stand_of_wall),
    "incline": SupportKind(("angle_deg",), ("angle_deg",), _incline, _no_stand),
}


def support_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield faults for missing fields of the support's kind, and for fields of another
    kind.
    """
    name = plain["kind"]
    kind = KINDS[name]
    for key in ("pose", "opening", "angle_deg", "region"):
        path = f"support.{key}"
        value = plain[key]
        if value is not None and key not in kind.takes:
            owners = " or ".join(n for n, owner in KINDS.items() if key in owner.takes)
            allowed = f"allowed for a {name}: leave {path} out"
            article = "an" if owners[0] in "aeiou" else "a"
            yield path, value, f"only {article} {owners} has one; {allowed}"
        if value is None and key in kind.needs:
            yield path, None, f"it is missing; allowed: the {key} of the {name}"
    if plain["region"] is not None:
        yield from polygon_faults("support.region", plain["region"])


def make_support(kind: Any, frame: Stand | None, **others: Any) -> Support:
    """Support from the file's fields. By default it is a table."""
    place = KINDS[kind].frame(frame, others.get("angle") or 0.0)
    return Support(kind=kind, frame=place, **others)


def support_fields(support: Support) -> dict[str, Any]:
    """Fields in the file for a support, without those that its kind does not have."""
    fields: dict[str, Any] = {"kind": support.kind, "friction": support.friction}
    if support.kind not in KINDS:
        return fields
    stand = KINDS[support.kind].stand(support.frame)
    shown: dict[str, Any] = {
        "frame": stand,
        "opening": support.opening,
        "angle": support.angle,
    }
    shown["region"] = support.region
    return fields | {name: value for name, value in shown.items() if value is not None}
