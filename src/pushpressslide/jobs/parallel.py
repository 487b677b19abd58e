"""Jobs in separate processes."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Hashable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import connection
from threading import Event, Thread
from typing import TypeVar

from pushpressslide.jobs.interrupt import blocked_for_children

Key = TypeVar("Key", bound=Hashable)
Result = TypeVar("Result")
Progress = Callable[[int, int], None]


@contextmanager
def worker_pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Open a pool of processes, which end at once if the block raises.

    If ``processes`` is 0, there is one per core.
    """
    context = multiprocessing.get_context("spawn")
    count = processes or os.cpu_count() or 1
    with ProcessPoolExecutor(
        count, mp_context=context, initializer=end_with_parent
    ) as pool:
        ended = Event()
        _hushed(pool, ended)
        try:
            yield pool
        except BaseException:
            ended.set()
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                # its work is lost
                process.terminate()
            raise


def _hushed(pool: ProcessPoolExecutor, ended: Event) -> None:
    """Silence a pool's errors about jobs that it cannot hand out, once it has
    ``ended``.

    The pool's thread that hands out jobs may find the pipe to the workers closed, and
    would then print a traceback. Python has no public way to prevent this. The thread
    reads its error function when it starts, so the function is replaced before the
    first job is submitted.
    """
    queue = getattr(pool, "_call_queue", None)
    say = getattr(queue, "_on_queue_feeder_error", None)
    if queue is None or say is None:
        return

    def say_while_running(error: Exception, item: object) -> None:
        """Report an error of a pool that has not ended."""
        if not ended.is_set():
            say(error, item)

    queue._on_queue_feeder_error = say_while_running


def end_with_parent() -> None:
    """Let this process end as soon as its parent does, even if the parent is killed."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch(sentinel: int) -> None:
        """Wait for the end of the parent, which closes its side of a pipe."""
        connection.wait([sentinel])
        os._exit(1)  # nobody is left to tell, and nothing to write

    Thread(target=watch, args=(parent.sentinel,), daemon=True).start()


def in_parallel(
    work: Mapping[Key, Callable[[], Result]],
    jobs: int,
    progress: Progress | None = None,
) -> dict[Key, Result]:
    """Do every job of ``work`` and return the results by their keys, in order.

    At most ``jobs`` run at a time. ``progress`` receives the number of finished jobs
    and the total. An exception in a job is raised again. On an exception, and on
    Ctrl-C, the other jobs are ended.
    """
    results: dict[Key, Result] = {}
    with worker_pool(max(1, min(jobs, len(work)))) as pool:
        with blocked_for_children():
            waiting = {pool.submit(piece): key for key, piece in work.items()}
        for future in as_completed(waiting):
            results[waiting[future]] = future.result()
            if progress is not None:
                progress(len(results), len(work))
    return {key: results[key] for key in work}
