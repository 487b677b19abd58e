"""Animation of several episodes side by side, as drawn by the package gym-pusht."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.whole_file import write_whole
from pushpressslide_studies.pusht.game import Game, open_game, play

SIZE = 160  # [pixels] of one episode's picture
ACROSS = 5  # episodes in a row
PERIOD = 100  # [ms] between pictures, as in the game
REST = 15  # pictures of the end
QUALITY = 60  # of WebP
KINDS = (".webp", ".gif")
Pixels = NDArray[np.uint8]


def check_kind(path: Path) -> None:
    """Raise PushPressSlideError for an unsupported kind of file."""
    if path.suffix.lower() not in KINDS:
        raise PushPressSlideError(
            f"--video: {str(path)!r} is not allowed; allowed: a name that ends in "
            f"{' or '.join(KINDS)}"
        )


def film(seeds: Iterable[int], path: Path) -> None:
    """Play an episode for each seed, and write the episodes side by side.

    The suffix of ``path`` is one of ``KINDS``. An episode that has ended stays at its
    last picture. Raises PushPressSlideError if the package is not installed.
    """
    check_kind(path)
    game = open_game(SIZE)
    strips = [_pictures(game, seed) for seed in seeds]
    game.close()
    count = max(map(len, strips)) + REST
    pictures = [Image.fromarray(_together(strips, time)) for time in range(count)]
    kind = path.suffix[1:].upper()
    data = io.BytesIO()
    first, *others = pictures
    first.save(
        data,
        kind,
        save_all=True,
        append_images=others,
        duration=PERIOD,
        loop=0,
        quality=QUALITY,
    )
    write_whole(path, data.getvalue())


def _pictures(game: Game, seed: int) -> list[Pixels]:
    """Pictures (SIZE, SIZE, 3) of an episode."""
    pictures: list[Pixels] = []

    def watch(played: Game) -> None:
        """Add the current picture."""
        pictures.append(played.render())

    play(game, seed, watch=watch)
    return pictures


def _together(strips: list[list[Pixels]], time: int) -> Pixels:
    """Pictures of all episodes at one time, in rows of ``ACROSS``."""
    across = min(ACROSS, len(strips))
    rows = math.ceil(len(strips) / across)
    sheet = np.full((rows * SIZE, across * SIZE, 3), 255, dtype=np.uint8)
    for index, strip in enumerate(strips):
        row, column = divmod(index, across)
        picture = strip[min(time, len(strip) - 1)]
        y = row * SIZE
        x = column * SIZE
        sheet[y : y + SIZE, x : x + SIZE] = picture
    return sheet
