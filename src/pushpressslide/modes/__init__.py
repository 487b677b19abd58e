"""The library of contact modes: one file per contact topology.

To add a mode, add its file here. ``base`` and the folder ``shared`` are not modes.
"""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING, Any

from pushpressslide.modes.base import Mode

if TYPE_CHECKING:  # so that type checkers, too, find them as attributes
    from pushpressslide.modes import bimanual_press_slide as bimanual_press_slide
    from pushpressslide.modes import orthogonal_push as orthogonal_push
    from pushpressslide.modes import parallel_push as parallel_push
    from pushpressslide.modes import press_and_push as press_and_push
    from pushpressslide.modes import press_slide as press_slide
    from pushpressslide.modes import rear_push as rear_push


def discovered() -> dict[str, Mode[Any]]:
    """Modes in all files on this package's path, by name."""
    modes: dict[str, Mode[Any]] = {}
    for info in pkgutil.iter_modules(__path__):
        if info.ispkg or info.name == "base":
            continue
        mode: Mode[Any] = importlib.import_module(f"{__name__}.{info.name}").MODE
        modes[mode.name] = mode
    return modes


MODES: dict[str, Mode[Any]] = discovered()
"""Every mode by its name."""


def __dir__() -> list[str]:
    return ["MODES", *sorted(MODES)]
