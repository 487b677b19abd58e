"""Marks drawn over rendered pictures of a run: trace, axle, forces, cones."""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.view.canvas import Canvas, Pixel, rgba
from pushpressslide.view.drake.camera import FIELD, View, axes
from pushpressslide.view.drake.contact_marks import (
    CONE_LENGTH,
    FORCE_SCALE,
    LEAST_FORCE,
    STILL_FORCE_SCALE,
    ContactMarks,
    Disc,
)
from pushpressslide.view.drake.marks import PIN_ROOM
from pushpressslide.view.drake.playback import Playback
from pushpressslide.view.drake.sight import Moment, are_seen
from pushpressslide.view.drake.subject import blocks_at

BLUE = rgba("#0072b2")
WHITE = rgba("#ffffff")
PURPLE = rgba("#a8387d")
ORANGE = rgba("#d55e00")
CONE = rgba("#e69f00", 0.4)
CONE_EDGE = rgba("#e69f00")
CORNERS = 48  # of a disc
TRACE_STEP = 20  # ticks between points of the trace


class Overlay:
    """Draws the marks of a run over its pictures, unoccluded."""

    def __init__(
        self,
        playback: Playback,
        view: View,
        size: tuple[int, int],
        small: bool = False,
    ) -> None:
        """Prepare the marks for pictures of ``size`` [pixels] from ``view``.

        For pictures that are shown ``small``, they are bold and have longer forces.
        """
        nearer = view.position - view.target
        largest = STILL_FORCE_SCALE if small else FORCE_SCALE
        self.contacts = ContactMarks(playback, nearer, largest)
        self._arrow_width = 9.0 if small else 4.0  # [pixels]
        self._playback = playback
        self._frame = playback.task.support.frame
        self._position = view.position
        self._axes = axes(view.position - view.target)
        self._size = size
        ticks = range(0, len(playback.record.arrays["time"]), TRACE_STEP)
        self._trace = [self._on_support(tick) for tick in ticks]
        self._trace_pixels = [self.pixel(point) for point in self._trace]
        eye = self._frame.coordinates(tuple(view.position.tolist()))
        self._eye = np.array(eye)
        self._stretch = playback.record.arrays["stretch"][::TRACE_STEP]

    def pixel(self, point: Vector3) -> Pixel:
        """Pixel of a point (x, y, height) [m] in the support's frame."""
        offset = np.array(self._frame.point(point)) - self._position
        right, down, ahead = (float(offset @ axis) for axis in self._axes)
        width, height = self._size
        zoom = 0.5 * height / math.tan(0.5 * FIELD) / ahead
        return 0.5 * width + zoom * right, 0.5 * height + zoom * down

    def draw(self, canvas: Canvas, tick: int) -> None:
        """Draw the marks of a tick."""
        self._draw_trace(canvas, tick)
        for arm in self.contacts.arms:
            cone = self.contacts.cone(arm, tick)
            if cone is not None:
                self._draw_cone(canvas, *cone)
        for arm in self.contacts.pressing:
            disc = self.contacts.disc(arm, tick)
            if disc is not None:
                self._draw_disc(canvas, disc)
        self._draw_axle(canvas, tick)
        arrows = [(self.contacts.push(a, tick), PURPLE) for a in self.contacts.arms]
        arrows += [
            (self.contacts.press(a, tick), ORANGE) for a in self.contacts.pressing
        ]
        for arrow, color in arrows:
            if arrow.size > LEAST_FORCE:
                ends = (self._pixel_of(arrow.tail), self._pixel_of(arrow.head))
                canvas.arrow(*ends, color, self._arrow_width)

    def _pixel_of(self, point: Array) -> Pixel:
        x, y, z = (float(v) for v in point)
        return self.pixel((x, y, z))

    def _on_support(self, tick: int) -> Vector3:
        """Position of the tracking point on the support [m]."""
        X_WV = self._playback.vehicle_pose(tick)
        return X_WV.x, X_WV.y, 0.0

    def _draw_trace(self, canvas: Canvas, tick: int) -> None:
        """Draw the part of the tracking point's trace so far that the object does not
        hide, segment by segment.
        """
        count = tick // TRACE_STEP + 1
        moment = Moment((), blocks_at(self._playback, tick)[:1], ())
        points = np.array(self._trace[:count])
        towards = self._eye - points
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        seen = are_seen(moment, points, towards).tolist()
        line: list[Pixel] = []
        before = self._stretch[0]
        for pixel, number, visible in zip(
            self._trace_pixels, self._stretch, seen, strict=False
        ):
            if not visible or number != before:
                canvas.line(line, BLUE, 3.0)
                line = []
            before = number
            if visible:
                line.append(pixel)
        canvas.line(line, BLUE, 3.0)

    def _draw_axle(self, canvas: Canvas, tick: int) -> None:
        """Draw the pin at the tracking point."""
        X_WV = self._playback.vehicle_pose(tick)
        top = self.contacts.height + PIN_ROOM
        low = self.pixel((X_WV.x, X_WV.y, self.contacts.height))
        high = self.pixel((X_WV.x, X_WV.y, top))
        canvas.line((low, high), BLUE, 4.0)
        canvas.dot(high, 6.0, WHITE, BLUE)

    def _draw_cone(self, canvas: Canvas, apex: Pose2, height: float) -> None:
        half = self.contacts.friction * CONE_LENGTH
        corners = ((0.0, 0.0), (CONE_LENGTH, half), (CONE_LENGTH, -half))
        points = [self.pixel((*apex.apply(corner), height)) for corner in corners]
        canvas.polygon(points, CONE, CONE_EDGE, 1.5)

    def _draw_disc(self, canvas: Canvas, disc: Disc) -> None:
        angles = (2.0 * math.pi * i / CORNERS for i in range(CORNERS))
        points = [
            self.pixel(
                (
                    disc.x + disc.radius * math.cos(a),
                    disc.y + disc.radius * math.sin(a),
                    disc.height,
                )
            )
            for a in angles
        ]
        canvas.polygon(points, CONE, CONE_EDGE, 1.5)
