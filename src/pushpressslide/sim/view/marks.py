"""Marks over the scene of a replay: trace, virtual axle, forces and friction cones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Cylinder, Meshcat, MeshcatCone, Rgba, Sphere
from pydrake.math import RigidTransform, RotationMatrix

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.view.lines import ribbon
from pushpressslide.sim.view.playback import Playback
from pushpressslide.sim.view.subject import CLEARANCE, body_pose, contacts_at

TRACE_PIECES = 60  # of the trace of the tracking point
TRACE_HEIGHT = 0.0018  # [m] above the support
TRACE_WIDTH = 0.006  # [m]
LEAST_STEP = 1e-5  # [m] shorter pieces of the trace are not drawn
FORCE_SCALE = 0.02  # [m/N] largest
LONGEST_ARROW = 0.15  # [m] of a force in the plane
LONGEST_PRESS = 0.10  # [m]
LEAST_FORCE = 0.3  # [N] smaller forces have no arrow
SHAFT = 0.004  # [m] radius of an arrow's shaft
HEAD_RADIUS = 0.010  # [m]
HEAD = 0.022  # [m] length of an arrow's head
BLUE = Rgba(0.0, 0.45, 0.70, 1.0)
WHITE = Rgba(0.95, 0.95, 0.95, 1.0)
PURPLE = Rgba(0.66, 0.22, 0.49, 1.0)
ORANGE = Rgba(0.84, 0.37, 0.0, 1.0)
CONE_COLOR = Rgba(0.90, 0.62, 0.0, 0.4)
WIDEST_DISC = 0.09  # [m] radius of a friction disc
CONE_LENGTH = 0.12  # [m] of a friction cone
DISC_THICKNESS = 0.0005  # [m]
CONE_SINK = 0.005  # [m] of a friction cone under its arrow


Ticks = NDArray[np.intp]


class Marks:
    """Marks over the scene, in the support's frame: trace, axle, forces and cones."""

    def __init__(
        self, meshcat: Meshcat, playback: Playback, ticks: Ticks, nearer: Array
    ) -> None:
        """Add all marks; ``ticks`` (F,) are the frames, ``nearer`` (3,) points to the
        camera, in the world.
        """
        self._meshcat = meshcat
        self._playback = playback
        self._last = len(ticks) - 1
        self._contacts = [p.contacts for p in playback.plan.by_placement]
        self._height = playback.task.object.shape.height
        self._frame = playback.task.support.frame
        arrays = playback.record.arrays
        forces = np.nan_to_num(arrays["measured_force"])
        loads = np.maximum(-forces[:, :, 2], 0.0)
        self._friction = playback.task.contact_friction
        self.scale = min(
            _scale(np.linalg.norm(forces[:, :, :2], axis=2), LONGEST_ARROW),
            _scale(self._friction * loads, WIDEST_DISC),
        )
        self.press_scale = _scale(loads, LONGEST_PRESS)
        every = [contact for contacts in self._contacts for contact in contacts]
        self._pressing = {contact.arm for contact in every if contact.kind == "top"}
        self._arms = {contact.arm for contact in every}
        self.presses = bool(self._pressing)
        ahead = np.array(self._frame.components(tuple(nearer.tolist())))
        ahead[2] = 0.0
        self._nearer: Any = ahead / np.linalg.norm(ahead)
        vehicle = [playback.vehicle_pose(tick) for tick in ticks]
        points = np.array([(v.x, v.y) for v in vehicle])
        self._trace = self._draw_trace(points, arrays["stretch"][ticks])
        self._pin = self._height + 0.03
        self._add_axle()
        for arm in self._arms:
            self._add_arrow(f"marks/force_{arm}", PURPLE)
            self._add_cone(f"marks/cone_{arm}")
        for arm in self._pressing:
            self._add_arrow(f"marks/press_{arm}", ORANGE)
            self._add_disc(f"marks/disc_{arm}")

    def _add_axle(self) -> None:
        """Add the marker of the tracking point: a pin with a head at its upper end."""
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
        """Add the cone's section in the plane: its apex at the origin, along +x."""
        half = self._friction * CONE_LENGTH
        corners = [[0.0, 0.0, 0.0], [CONE_LENGTH, half, 0.0], [CONE_LENGTH, -half, 0.0]]
        faces = np.array([[0], [1], [2]])
        self._meshcat.SetTriangleMesh(name, np.array(corners).T, faces, CONE_COLOR)

    def _add_disc(self, name: str) -> None:
        """Add the friction disc of a press, of radius 1 about the origin."""
        disc = Cylinder(1.0, DISC_THICKNESS)
        self._meshcat.SetObject(f"{name}/disc", disc, CONE_COLOR)

    def _draw_trace(self, points: Array, segments: Array) -> list[tuple[int, str]]:
        """Draw the whole trace in pieces; return the frame at which each piece appears,
        and its name.

        ``points`` (F, 2) [m] and ``segments`` (F,) of the plan, per frame. The
        tracking point may change between segments, and no line joins the two.
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
        """Draw a line through points (F, 2) [m]; return whether two of them differ."""
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
        for begin, name in self._trace:
            if frame in (0, begin, self._last):
                visible = frame >= begin
                meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        contacts = {c.arm: c for c in contacts_at(self._playback, tick)}
        for arm in self._arms:
            self._show_force(arm, contacts.get(arm), tick, t)
        for arm in self._pressing:
            self._show_press(arm, contacts.get(arm), tick, t)

    def _force(self, arm: int, tick: int) -> Any:
        """Return the measured force (3,) [N] of an arm."""
        return np.nan_to_num(self._playback.record.arrays["measured_force"][tick, arm])

    def _above(self, arm: int, tick: int) -> Any:
        """Return the place (3,) [m] over a tip and over the object."""
        x, y, _ = self._playback.record.arrays["tip_position"][tick, arm]
        return np.array([x, y, self._height + CLEARANCE])

    def _show_force(
        self, arm: int, contact: Contact | None, tick: int, t: float
    ) -> None:
        """Record the force in the plane, drawn above the object from the tip's edge,
        and the friction cone of a push.
        """
        force = self._force(arm, tick)
        flat = np.array([force[0], force[1], 0.0])
        ahead = flat / max(float(np.linalg.norm(flat)), 1e-9)
        pushes = contact is not None and contact.kind == "side"
        if contact is not None and pushes:
            ahead = np.array(contact.direction(body_pose(self._playback, tick)))
        radius = self._playback.task.robots[arm].tip_radius
        apex = self._above(arm, tick) + radius * ahead
        self._show_arrow(f"marks/force_{arm}", apex, flat, self.scale, t)
        name = f"marks/cone_{arm}"
        visible = pushes and float(np.linalg.norm(flat)) > LEAST_FORCE
        self._meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not visible:
            return
        x, y, _ = ahead
        pose = Pose2(float(apex[0]), float(apex[1]), math.atan2(y, x))
        X = rigid_transform(pose, float(apex[2]) - CONE_SINK, self._frame)
        self._meshcat.SetTransform(name, X, time_in_recording=t)

    def _show_press(
        self, arm: int, contact: Contact | None, tick: int, t: float
    ) -> None:
        """Record a press, drawn down onto the object beside its tip, and its friction
        disc, in which the force in the plane stays.
        """
        down = np.zeros(3)
        if contact is not None and contact.kind == "top":
            down[2] = min(self._force(arm, tick)[2], 0.0)
        above = self._above(arm, tick)
        radius = self._playback.task.robots[arm].tip_radius
        head = above + (radius + CLEARANCE) * self._nearer
        head[2] = self._height
        tail = head - self.press_scale * down
        self._show_arrow(f"marks/press_{arm}", tail, down, self.press_scale, t)
        name = f"marks/disc_{arm}"
        load = -float(down[2])
        visible = load > LEAST_FORCE
        self._meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not visible:
            return
        pose = Pose2(float(above[0]), float(above[1]))
        X = rigid_transform(pose, float(above[2]) - CONE_SINK, self._frame)
        self._meshcat.SetTransform(name, X, time_in_recording=t)
        size = self.scale * self._friction * load + radius
        scale = [size, size, 1.0]
        self._meshcat.SetProperty(f"{name}/disc", "scale", scale, time_in_recording=t)

    def _show_arrow(
        self, name: str, tail: Any, force: Any, scale: float, t: float
    ) -> None:
        """Record an arrow of ``force`` (3,) [N] from ``tail`` (3,), in the support's
        frame; it is hidden if the force is small.
        """
        meshcat = self._meshcat
        size = float(np.linalg.norm(force))
        visible = size > LEAST_FORCE
        meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not visible:
            return
        along = force / size
        R = RotationMatrix.MakeFromOneVector(np.array(self._frame.direction(along)), 2)
        X = RigidTransform(R, self._frame.point(tail))
        meshcat.SetTransform(name, X, time_in_recording=t)
        length = scale * size
        shaft = max(length - HEAD, 0.2 * length, 1e-4)
        for part, key, value in (
            ("shaft", "scale", [1.0, 1.0, shaft]),
            ("shaft", "position", [0.0, 0.0, 0.5 * shaft]),
            ("head", "position", [0.0, 0.0, shaft + HEAD]),
        ):
            meshcat.SetProperty(f"{name}/{part}", key, value, time_in_recording=t)


def _scale(forces: Array, longest: float) -> float:
    """Return the length of an arrow per force [m/N], so that none exceeds ``longest``
    [m].
    """
    return min(FORCE_SCALE, longest / max(float(forces.max(initial=0.0)), 1e-9))
