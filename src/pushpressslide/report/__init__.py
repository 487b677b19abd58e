"""Results of a run: figures, files, plots and pages.

All of these are derived only from task, plan and record. ``pps.report(folder)`` is both
this package and the function that writes a page.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType


class _Report(ModuleType):
    """This package as a callable. Once imported, it hides the function of the same name
    in the parent package and takes its place.
    """

    def __call__(
        self, dirs: str | Path | Sequence[str | Path], out: str | Path | None = None
    ) -> Path:
        """Write the page of finished runs, as ``report.page.write_report`` does."""
        from pushpressslide.report.page import write_report

        return write_report(dirs, out)


sys.modules[__name__].__class__ = _Report
