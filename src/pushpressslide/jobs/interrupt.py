"""Ctrl-C as a request that a run obeys at its next tick, so that its recording is kept."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, raised after the finished part has been stored. The message names the
    location.
    """


ENDINGS = (signal.SIGINT, signal.SIGTERM)
"""Signals of Ctrl-C and of a request to terminate, which are treated alike."""


class Interrupt:
    """Ctrl-C, or a request to terminate, as a flag that a loop polls.

    A second Ctrl-C interrupts at once.
    """

    def __init__(self) -> None:
        self._asked = False

    def __call__(self) -> bool:
        """Whether Ctrl-C was pressed while it was deferred."""
        return self._asked

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True

    @contextmanager
    def defer(self) -> Iterator[None]:
        """Defer Ctrl-C inside the block.

        It works only in the main thread, since other threads receive no signals.
        """
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = [signal.signal(ending, self._note) for ending in ENDINGS]
        try:
            yield
        finally:
            for ending, handler in zip(ENDINGS, before, strict=True):
                signal.signal(ending, handler)


@contextmanager
def blocked_for_children() -> Iterator[None]:
    """Hide Ctrl-C from processes started inside the block. A Ctrl-C in the meantime
    takes effect at the end of the block.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def terminated_as_interrupt() -> Iterator[None]:
    """Let a request to terminate raise KeyboardInterrupt inside the block, as Ctrl-C
    does.

    Open files are then closed, and other processes ended.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        """Interrupt the block."""
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
