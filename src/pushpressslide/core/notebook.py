"""How plans, records and results show themselves in a notebook.

The pictures are made in ``jobs.notebook``, which stands above: it is looked up by name
when a notebook asks.
"""

from __future__ import annotations

import importlib
from typing import Any

MAKERS = "pushpressslide.jobs.notebook"


def html_of(thing: Any, maker: str) -> str:
    """Return what the function ``maker`` makes of a thing, as HTML."""
    made: str = getattr(importlib.import_module(MAKERS), maker)(thing)
    return made
