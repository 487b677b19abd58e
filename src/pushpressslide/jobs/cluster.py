"""Jobs on the machines of a Dask cluster; the extra ``cluster``."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import NamedTuple

from pushpressslide.core.errors import PushPressSlideError

PATIENCE = 10.0  # [s] time for a scheduler to answer
# largest number of restarts of a job lost with its worker
LOST = 5


class Cluster(NamedTuple):
    """Pool to which jobs are submitted."""

    pool: Executor
    processes: int  # pieces that are done at a time


@contextmanager
def cluster(address: str) -> Iterator[Cluster]:
    """Open the pool of the cluster whose scheduler is at ``address``, such as
    ``tcp://10.0.0.1:8786``.

    This package must be installed on the workers. Jobs of a lost worker are repeated by
    another worker. Raises PushPressSlideError if ``distributed`` is not installed, if
    no scheduler answers, and if there are no workers.
    """
    try:
        distributed = importlib.import_module("distributed")
    except ModuleNotFoundError:
        raise PushPressSlideError(
            "--cluster: distributed is not installed: "
            "pip install 'pushpressslide[cluster]'"
        ) from None
    settings = importlib.import_module("dask.config")
    try:
        client = distributed.Client(address, timeout=PATIENCE)
    except (OSError, TimeoutError, ValueError) as error:
        first = str(error).splitlines()[0]
        raise PushPressSlideError(
            f"--cluster: no scheduler answers at {address!r}: {first}"
        ) from None
    with client, settings.set({"distributed.scheduler.allowed-failures": LOST}):
        processes = sum(client.nthreads().values())
        if processes == 0:
            raise PushPressSlideError(
                f"--cluster: the scheduler at {address!r} has no workers"
            )
        with client.get_executor(pure=False) as pool:
            yield Cluster(pool, processes)
