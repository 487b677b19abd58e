"""The replay of a run as one Meshcat page that opens offline."""

from __future__ import annotations

import logging
import math
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
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

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.sim.playback import Playback, ribbon

Array = NDArray[np.float64]

FRAMES_PER_SECOND = 30.0
FIELD = math.radians(75.0)  # vertical field of view of Meshcat's camera
TRACE_PIECES = 60  # that the trace of the tracking point is drawn in
TRACE_HEIGHT = 0.0018  # [m] above the support
FORCE_SCALE, LONGEST_ARROW = 0.02, 0.15  # [m/N], [m]
LEAST_FORCE = 0.3  # [N] below which no arrow is shown
SHAFT, HEAD_RADIUS, HEAD = 0.004, 0.010, 0.022  # [m] of the force arrow
BLUE, AMBER, WHITE = Rgba(0.0, 0.45, 0.70, 1.0), Rgba(0.90, 0.62, 0.0, 1.0), Rgba(0.95, 0.95, 0.95, 1.0)

CAPTION = """<div style="position:fixed;left:12px;bottom:10px;z-index:5;font:13px/1.5 system-ui,sans-serif;
color:#1f2328;background:rgba(255,255,255,.82);padding:6px 10px;border-radius:6px;pointer-events:none">
<b>@TITLE@</b><br><span style="color:#222">&#9644;</span> planned path of the tracking point
<span style="color:#0072b2">&#9644;</span> its trace <span style="color:#009e73">&#9632;</span> goal
<span style="color:#e69f00">&#9644;</span> contact force, @SCALE@ mm a newton</div>"""


def write_replay(task: Task, plan: Plan, record: Record, out: Path, models: str = "generated") -> Path:
    """Write the page to the file ``out`` (a folder: to replay.html in it), whole or not at all; return it.

    Plays the recorded joint positions and poses at 30 frames a second. Raises SimulationError for a record
    without joint positions. ``models``: as in ``run``.
    """
    if len(record.arrays.get("time", ())) < 2:
        raise SimulationError(f"{out}: a record of fewer than two ticks cannot be replayed")
    playback = Playback(task, plan, record, models)
    meshcat = quiet_meshcat()
    view = playback.view(FIELD)
    look(meshcat)
    meshcat.SetCameraPose(view.position, view.target)
    parameters = MeshcatVisualizerParams()
    parameters.role = Role.kIllustration
    builder, graph = playback.scene.builder, playback.scene.scene_graph
    visualizer = MeshcatVisualizer.AddToBuilder(builder, graph, meshcat, parameters)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    time = record.arrays["time"]
    count = max(2, math.ceil((time[-1] - time[0]) * FRAMES_PER_SECOND))
    ticks = playback.ticks_at(np.linspace(time[0], time[-1], count))
    marks = _Marks(meshcat, playback, ticks)
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
    title = escape(f"{task.name}: {', '.join(record.modes)}, {record.reason.replace('_', ' ')}")
    caption = CAPTION.replace("@TITLE@", title).replace("@SCALE@", f"{1e3 * marks.scale:.0f}")
    page = page.replace("</body>", f"{caption}</body>", 1) if "</body>" in page else page + caption
    return write_whole(out / "replay.html" if out.is_dir() else out, page)


def quiet_meshcat() -> Meshcat:
    """Return a Meshcat whose server, one comes with each, listens on this machine only and prints nothing."""
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
    """What is drawn over the scene: trace, axle marker and contact forces.

    Meshcat loops each track over its own keys: without one at the last frame they fall out of step.
    """

    def __init__(self, meshcat: Meshcat, playback: Playback, ticks: list[int]) -> None:
        self._meshcat, self._playback = meshcat, playback
        record = playback.record
        self._last = len(ticks) - 1
        self._contacts = playback.plan.choice.contacts
        self._height = playback.task.object.shape.height
        sizes = np.linalg.norm(np.nan_to_num(record.arrays["measured_force"]), axis=2)
        self.scale = min(FORCE_SCALE, LONGEST_ARROW / max(float(sizes.max(initial=0.0)), 1e-9))
        vehicle = [playback.vehicle_pose(tick) for tick in ticks]
        self._trace = self._draw_trace(np.array([(v.x, v.y) for v in vehicle]))
        meshcat.SetObject("marks/axle/pin", Cylinder(0.003, self._height + 0.03), BLUE)
        meshcat.SetObject("marks/axle/head", Sphere(0.008), WHITE)
        meshcat.SetTransform("marks/axle/head", RigidTransform([0.0, 0.0, 0.5 * (self._height + 0.03)]))
        for i in range(len(self._contacts)):
            meshcat.SetObject(f"marks/force_{i}/shaft", Cylinder(SHAFT, 1.0), AMBER)
            meshcat.SetObject(
                f"marks/force_{i}/head/cone", MeshcatCone(HEAD, HEAD_RADIUS, HEAD_RADIUS), AMBER
            )
            # Meshcat's cone has its tip at the origin and opens along +z
            turned = RigidTransform(RotationMatrix.MakeXRotation(math.pi))
            meshcat.SetTransform(f"marks/force_{i}/head/cone", turned)

    def _draw_trace(self, points: Array) -> list[tuple[int, str]]:
        """Draw the whole trace in pieces; return the frame at which each piece appears, and its name."""
        moved = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        pieces: list[tuple[int, str]] = []
        step = moved[-1] / TRACE_PIECES
        first = 0
        for last in range(1, len(points)):
            if step > 1e-5 and moved[last] - moved[first] >= step:
                kept = points[first : last + 1]
                apart = np.concatenate([[True], np.linalg.norm(np.diff(kept, axis=0), axis=1) > 1e-7])
                if apart.sum() > 1:
                    name = f"marks/trace/{len(pieces)}"
                    self._meshcat.SetObject(name, ribbon(kept[apart], 0.006), BLUE)
                    self._meshcat.SetTransform(name, RigidTransform([0.0, 0.0, TRACE_HEIGHT]))
                    pieces.append((last, name))
                first = last
        return pieces

    def show(self, frame: int, tick: int, t: float) -> None:
        """Record the marks of one frame, at time ``t`` [s] of the animation."""
        meshcat, X_WV = self._meshcat, self._playback.vehicle_pose(tick)
        middle = 0.5 * (self._height + 0.03)
        meshcat.SetTransform("marks/axle", RigidTransform([X_WV.x, X_WV.y, middle]), time_in_recording=t)
        for at, name in self._trace:
            if frame in (0, at, self._last):
                meshcat.SetProperty(name, "visible", frame >= at, time_in_recording=t)
        for i in range(len(self._contacts)):
            self._show_force(i, tick, t, frame in (0, self._last))

    def _show_force(self, i: int, tick: int, t: float, at_end: bool) -> None:
        meshcat, arrays, name = self._meshcat, self._playback.record.arrays, f"marks/force_{i}"
        force, tip = np.nan_to_num(arrays["measured_force"][tick, i]), arrays["tip_position"][tick, i]
        contact = self._contacts[i]
        pushing = contact.kind == "side"
        drawn = np.array([force[0], force[1], 0.0]) if pushing else force
        size = float(np.linalg.norm(drawn))
        visible = size > LEAST_FORCE
        meshcat.SetProperty(name, "visible", visible, time_in_recording=t)
        if not (visible or at_end):
            return
        axis: Any = drawn / size if size > 1e-9 else np.array([1.0, 0.0, 0.0])
        length = self.scale * size
        # a push is drawn above the object, where neither it nor the tip hides it; a press ends where it acts
        if pushing:
            radius = self._playback.task.robots[contact.arm].tip_radius
            tail: Any = np.array([tip[0], tip[1], self._height + 0.012]) + radius * axis
        else:
            tail = tip - length * axis
        shaft = max(length - HEAD, 0.2 * length, 1e-4)
        R = RotationMatrix.MakeFromOneVector(axis, 2)
        meshcat.SetTransform(name, RigidTransform(R, tail), time_in_recording=t)
        meshcat.SetProperty(f"{name}/shaft", "scale", [1.0, 1.0, shaft], time_in_recording=t)
        meshcat.SetProperty(f"{name}/shaft", "position", [0.0, 0.0, 0.5 * shaft], time_in_recording=t)
        meshcat.SetProperty(f"{name}/head", "position", [0.0, 0.0, shaft + HEAD], time_in_recording=t)
