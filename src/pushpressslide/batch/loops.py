"""The name that ``batch.fast`` had before."""

from __future__ import annotations

import warnings
from contextlib import AbstractContextManager

from pushpressslide.batch import fast


def by_numpy() -> AbstractContextManager[None]:
    """Run batches inside as if numba were not installed."""
    warnings.warn(
        "pushpressslide.batch.loops.by_numpy is deprecated; call "
        "pushpressslide.batch.fast.without_numba",
        DeprecationWarning,
        stacklevel=2,
    )
    return fast.without_numba()
