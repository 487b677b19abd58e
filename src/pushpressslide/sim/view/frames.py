"""Pictures of a run, rendered without a display, and an animation made of them."""

from __future__ import annotations

import ctypes
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    LightParameter,
    MakeRenderEngineVtk,
    RenderCameraCore,
    RenderEngineVtkParams,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.sensors import CameraInfo

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Support, Task
from pushpressslide.sim.view.playback import ASPECT, Playback, View

FIELD = math.radians(40.0)  # vertical field of view
RENDERER = "frames"
BACKGROUND = [0.93, 0.95, 0.97]
VIDEO_FORMATS = (".webp", ".gif")


class FrameRenderer:
    """Renders recorded ticks of one run."""

    def __init__(
        self,
        task: Task,
        plan: Plan,
        record: Record,
        width: int = 640,
        height: int = 480,
        models: str = "generated",
    ) -> None:
        """Set the scene up; raises SimulationError where this machine cannot render."""
        problem = egl_problem()
        if problem:
            raise _cannot_render(problem)
        self.playback = Playback(task, plan, record, models)
        graph = self.playback.scene.scene_graph
        parameters = RenderEngineVtkParams(
            default_clear_color=BACKGROUND,
            lights=[
                LightParameter(
                    type="directional",
                    frame="world",
                    direction=_light(task.support),
                    intensity=0.75,
                ),
                LightParameter(
                    type="directional",
                    frame="camera",
                    direction=[0.1, 0.2, 1.0],
                    intensity=0.6,
                ),
            ],
        )
        try:
            graph.AddRenderer(RENDERER, MakeRenderEngineVtk(parameters))
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error
        self._diagram = self.playback.scene.builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        info = CameraInfo(width, height, FIELD)
        core = RenderCameraCore(
            RENDERER, info, ClippingRange(0.05, 20.0), RigidTransform()
        )
        self._camera = ColorRenderCamera(core, False)
        self._X_WC = look_at(
            self.playback.view(FIELD * min(1.0, width / height / ASPECT))
        )
        self._graph = graph

    def image(self, time: float) -> NDArray[np.uint8]:
        """Return the picture (height, width, 3) at ``time`` [s] of the run."""
        (tick,) = self.playback.ticks_at(np.array([time]))
        self.playback.set(self._context, tick)
        query = self._graph.get_query_output_port().Eval(
            self._graph.GetMyContextFromRoot(self._context)
        )
        try:
            seen = query.RenderColorImage(
                self._camera, self._graph.world_frame_id(), self._X_WC
            )
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error
        return np.array(seen.data[:, :, :3], dtype=np.uint8)


def render_frames(
    task: Task,
    plan: Plan,
    record: Record,
    times: Sequence[float],
    out_dir: Path,
    width: int = 640,
    height: int = 480,
    models: str = "generated",
) -> list[Path]:
    """Write one PNG for each of ``times`` [s] into ``out_dir``, frame_000.png and so
    on; return their paths.

    Raises SimulationError, one line, where this machine cannot render.
    """
    renderer = FrameRenderer(task, plan, record, width, height, models)
    out_dir.mkdir(parents=True, exist_ok=True)
    paths = []
    for i, time in enumerate(times):
        path = out_dir / f"frame_{i:03d}.png"
        _pillow().fromarray(renderer.image(time)).save(path)
        paths.append(path)
    return paths


def write_video(
    task: Task,
    plan: Plan,
    record: Record,
    out: Path,
    frames_per_second: float = 15.0,
    width: int = 640,
    height: int = 480,
    models: str = "generated",
) -> Path:
    """Write the run as an animated picture in real time, .webp or .gif by ``out``'s
    name; return ``out``.

    A folder gets run.webp. Raises SimulationError where this machine cannot render or
    the name asks for another format.
    """
    out = out / "run.webp" if out.is_dir() else out
    if out.suffix not in VIDEO_FORMATS:
        raise SimulationError(
            f"{out}: an animation is written as {' or '.join(VIDEO_FORMATS)}"
        )
    time = record.arrays["time"]
    renderer = FrameRenderer(task, plan, record, width, height, models)
    grid = np.arange(float(time[0]), float(time[-1]), 1.0 / frames_per_second)
    first, *others = (_pillow().fromarray(renderer.image(float(t))) for t in grid)
    out.parent.mkdir(parents=True, exist_ok=True)
    temporary = out.with_name(f".{out.stem}.part{out.suffix}")
    try:
        first.save(
            temporary,
            save_all=True,
            append_images=others,
            duration=round(1e3 / frames_per_second),
            loop=0,
        )
        temporary.replace(out)
    finally:
        temporary.unlink(missing_ok=True)
    return out


def _light(support: Support) -> list[float]:
    """The direction of the light that falls on the support's face: onto a wall it comes
    from above.
    """
    along = (-0.4, 0.5, -1.0) if support.kind == "table" else (-0.4, -0.9, -0.8)
    return list(support.frame.direction(along))


def look_at(view: View) -> RigidTransform:
    """Return X_WC of a camera (z ahead, x right, y down) at ``view``, its picture
    upright.
    """
    z = (view.target - view.position) / np.linalg.norm(view.target - view.position)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    return RigidTransform(
        RotationMatrix(np.column_stack([x, np.cross(z, x), z])), view.position
    )


def egl_problem() -> str | None:
    """Return why EGL has no device to render on; None if it has one, or on a system
    that does without EGL.

    Asked beforehand, because the renderer ends the process where it finds none.
    """
    if sys.platform != "linux":
        return None
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return "libEGL.so.1 is missing"
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    address = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not address:
        return "EGL cannot list its devices"
    query = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)
    )(address)
    count = ctypes.c_int(0)
    if not query(0, None, ctypes.byref(count)) or count.value < 1:
        return "EGL has no device"
    return None


def _cannot_render(problem: str) -> SimulationError:
    reason = " ".join(problem.split())[:160]
    return SimulationError(
        f"this machine cannot render pictures ({reason}); on Debian, install libegl1"
    )


def _pillow() -> Any:
    """Pillow comes with matplotlib."""
    from PIL import Image

    return Image
