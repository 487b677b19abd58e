"""Monitoring and interruption of a run, and the destination of its files."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from pushpressslide.jobs.interrupt import Interrupt, Interrupted


@dataclass(frozen=True, slots=True)
class Monitor:
    """Monitoring and interruption of a run in progress."""

    # called with time and expected duration [s]
    progress: Callable[[float, float], None] | None = None
    # called with the address of a page that shows the run; engines with arms only
    live: Callable[[str], None] | None = None
    # Ctrl-C ends the run at its next tick, with reason "interrupted"; None: it raises
    interrupt: Interrupt | None = None

    def deferred_interrupt(self) -> AbstractContextManager[None]:
        """Context in which Ctrl-C waits for the next tick."""
        return nullcontext() if self.interrupt is None else self.interrupt.defer()


@dataclass(frozen=True, slots=True)
class Output:
    """Destination of a run's files."""

    folder: Path
    video: bool = False  # also write an animation
    command: str | None = None  # command that made the runs


def interrupted(out: Output | None) -> Interrupted:
    """Error of a run ended by Ctrl-C. It names the location of the run's files."""
    message = "interrupted"
    if out is not None:
        message += f"; record and result so far are in {out.folder}"
    return Interrupted(message)
