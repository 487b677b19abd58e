"""Ctrl-C as a request that a run grants at its next tick, to keep its recording."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, raised after the finished part has been stored. The message says where."""


ENDINGS = (signal.SIGINT, signal.SIGTERM)
"""Ctrl-C, and the request to terminate, which counts as Ctrl-C."""


class Interrupt:
    """Ctrl-C, or a request to terminate, as a condition that a loop polls.

    A second Ctrl-C interrupts at once.
    """

    def __init__(self) -> None:
        self._asked = False

    def __call__(self) -> bool:
        """Whether Ctrl-C was pressed while it was held back."""
        return self._asked

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True

    @contextmanager
    def defer(self) -> Iterator[None]:
        """Hold Ctrl-C back inside the block. Works only in the main thread, since other
        threads get no signals.
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
    """Hide Ctrl-C from processes that are started inside the block. A Ctrl-C inside the
    block takes effect at its end.
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
    does, so that open files are closed and other processes are ended.
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
