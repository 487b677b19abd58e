"""The library of contact modes: one file per contact topology. A mode is added by
adding its file here; ``base`` and the folder ``shared`` are none.
"""

from __future__ import annotations

import importlib
import pkgutil

from pushpressslide.modes.base import Mode


def discovered() -> dict[str, Mode]:
    """Return the modes of all files on this package's path, by name."""
    modes: dict[str, Mode] = {}
    for info in pkgutil.iter_modules(__path__):
        if info.ispkg or info.name == "base":
            continue
        mode: Mode = importlib.import_module(f"{__name__}.{info.name}").MODE
        modes[mode.name] = mode
    return modes


MODES: dict[str, Mode] = discovered()
"""Every mode by its name."""
