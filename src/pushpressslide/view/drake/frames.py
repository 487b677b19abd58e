"""Pictures of a run, rendered without a display, and an animation of them."""

from __future__ import annotations

import ctypes
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
from pushpressslide.core.task import Support
from pushpressslide.core.whole_file import whole
from pushpressslide.view.canvas import Canvas
from pushpressslide.view.drake.camera import FIELD, View, axes
from pushpressslide.view.drake.overlay import Overlay
from pushpressslide.view.drake.playback import Placed, Playback
from pushpressslide.view.drake.views import contact_view
from pushpressslide.view.film import (
    FRAMES_PER_SECOND,
    STILL_SIZE,
    caption,
    film_path,
    film_ticks,
    legend,
    write_film,
    write_stills,
)
from pushpressslide.view.film import SIZE as FILM_SIZE
from pushpressslide.view.timeline import run_timeline

RENDERER = "frames"
BACKGROUND = [0.93, 0.95, 0.97]
SIZE = (640, 480)  # [pixels] width and height
# directions of the light along x, y and height of a support
LIGHT = (-0.4, 0.5, -1.0)
STEEP_LIGHT = (-0.4, -0.9, -0.8)


class FrameRenderer:
    """Renders recorded ticks of one run."""

    def __init__(
        self,
        plan: Plan,
        record: Record,
        size: tuple[int, int] = SIZE,
        models: str = "generated",
        goals: Sequence[Placed] = (),
    ) -> None:
        """Set up the scene and a camera of ``size`` (width, height) [pixels]; ``goals``
        as in ``Playback``.

        Raises SimulationError if this machine cannot render.
        """
        problem = egl_problem()
        if problem:
            raise _cannot_render(problem)
        self.playback = Playback(plan, record, models, goals)
        self._graph = self.playback.scene.scene_graph
        try:
            engine = MakeRenderEngineVtk(_render_parameters(plan.task.support))
            self._graph.AddRenderer(RENDERER, engine)
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error
        self._diagram = self.playback.scene.builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        width, height = size
        core = RenderCameraCore(
            RENDERER,
            CameraInfo(width, height, FIELD),
            ClippingRange(0.05, 20.0),
            RigidTransform(),
        )
        self._camera = ColorRenderCamera(core, False)
        self.view = contact_view(self.playback, FIELD, width / height)
        self._X_WC = look_at(self.view)

    def image(self, time: float) -> NDArray[np.uint8]:
        """Picture (height, width, 3) at ``time`` [s] of the run."""
        (tick,) = self.playback.ticks_at(np.array([time]))
        return self.image_at(tick)

    def image_at(self, tick: int) -> NDArray[np.uint8]:
        """Picture (height, width, 3) at a recorded tick."""
        self.playback.set(self._context, tick)
        context = self._graph.GetMyContextFromRoot(self._context)
        query = self._graph.get_query_output_port().Eval(context)
        try:
            seen = query.RenderColorImage(
                self._camera, self._graph.world_frame_id(), self._X_WC
            )
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error
        return np.array(seen.data[:, :, :3], dtype=np.uint8)


def render_frames(
    plan: Plan,
    record: Record,
    times: Sequence[float],
    out_dir: Path,
    size: tuple[int, int] = SIZE,
    models: str = "generated",
) -> list[Path]:
    """Write a PNG of ``size`` (width, height) [pixels] for each of ``times`` [s].

    They are frame_000.png and so on in ``out_dir``. Returns their paths. Raises
    SimulationError, in one line, if this machine cannot render.
    """
    renderer = FrameRenderer(plan, record, size, models)
    paths = []
    for i, time in enumerate(times):
        path = out_dir / f"frame_{i:03d}.png"
        with whole(path) as temporary:
            _pillow().fromarray(renderer.image(time)).save(temporary)
        paths.append(path)
    return paths


def write_pictures(
    plan: Plan,
    record: Record,
    out: Path,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> list[Path]:
    """Write pictures of start, contact and end of a run into ``out`` and return their
    paths. Raises SimulationError if this machine cannot render.
    """
    renderer = FrameRenderer(plan, record, STILL_SIZE, models, goals)
    overlay = Overlay(renderer.playback, renderer.view, STILL_SIZE)

    def picture(tick: int) -> Any:
        canvas = Canvas(renderer.image_at(tick))
        overlay.draw(canvas, tick)
        return canvas.image()

    return write_stills(record.arrays["phase"], picture, out)


def write_video(
    plan: Plan,
    record: Record,
    out: Path,
    frames_per_second: float = FRAMES_PER_SECOND,
    size: tuple[int, int] = FILM_SIZE,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> Path:
    """Write the run as an animated picture in real time, with its forces, paths and a
    caption. Return its path.

    The format, .webp or .gif, follows from the name of ``out``; a folder gets run.webp.
    ``size`` is (width, height) [pixels], ``goals`` are as in ``Playback``. Raises
    SimulationError if this machine cannot render, or for another format.
    """
    out = film_path(out)
    renderer = FrameRenderer(plan, record, size, models, goals)
    overlay = Overlay(renderer.playback, renderer.view, size)
    ticks = film_ticks(record.arrays["time"], frames_per_second)
    told = run_timeline(plan, record, np.array(ticks))
    title = f"{plan.task.name}: {', '.join(record.modes)}"

    def picture(frame: int) -> Any:
        canvas = Canvas(renderer.image_at(ticks[frame]))
        overlay.draw(canvas, ticks[frame])
        legend(canvas, overlay.contacts.entries())
        caption(canvas, title, told, frame)
        return canvas.image()

    return write_film(len(ticks), picture, out, frames_per_second)


def _render_parameters(support: Support) -> RenderEngineVtkParams:
    """Background and lights: one on the support, a weaker one at the camera."""
    above = LightParameter(
        type="directional", frame="world", direction=_light(support), intensity=0.75
    )
    ahead = LightParameter(
        type="directional", frame="camera", direction=[0.1, 0.2, 1.0], intensity=0.6
    )
    return RenderEngineVtkParams(default_clear_color=BACKGROUND, lights=[above, ahead])


def _light(support: Support) -> list[float]:
    """Direction of the light in the world. It falls onto the support's face from above."""
    frame = support.frame
    along = LIGHT if frame.faces_up else STEEP_LIGHT
    return list(frame.direction(along))


def look_at(view: View) -> RigidTransform:
    """X_WC of a camera (z forward, x right, y down) with an upright picture."""
    x, y, z = axes(view.position - view.target)
    return RigidTransform(RotationMatrix(np.column_stack([x, y, z])), view.position)


def egl_problem() -> str | None:
    """Reason why EGL has no device to render on, or None.

    None also on a system without EGL. This is checked beforehand because without a
    device the renderer ends the process.
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
    """Pillow's image module, which comes with matplotlib."""
    from PIL import Image

    return Image
