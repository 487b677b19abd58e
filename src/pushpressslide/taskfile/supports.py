"""Supports in the task file: a kind of support is added here, in one row."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.task import Support
from pushpressslide.taskfile.layouts import Stand
from pushpressslide.taskfile.place import Fault


@dataclass(frozen=True, slots=True)
class SupportKind:
    """What a kind of support has in the file, and where it is in the world."""

    needs: tuple[str, ...]  # fields that it must have
    takes: tuple[str, ...]  # fields that it may have
    frame: Callable[[Stand], SupportFrame]
    stand: Callable[[SupportFrame], Stand | None]  # the inverse


def _wall(stand: Stand) -> SupportFrame:
    return SupportFrame.of_wall(stand[:3], stand.yaw)


def _stand_of_wall(frame: SupportFrame) -> Stand:
    return Stand(*frame.origin, math.atan2(frame.axes[1][2], frame.axes[0][2]))


KINDS = {
    "table": SupportKind((), (), lambda stand: TABLE, lambda frame: None),
    "wall": SupportKind(("pose",), ("pose", "opening"), _wall, _stand_of_wall),
}


def support_faults(plain: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what the kind of support needs and lacks, or has of another kind."""
    name = plain["kind"]
    kind = KINDS[name]
    for key in ("pose", "opening"):
        path = f"support.{key}"
        value = plain[key]
        if value is not None and key not in kind.takes:
            owners = " or ".join(n for n, owner in KINDS.items() if key in owner.takes)
            allowed = f"allowed for a {name}: leave {path} out"
            yield path, value, f"only a {owners} has one; {allowed}"
        if value is None and key in kind.needs:
            yield path, None, f"it is missing; allowed: the {key} of the {name}"


def make_support(kind: Any, frame: Stand | None, **others: Any) -> Support:
    """Return the support of the file's fields, on a table where it does not stand."""
    place = TABLE if frame is None else KINDS[kind].frame(frame)
    return Support(kind=kind, frame=place, **others)


def support_fields(support: Support) -> dict[str, Any]:
    """Return the file's fields of a support, without those that it does not have."""
    stand = KINDS[support.kind].stand(support.frame)
    fields: dict[str, Any] = {"kind": support.kind, "friction": support.friction}
    shown = {"frame": stand, "opening": support.opening}
    return fields | {name: value for name, value in shown.items() if value is not None}
