"""The replay of a run as one Meshcat page that opens offline."""

from __future__ import annotations

import logging
import math
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
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.view.playback import Playback, View, ribbon

FRAMES_PER_SECOND = 30.0
FIELD = math.radians(75.0)  # vertical field of view of Meshcat's camera
TRACE_PIECES = 60  # that the trace of the tracking point is drawn in
TRACE_HEIGHT = 0.0018  # [m] above the support
FORCE_SCALE = 0.02
LONGEST_ARROW = 0.15
LONGEST_PRESS = 0.10  # [m/N], [m], [m]
CLEARANCE = 0.012  # [m] from object and tip to the arrows, so that neither hides them
LEAST_FORCE = 0.3  # [N] below which no arrow is shown
SHAFT = 0.004
HEAD_RADIUS = 0.010
HEAD = 0.022  # [m] of the force arrow
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
    task: Task, plan: Plan, record: Record, out: Path, models: str = "generated"
) -> Path:
    """Write the page to the file ``out`` (a folder: to replay.html in it), whole or not
    at all; return it.

    Plays the recorded joint positions and poses at 30 frames a second. Raises
    SimulationError for a record without joint positions. ``models``: as in ``run``.
    """
    if len(record.arrays.get("time", ())) < 2:
        raise SimulationError(
            f"{out}: a record of fewer than two ticks cannot be replayed"
        )
    playback = Playback(task, plan, record, models)
    meshcat = quiet_meshcat()
    view = playback.view(FIELD)
    look(meshcat)
    meshcat.SetCameraPose(view.position, view.target)
    parameters = MeshcatVisualizerParams()
    parameters.role = Role.kIllustration
    builder = playback.scene.builder
    graph = playback.scene.scene_graph
    visualizer = MeshcatVisualizer.AddToBuilder(builder, graph, meshcat, parameters)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    time = record.arrays["time"]
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
    page = meshcat.StaticHtml()
    title = escape(
        f"{task.name}: {', '.join(record.modes)}, {record.reason.replace('_', ' ')}"
    )
    press = (
        PRESS_CAPTION.replace("@SCALE@", f"{1e3 * marks.press_scale:.0f}")
        if marks.presses
        else ""
    )
    caption = CAPTION.replace("@SCALE@", f"{1e3 * marks.scale:.0f}").replace(
        "@PRESS@", press
    )
    caption = caption.replace("@TITLE@", title)
    page = (
        page.replace("</body>", f"{caption}</body>", 1)
        if "</body>" in page
        else page + caption
    )
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def quiet_meshcat() -> Meshcat:
    """Return a Meshcat whose server, one comes with each, listens on this machine only
    and prints nothing.
    """
    log = logging.getLogger("drake")
    level = log.level
    log.setLevel(logging.WARNING)
    try:
        return Meshcat(MeshcatParams(host="localhost", port=0, show_stats_plot=False))
    finally:
        log.setLevel(level)


def look(meshcat: Meshcat) -> None:
    """Give a page its background, and take away what Meshcat draws by itself."""
    meshcat.SetProperty("/Grid", "visible", False)
    meshcat.SetProperty("/Axes", "visible", False)
    meshcat.SetProperty("/Background", "top_color", [0.93, 0.95, 0.97])
    meshcat.SetProperty("/Background", "bottom_color", [1.0, 1.0, 1.0])


class _Marks:
    """What is drawn over the scene, in the support's frame: trace, axle marker and
    contact forces.

    Meshcat loops each track over its own keys: without one at the last frame they fall
    out of step.
    """

    def __init__(
        self, meshcat: Meshcat, playback: Playback, ticks: list[int], view: View
    ) -> None:
        self._meshcat = meshcat
        self._playback = playback
        arrays = playback.record.arrays
        self._last = len(ticks) - 1
        self._contacts = playback.plan.contacts_by_leg
        self._height = playback.task.object.shape.height
        self._frame = frame = playback.task.support.frame
        forces = np.nan_to_num(arrays["measured_force"])
        flat = np.linalg.norm(forces[:, :, :2], axis=2)
        down = np.maximum(-forces[:, :, 2], 0.0)
        self.scale = min(
            FORCE_SCALE, LONGEST_ARROW / max(float(flat.max(initial=0.0)), 1e-9)
        )
        self.press_scale = min(
            FORCE_SCALE, LONGEST_PRESS / max(float(down.max(initial=0.0)), 1e-9)
        )
        every = [
            contact for contacts in self._contacts.values() for contact in contacts
        ]
        self._pressing = {contact.arm for contact in every if contact.kind == "top"}
        self._arms = {contact.arm for contact in every}
        self.presses = bool(self._pressing)
        nearer = np.array(
            self._frame.components(view.position - view.target)
        ) * np.array([1.0, 1.0, 0.0])
        self._nearer: Any = nearer / np.linalg.norm(nearer)
        vehicle = [playback.vehicle_pose(tick) for tick in ticks]
        self._trace = self._draw_trace(
            np.array([(v.x, v.y) for v in vehicle]), arrays["stretch"][ticks]
        )
        self._pin = self._height + 0.03
        meshcat.SetObject("marks/axle/pin", Cylinder(0.003, self._pin), BLUE)
        meshcat.SetObject("marks/axle/head", Sphere(0.008), WHITE)
        # of the axle's own z axis
        up = float(np.dot(frame.spin_axis, frame.direction((0.0, 0.0, 1.0))))
        meshcat.SetTransform(
            "marks/axle/head", RigidTransform([0.0, 0.0, 0.5 * self._pin * up])
        )
        for arm in self._arms:
            self._add_arrow(f"marks/force_{arm}", PURPLE)
        for arm in self._pressing:
            self._add_arrow(f"marks/press_{arm}", ORANGE)

    def _add_arrow(self, name: str, color: Rgba) -> None:
        meshcat = self._meshcat
        meshcat.SetObject(f"{name}/shaft", Cylinder(SHAFT, 1.0), color)
        meshcat.SetObject(
            f"{name}/head/cone", MeshcatCone(HEAD, HEAD_RADIUS, HEAD_RADIUS), color
        )
        # Meshcat's cone has its tip at the origin and opens along +z
        turned = RigidTransform(RotationMatrix.MakeXRotation(math.pi))
        meshcat.SetTransform(f"{name}/head/cone", turned)

    def _draw_trace(self, points: Array, stretch: Array) -> list[tuple[int, str]]:
        """Draw the whole trace in pieces; return the frame at which each piece appears,
        and its name.

        ``points`` (F, 2) [m] and ``stretch`` (F,) of the plan, per frame: where a
        stretch begins, the tracking point may be another, and no line joins the two.
        """
        moved = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
        )
        pieces: list[tuple[int, str]] = []
        step = moved[-1] / TRACE_PIECES
        first = 0
        for last in range(1, len(points)):
            if stretch[last] != stretch[first]:
                first = last
            if step > 1e-5 and moved[last] - moved[first] >= step:
                kept = points[first : last + 1]
                apart = np.concatenate(
                    [[True], np.linalg.norm(np.diff(kept, axis=0), axis=1) > 1e-7]
                )
                if apart.sum() > 1:
                    name = f"marks/trace/{len(pieces)}"
                    self._meshcat.SetObject(name, ribbon(kept[apart], 0.006), BLUE)
                    self._meshcat.SetTransform(
                        name, rigid_transform(Pose2(), TRACE_HEIGHT, self._frame)
                    )
                    pieces.append((last, name))
                first = last
        return pieces

    def show(self, frame: int, tick: int, t: float) -> None:
        """Record the marks of one frame, at time ``t`` [s] of the animation."""
        meshcat = self._meshcat
        X_WV = self._playback.vehicle_pose(tick)
        axle = rigid_transform(Pose2(X_WV.x, X_WV.y), 0.5 * self._pin, self._frame)
        meshcat.SetTransform("marks/axle", axle, time_in_recording=t)
        for at, name in self._trace:
            if frame in (0, at, self._last):
                meshcat.SetProperty(name, "visible", frame >= at, time_in_recording=t)
        leg = int(self._playback.record.arrays["leg"][tick])
        pressing = {c.arm for c in self._contacts[leg] if c.kind == "top"}
        for arm in self._arms:
            self._show_contact(arm, arm in pressing, tick, t, frame in (0, self._last))

    def _show_contact(
        self, arm: int, presses: bool, tick: int, t: float, at_end: bool
    ) -> None:
        """Record the force in the plane, drawn over the object from the tip's edge on;
        and a press, drawn down onto the object beside its tip.
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
            down = np.array([0.0, 0.0, min(force[2], 0.0) if presses else 0.0])
            head = (
                np.array([tip[0], tip[1], self._height])
                + (radius + CLEARANCE) * self._nearer
            )
            tail = head - self.press_scale * down
            self._show_arrow(
                f"marks/press_{arm}", tail, down, self.press_scale, t, at_end
            )

    def _show_arrow(
        self, name: str, tail: Any, force: Any, scale: float, t: float, at_end: bool
    ) -> None:
        meshcat = self._meshcat
        size = float(np.linalg.norm(force))
        visible = size > LEAST_FORCE
        meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not (visible or at_end):
            return
        axis = np.array(
            self._frame.direction(force / size if size > 1e-9 else (1.0, 0.0, 0.0))
        )
        length = scale * size
        shaft = max(length - HEAD, 0.2 * length, 1e-4)
        R = RotationMatrix.MakeFromOneVector(axis, 2)
        meshcat.SetTransform(
            name, RigidTransform(R, self._frame.point(tail)), time_in_recording=t
        )
        meshcat.SetProperty(
            f"{name}/shaft", "scale", [1.0, 1.0, shaft], time_in_recording=t
        )
        meshcat.SetProperty(
            f"{name}/shaft", "position", [0.0, 0.0, 0.5 * shaft], time_in_recording=t
        )
        meshcat.SetProperty(
            f"{name}/head", "position", [0.0, 0.0, shaft + HEAD], time_in_recording=t
        )
