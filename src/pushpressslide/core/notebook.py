"""Rich display of plans, records and results in a notebook.

The pictures are made in ``jobs.notebook``. Because that is a higher layer, its
functions are looked up by name when needed.
"""

from __future__ import annotations

import importlib
from typing import Any

MAKERS = "pushpressslide.jobs.notebook"


def html_of(thing: Any, maker: str) -> str:
    """HTML of an object, made by the function ``maker``."""
    made: str = getattr(importlib.import_module(MAKERS), maker)(thing)
    return made
