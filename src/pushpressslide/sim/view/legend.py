"""What the colours of a replay and of a video mean."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.sim.view.marks import Marks
from pushpressslide.sim.view.playback import Playback


@dataclass(frozen=True, slots=True)
class Entry:
    """A colour and what it stands for."""

    color: str  # #rrggbb
    text: str


def entries(playback: Playback, marks: Marks) -> list[Entry]:
    """Return the legend of a run."""
    goal = "goal" if len(playback.goals) == 1 else "goals"
    force = f"contact force in the plane, {1e3 * marks.scale:.0f} mm a newton"
    out = [
        Entry("#d98c40", "object"),
        Entry("#009e73", goal),
        Entry("#222222", "planned path of the tracking point"),
        Entry("#0072b2", "its trace; the pin is the virtual axle"),
        Entry("#a8387d", force),
    ]
    kinds = {c.kind for part in playback.placements for c in part.contacts}
    cones = {"side": "friction cone", "top": "friction disc"}
    names = " and ".join(cones[kind] for kind in sorted(kinds))
    if names:
        out.append(Entry("#e69f00", names))
    if marks.presses:
        press = f"press, beside its tip, {1e3 * marks.press_scale:.0f} mm a newton"
        out.append(Entry("#d55e00", press))
    return out
