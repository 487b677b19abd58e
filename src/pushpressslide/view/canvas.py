"""Anti-aliased drawing on a picture, by Pillow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

FINER = 2  # pixels of the drawing across a pixel of the picture
HEAD = 3.25  # length of an arrow's head over the arrow's width
INK = (31, 35, 40)

Pixel = tuple[float, float]
"""Position in a picture: right and down from the upper left corner [pixels]."""
Color = tuple[int, int, int] | tuple[int, int, int, int]
"""Red, green, blue and opacity, up to 255."""


def rgba(code: str, opacity: float = 1.0) -> Color:
    """Colour ``#rrggbb`` with an opacity up to 1."""
    r, g, b = bytes.fromhex(code.removeprefix("#"))
    return r, g, b, round(255 * opacity)


class Canvas:
    """A drawing over a picture. Coordinates and widths are in pixels of the picture."""

    def __init__(self, picture: NDArray[np.uint8]) -> None:
        """Start a drawing over ``picture`` (height, width, 3)."""
        from PIL import Image, ImageDraw

        height, width = picture.shape[:2]
        self.size = (width, height)  # [pixels]
        fine = (FINER * width, FINER * height)
        nearest = Image.Resampling.NEAREST
        self._drawing: Any = Image.fromarray(picture).resize(fine, nearest)
        # colours that are seen through are mixed with what is there
        self._draw: Any = ImageDraw.Draw(self._drawing, "RGBA")

    def image(self) -> Any:
        """Picture with the drawing, as a Pillow image."""
        return self._drawing.reduce(FINER)

    def line(self, points: Sequence[Pixel], color: Color, width: float) -> None:
        """Draw a line through ``points``."""
        if len(points) > 1:
            wide = max(1, round(FINER * width))
            self._draw.line(_fine(points), fill=color, width=wide, joint="curve")

    def dashes(self, points: Sequence[Pixel], color: Color, width: float) -> None:
        """Draw a dashed line through ``points``."""
        long = 7.0
        moved = 0.0
        for start, end in pairwise(points):
            if int(moved / long) % 2 == 0:
                self.line((start, end), color, width)
            moved += math.dist(start, end)

    def polygon(
        self, points: Sequence[Pixel], fill: Color | None, edge: Color, width: float
    ) -> None:
        """Draw a filled polygon with its edge."""
        if fill is not None:
            self._draw.polygon(_fine(points), fill=fill)
        self.line([*points, points[0]], edge, width)

    def dot(
        self, center: Pixel, radius: float, fill: Color, edge: Color | None = None
    ) -> None:
        """Draw a circle of a ``radius`` [pixels]."""
        (x, y), r = center, radius
        box = [FINER * v for v in (x - r, y - r, x + r, y + r)]
        self._draw.ellipse(box, fill=fill, outline=edge, width=FINER)

    def arrow(self, tail: Pixel, head: Pixel, color: Color, width: float) -> None:
        """Draw an arrow."""
        length = math.dist(tail, head)
        if length < 1.0:
            return
        along = ((head[0] - tail[0]) / length, (head[1] - tail[1]) / length)
        size = min(HEAD * width, 0.6 * length)
        neck = (head[0] - size * along[0], head[1] - size * along[1])
        half = 0.45 * size
        left = (neck[0] - half * along[1], neck[1] + half * along[0])
        right = (neck[0] + half * along[1], neck[1] - half * along[0])
        self.line((tail, neck), color, width)
        self._draw.polygon(_fine((head, left, right)), fill=color)

    def text(
        self, place: Pixel, text: str, size: float = 15.0, color: Color = INK
    ) -> None:
        """Write ``text`` with the upper left corner of its first line at ``place``."""
        x, y = place
        self._draw.text(
            (FINER * x, FINER * y), text, fill=color, font=_font(FINER * size)
        )

    def paste(self, other: Canvas) -> None:
        """Put another drawing, with its picture, into the upper left corner."""
        self._drawing.paste(other._drawing)

    def panel(self, corner: Pixel, end: Pixel) -> None:
        """Draw a light background for text between two corners."""
        box = [FINER * v for v in (*corner, *end)]
        self._draw.rectangle(box, fill=(255, 255, 255, 225))


def text_width(text: str, size: float = 15.0) -> float:
    """Width of a text [pixels]."""
    return float(_font(FINER * size).getlength(text)) / FINER


def _fine(points: Sequence[Pixel]) -> list[Pixel]:
    return [(FINER * x, FINER * y) for x, y in points]


@cache
def _font(size: float) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size)
