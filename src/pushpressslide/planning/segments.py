"""From a drive and a path to a segment of a plan, and how long segments take."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.drive import Drive
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Contact, MotionPath, Segment
from pushpressslide.core.task import Task
from pushpressslide.planning.overhead import overhead


def segment(
    task: Task,
    mode: str,
    contacts: Sequence[Contact],
    drive: Drive,
    path: MotionPath,
    *,
    speed: float | None = None,
    cone_margin: float | None = None,
) -> Segment:
    """Return a segment that leads to the goal of ``task``, at its speed [m/s]."""
    motion = task.motion
    profile = SpeedProfile(path.length, speed or motion.speed, motion.acceleration)
    return Segment(mode, tuple(contacts), drive, path, profile, task.goal, cone_margin)


def run_time(task: Task, segments: Sequence[Segment], pressed: bool = False) -> float:
    """Return the estimated time [s] of a run, approach and release included."""
    moving = sum(piece.profile.duration for piece in segments)
    return moving + overhead(task, pressed)
