"""Marks in the scene of a replay: trace, virtual axle, forces and friction cones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Cylinder, Meshcat, MeshcatCone, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.view.drake.contact_marks import (
    CONE_LENGTH,
    LEAST_FORCE,
    Arrow,
    ContactMarks,
    Disc,
)
from pushpressslide.view.drake.lines import ribbon

TRACE_PIECES = 60  # of the trace of the tracking point
TRACE_HEIGHT = 0.0018  # [m] above the support
TRACE_WIDTH = 0.006  # [m]
LEAST_STEP = 1e-5  # [m] shorter pieces of the trace are not drawn
SHAFT = 0.004  # [m] radius of an arrow's shaft
HEAD_RADIUS = 0.010  # [m]
HEAD = 0.022  # [m] length of an arrow's head
BLUE = Rgba(0.0, 0.45, 0.70, 1.0)
WHITE = Rgba(0.95, 0.95, 0.95, 1.0)
PURPLE = Rgba(0.66, 0.22, 0.49, 1.0)
ORANGE = Rgba(0.84, 0.37, 0.0, 1.0)
CONE_COLOR = Rgba(0.90, 0.62, 0.0, 0.4)
PIN_ROOM = 0.03  # [m] of the axle's pin above the object
DISC_THICKNESS = 0.0005  # [m]


Ticks = NDArray[np.intp]


class Marks:
    """Marks in the scene, in the support's frame: trace, axle, forces and cones."""

    def __init__(self, meshcat: Meshcat, contacts: ContactMarks, ticks: Ticks) -> None:
        """Add all marks. ``ticks`` (F,) are those of the frames."""
        self._meshcat = meshcat
        self._contacts = contacts
        self._playback = contacts.playback
        self._last = len(ticks) - 1
        self._frame = self._playback.task.support.frame
        vehicle = [self._playback.vehicle_pose(tick) for tick in ticks.tolist()]
        points = np.array([(v.x, v.y) for v in vehicle])
        stretch = self._playback.record.arrays["stretch"]
        self._trace = self._draw_trace(points, stretch[ticks])
        self._pin = contacts.height + PIN_ROOM
        self._add_axle()
        for arm in contacts.arms:
            self._add_arrow(f"marks/force_{arm}", PURPLE)
            self._add_cone(f"marks/cone_{arm}")
        for arm in contacts.pressing:
            self._add_arrow(f"marks/press_{arm}", ORANGE)
            self._add_disc(f"marks/disc_{arm}")

    def _add_axle(self) -> None:
        """Add the marker of the tracking point: a pin with its head at the upper end."""
        meshcat = self._meshcat
        meshcat.SetObject("marks/axle/pin", Cylinder(0.003, self._pin), BLUE)
        meshcat.SetObject("marks/axle/head", Sphere(0.008), WHITE)
        # the marker's own z axis points into the support where axes are left-handed
        end = 0.5 * self._pin * self._frame.handedness
        meshcat.SetTransform("marks/axle/head", RigidTransform([0.0, 0.0, end]))

    def _add_arrow(self, name: str, color: Rgba) -> None:
        meshcat = self._meshcat
        meshcat.SetObject(f"{name}/shaft", Cylinder(SHAFT, 1.0), color)
        meshcat.SetObject(
            f"{name}/head/cone", MeshcatCone(HEAD, HEAD_RADIUS, HEAD_RADIUS), color
        )
        # Meshcat's cone has its tip at the origin and opens along +z
        turned = RigidTransform(RotationMatrix.MakeXRotation(math.pi))
        meshcat.SetTransform(f"{name}/head/cone", turned)

    def _add_cone(self, name: str) -> None:
        """Add the section of a friction cone in the plane, with its apex at the origin
        and along +x.
        """
        half = self._contacts.friction * CONE_LENGTH
        corners = [[0.0, 0.0, 0.0], [CONE_LENGTH, half, 0.0], [CONE_LENGTH, -half, 0.0]]
        faces = np.array([[0], [1], [2]])
        self._meshcat.SetTriangleMesh(name, np.array(corners).T, faces, CONE_COLOR)

    def _add_disc(self, name: str) -> None:
        """Add the friction disc of a press, with radius 1 about the origin."""
        disc = Cylinder(1.0, DISC_THICKNESS)
        self._meshcat.SetObject(f"{name}/disc", disc, CONE_COLOR)

    def _draw_trace(self, points: Array, segments: Array) -> list[tuple[int, str]]:
        """Draw the whole trace in parts. Return the frame at which each part appears,
        and its name.

        ``points`` (F, 2) [m] and ``segments`` (F,) are those of each frame. The
        tracking point may change between segments; its two positions are not joined by
        a line.
        """
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        moved = np.concatenate([[0.0], np.cumsum(steps)])
        pieces: list[tuple[int, str]] = []
        step = moved[-1] / TRACE_PIECES
        first = 0
        for last in range(1, len(points)):
            if segments[last] != segments[first]:
                first = last
            if step > LEAST_STEP and moved[last] - moved[first] >= step:
                name = f"marks/trace/{len(pieces)}"
                if self._draw_piece(name, points[first : last + 1]):
                    pieces.append((last, name))
                first = last
        return pieces

    def _draw_piece(self, name: str, points: Array) -> bool:
        """Draw a line through points (F, 2) [m]. Return whether any two of them differ."""
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        apart = np.concatenate([[True], steps > 1e-7])
        if apart.sum() < 2:
            return False
        self._meshcat.SetObject(name, ribbon(points[apart], TRACE_WIDTH), BLUE)
        X = rigid_transform(Pose2(), TRACE_HEIGHT, self._frame)
        self._meshcat.SetTransform(name, X)
        return True

    def show(self, frame: int, tick: int, t: float) -> None:
        """Record the marks of one frame, at time ``t`` [s] of the animation."""
        meshcat = self._meshcat
        X_WV = self._playback.vehicle_pose(tick)
        axle = rigid_transform(Pose2(X_WV.x, X_WV.y), 0.5 * self._pin, self._frame)
        meshcat.SetTransform("marks/axle", axle, time_in_recording=t)
        for start, name in self._trace:
            if frame in (0, start, self._last):
                visible = frame >= start
                meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        for arm in self._contacts.arms:
            self._show_arrow(f"marks/force_{arm}", self._contacts.push(arm, tick), t)
            self._show_cone(f"marks/cone_{arm}", self._contacts.cone(arm, tick), t)
        for arm in self._contacts.pressing:
            self._show_arrow(f"marks/press_{arm}", self._contacts.press(arm, tick), t)
            self._show_disc(f"marks/disc_{arm}", self._contacts.disc(arm, tick), t)

    def _show_cone(self, name: str, cone: tuple[Pose2, float] | None, t: float) -> None:
        """Record a friction cone, or its absence."""
        meshcat = self._meshcat
        meshcat.SetProperty(name, "visible", cone is not None, time_in_recording=t)
        if cone is not None:
            X = rigid_transform(*cone, self._frame)
            meshcat.SetTransform(name, X, time_in_recording=t)

    def _show_disc(self, name: str, disc: Disc | None, t: float) -> None:
        """Record a friction disc, or its absence."""
        meshcat = self._meshcat
        meshcat.SetProperty(name, "visible", disc is not None, time_in_recording=t)
        if disc is not None:
            X = rigid_transform(Pose2(disc.x, disc.y), disc.height, self._frame)
            meshcat.SetTransform(name, X, time_in_recording=t)
            scale = [disc.radius, disc.radius, 1.0]
            meshcat.SetProperty(f"{name}/disc", "scale", scale, time_in_recording=t)

    def _show_arrow(self, name: str, arrow: Arrow, t: float) -> None:
        """Record an arrow, which is hidden if its force is small."""
        meshcat = self._meshcat
        visible = arrow.size > LEAST_FORCE
        meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not visible:
            return
        x, y, z = (float(v) for v in arrow.force / arrow.size)
        along = np.array(self._frame.direction((x, y, z)))
        R = RotationMatrix.MakeFromOneVector(along, 2)
        X = RigidTransform(R, self._frame.point(tuple(arrow.tail.tolist())))
        meshcat.SetTransform(name, X, time_in_recording=t)
        length = arrow.scale * arrow.size
        shaft = max(length - HEAD, 0.2 * length, 1e-4)
        for part, key, value in (
            ("shaft", "scale", [1.0, 1.0, shaft]),
            ("shaft", "position", [0.0, 0.0, 0.5 * shaft]),
            ("head", "position", [0.0, 0.0, shaft + HEAD]),
        ):
            meshcat.SetProperty(f"{name}/{part}", key, value, time_in_recording=t)
