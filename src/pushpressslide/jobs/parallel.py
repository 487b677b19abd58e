"""Several pieces of work in processes of their own."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Hashable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import TypeVar

from pushpressslide.jobs.interrupt import blocked_for_children

Key = TypeVar("Key", bound=Hashable)
Result = TypeVar("Result")
Progress = Callable[[int, int], None]


def in_parallel(
    work: Mapping[Key, Callable[[], Result]],
    jobs: int,
    progress: Progress | None = None,
) -> dict[Key, Result]:
    """Do every piece of ``work`` and return the results by their keys, in order.

    At most ``jobs`` pieces are done at a time.

    ``progress`` is told how many are done, of how many. What one raises is raised; on
    that, and on Ctrl-C, the others are ended.
    """
    results: dict[Key, Result] = {}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(max(1, min(jobs, len(work))), mp_context=context) as pool:
        with blocked_for_children():
            waiting = {pool.submit(piece): key for key, piece in work.items()}
        try:
            for future in as_completed(waiting):
                results[waiting[future]] = future.result()
                if progress is not None:
                    progress(len(results), len(work))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                process.terminate()
            raise
    return {key: results[key] for key in work}
