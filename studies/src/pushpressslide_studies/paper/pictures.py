"""Pictures of a run in progress, side by side, as in the paper's figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.whole_file import whole
from pushpressslide.report import series
from pushpressslide.report.files import load_run

NAME = "pictures.png"
SHARES = (0.0, 0.33, 0.67, 1.0)  # of the contact phase
WIDTH = 400
HEIGHT = 300  # [pixel] of each
CAPTION = "at the start, a third, two thirds and the end of the contact phase; pale green: the goal."


def write_pictures(folder: Path) -> Path | None:
    """Render the run in ``folder`` into its pictures.png and return the path.

    None if nothing was in contact, or this machine cannot render.
    """
    from PIL import Image

    from pushpressslide.view.drake.frames import FrameRenderer

    run = load_run(folder)
    (ticks,) = np.nonzero(series.contact_phase(run.record))
    if len(ticks) == 0:
        return None
    first, last = run.record.arrays["time"][ticks[[0, -1]]]
    try:
        renderer = FrameRenderer(run.plan, run.record, (WIDTH, HEIGHT))
        images = [
            renderer.image(float(first + share * (last - first))) for share in SHARES
        ]
    except SimulationError:
        return None
    path = folder / NAME
    with whole(path) as temporary:
        Image.fromarray(np.hstack(images)).save(temporary, optimize=True)
    return path
