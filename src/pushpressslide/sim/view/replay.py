"""The replay of a run as one Meshcat page that opens offline."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.geometry import (
    Cylinder,
    Meshcat,
    MeshcatAnimation,
    MeshcatCone,
    MeshcatParams,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    Rgba,
    Role,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.whole_file import write_whole
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.view.playback import Placed, Playback, View, ribbon

FRAMES_PER_SECOND = 30.0
FIELD = math.radians(75.0)  # vertical field of view of Meshcat's camera
TRACE_PIECES = 60  # of the trace of the tracking point
TRACE_HEIGHT = 0.0018  # [m] above the support
TRACE_WIDTH = 0.006  # [m]
LEAST_STEP = 1e-5  # [m] shorter pieces of the trace are not drawn
FORCE_SCALE = 0.02  # [m/N] largest
LONGEST_ARROW = 0.15  # [m] of a force in the plane
LONGEST_PRESS = 0.10  # [m]
CLEARANCE = 0.012  # [m] from object and tip to the arrows, so that neither hides them
LEAST_FORCE = 0.3  # [N] smaller forces have no arrow
SHAFT = 0.004  # [m] radius of an arrow's shaft
HEAD_RADIUS = 0.010  # [m]
HEAD = 0.022  # [m] length of an arrow's head
BLUE = Rgba(0.0, 0.45, 0.70, 1.0)
WHITE = Rgba(0.95, 0.95, 0.95, 1.0)
PURPLE = Rgba(0.66, 0.22, 0.49, 1.0)
ORANGE = Rgba(0.84, 0.37, 0.0, 1.0)

CAPTION = """<div style="position:fixed;left:12px;bottom:10px;z-index:5;font:13px/1.5 system-ui,sans-serif;
color:#1f2328;background:rgba(255,255,255,.82);padding:6px 10px;border-radius:6px;pointer-events:none">
<b>@TITLE@</b><br><span style="color:#222">&#9644;</span> planned path of the tracking point
<span style="color:#0072b2">&#9644;</span> its trace <span style="color:#009e73">&#9632;</span> goal
<span style="color:#a8387d">&#9644;</span> contact force in the plane, @SCALE@ mm a newton@PRESS@</div>"""
PRESS_CAPTION = """
<span style="color:#d55e00">&#9644;</span> press, beside its tip, @SCALE@ mm a newton"""


def write_replay(
    plan: Plan,
    record: Record,
    out: Path,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> Path:
    """Write the page to the file ``out`` and return its path.

    In a folder ``out`` it is replay.html. It plays the recorded joint positions and
    poses at 30 frames a second, and is written whole or not at all. Raises
    SimulationError for a record without joint positions. ``models``: as in ``run``;
    ``goals`` as of ``Playback``.
    """
    if len(record.arrays.get("time", ())) < 2:
        raise SimulationError(
            f"{out}: a record of fewer than two ticks cannot be replayed"
        )
    playback = Playback(plan, record, models, goals)
    meshcat = quiet_meshcat()
    look(meshcat)
    view = playback.view(FIELD)
    meshcat.SetCameraPose(view.position, view.target)
    marks = _animate(meshcat, playback, view)
    page = meshcat.StaticHtml()
    title = f"{plan.task.name}: {', '.join(record.modes)}, {record.reason.replace('_', ' ')}"
    caption = _caption(title, marks)
    if "</body>" in page:
        page = page.replace("</body>", f"{caption}</body>", 1)
    else:
        page += caption
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def _animate(meshcat: Meshcat, playback: Playback, view: View) -> _Marks:
    """Record the whole run as an animation; return the marks that are drawn in it."""
    parameters = MeshcatVisualizerParams()
    parameters.role = Role.kIllustration
    scene = playback.scene
    visualizer = MeshcatVisualizer.AddToBuilder(
        scene.builder, scene.scene_graph, meshcat, parameters
    )
    diagram = scene.builder.Build()
    context = diagram.CreateDefaultContext()
    time = playback.record.arrays["time"]
    count = max(2, math.ceil((time[-1] - time[0]) * FRAMES_PER_SECOND))
    ticks = playback.ticks_at(np.linspace(time[0], time[-1], count))
    marks = _Marks(meshcat, playback, ticks, view)
    recording = visualizer.StartRecording(set_transforms_while_recording=False)
    for frame, tick in enumerate(ticks):
        t = frame / FRAMES_PER_SECOND
        context.SetTime(t)
        playback.set(context, tick)
        diagram.ForcedPublish(context)
        marks.show(frame, tick, t)
    visualizer.StopRecording()
    recording.set_loop_mode(MeshcatAnimation.LoopMode.kLoopRepeat)
    recording.set_repetitions(1000)
    visualizer.PublishRecording()
    return marks


def _caption(title: str, marks: _Marks) -> str:
    """Return the legend of the page."""
    press = ""
    if marks.presses:
        press = PRESS_CAPTION.replace("@SCALE@", f"{1e3 * marks.press_scale:.0f}")
    caption = CAPTION.replace("@SCALE@", f"{1e3 * marks.scale:.0f}")
    return caption.replace("@PRESS@", press).replace("@TITLE@", escape(title))


def quiet_meshcat() -> Meshcat:
    """Return a Meshcat whose server listens on this machine only and prints nothing."""
    log = logging.getLogger("drake")
    level = log.level
    log.setLevel(logging.WARNING)
    try:
        return Meshcat(MeshcatParams(host="localhost", port=0, show_stats_plot=False))
    finally:
        log.setLevel(level)


def look(meshcat: Meshcat) -> None:
    """Set a page's background, and hide Meshcat's own grid and axes."""
    meshcat.SetProperty("/Grid", "visible", False)
    meshcat.SetProperty("/Axes", "visible", False)
    meshcat.SetProperty("/Background", "top_color", [0.93, 0.95, 0.97])
    meshcat.SetProperty("/Background", "bottom_color", [1.0, 1.0, 1.0])


class _Marks:
    """Marks over the scene, in the support's frame: trace, axle and contact forces.

    Meshcat loops each track over its own keys, so that tracks stay in step only if each
    has a key at the last frame.
    """

    def __init__(
        self, meshcat: Meshcat, playback: Playback, ticks: list[int], view: View
    ) -> None:
        self._meshcat = meshcat
        self._playback = playback
        self._last = len(ticks) - 1
        self._contacts = [p.contacts for p in playback.plan.by_placement]
        self._height = playback.task.object.shape.height
        self._frame = playback.task.support.frame
        arrays = playback.record.arrays
        forces = np.nan_to_num(arrays["measured_force"])
        self.scale = _scale(np.linalg.norm(forces[:, :, :2], axis=2), LONGEST_ARROW)
        self.press_scale = _scale(np.maximum(-forces[:, :, 2], 0.0), LONGEST_PRESS)
        every = [contact for contacts in self._contacts for contact in contacts]
        self._pressing = {contact.arm for contact in every if contact.kind == "top"}
        self._arms = {contact.arm for contact in every}
        self.presses = bool(self._pressing)
        ahead = np.array(self._frame.components(view.position - view.target))
        ahead[2] = 0.0
        self._nearer: Any = ahead / np.linalg.norm(ahead)
        vehicle = [playback.vehicle_pose(tick) for tick in ticks]
        points = np.array([(v.x, v.y) for v in vehicle])
        self._trace = self._draw_trace(points, arrays["stretch"][ticks])
        self._pin = self._height + 0.03
        self._add_axle()
        for arm in self._arms:
            self._add_arrow(f"marks/force_{arm}", PURPLE)
        for arm in self._pressing:
            self._add_arrow(f"marks/press_{arm}", ORANGE)

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
        number = int(self._playback.record.arrays["placement"][tick])
        pressing = {c.arm for c in self._contacts[number] if c.kind == "top"}
        for arm in self._arms:
            self._show_contact(arm, arm in pressing, tick, t, frame in (0, self._last))

    def _show_contact(
        self, arm: int, presses: bool, tick: int, t: float, at_end: bool
    ) -> None:
        """Record the force in the plane, drawn above the object from the tip's edge,
        and the press, drawn down onto the object beside its tip.
        """
        arrays = self._playback.record.arrays
        force: Any = np.nan_to_num(arrays["measured_force"][tick, arm])
        tip: Any = arrays["tip_position"][tick, arm]
        radius = self._playback.task.robots[arm].tip_radius
        flat = np.array([force[0], force[1], 0.0])
        ahead = flat / max(float(np.linalg.norm(flat)), 1e-9)
        tail = np.array([tip[0], tip[1], self._height + CLEARANCE]) + radius * ahead
        self._show_arrow(f"marks/force_{arm}", tail, flat, self.scale, t, at_end)
        if arm in self._pressing:
            down = np.zeros(3)
            if presses:
                down[2] = min(force[2], 0.0)
            top = np.array([tip[0], tip[1], self._height])
            head = top + (radius + CLEARANCE) * self._nearer
            name = f"marks/press_{arm}"
            tail = head - self.press_scale * down
            self._show_arrow(name, tail, down, self.press_scale, t, at_end)

    def _show_arrow(
        self, name: str, tail: Any, force: Any, scale: float, t: float, at_end: bool
    ) -> None:
        """Record an arrow of ``force`` (3,) [N] from ``tail`` (3,), in the support's
        frame; it is hidden if the force is small.
        """
        meshcat = self._meshcat
        size = float(np.linalg.norm(force))
        visible = size > LEAST_FORCE
        meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not (visible or at_end):
            return
        along = force / size if size > 1e-9 else (1.0, 0.0, 0.0)
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
