"""Pictures of a run, rendered without a display, and an animation made of them."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydrake.geometry import (
    LightParameter,
    MakeRenderEngineVtk,
    RenderEngineVtkParams,
)
from pydrake.math import RigidTransform, RotationMatrix

from pushpressslide.core.errors import SimulationError
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Support
from pushpressslide.core.whole_file import whole
from pushpressslide.view.canvas import Canvas
from pushpressslide.view.drake.camera import FIELD, View, axes, fit_view
from pushpressslide.view.drake.fade import ArmOpacity
from pushpressslide.view.drake.light_shapes import lighten_arms
from pushpressslide.view.drake.overlay import Overlay
from pushpressslide.view.drake.picture import RENDERER, Picture
from pushpressslide.view.drake.playback import Placed, Playback
from pushpressslide.view.drake.subject import near_points
from pushpressslide.view.drake.views import contact_view
from pushpressslide.view.film import (
    CLOSE,
    STILL_SIZE,
    caption,
    film_path,
    film_rate,
    film_ticks,
    legend,
    write_film,
    write_stills,
)
from pushpressslide.view.film import SIZE as FILM_SIZE
from pushpressslide.view.timeline import run_timeline

OPAQUE = 0.999  # opacity from which on nothing is mixed
BACKGROUND = [0.93, 0.95, 0.97]
SIZE = (640, 480)  # [pixels] width and height
# directions of the light along x, y and height of a support
LIGHT = (-0.4, 0.5, -1.0)
STEEP_LIGHT = (-0.4, -0.9, -0.8)


Arms = tuple[int, ...]
"""Indices of the arms that are shown."""


class _Scene:
    """A run's scene with some of its arms, and the picture of this scene."""

    def __init__(self, playback: Playback, arms: Arms) -> None:
        """Set up the renderer. Raises SimulationError if this machine cannot render."""
        self.playback = playback
        lighten_arms(playback, arms)
        self._graph = playback.scene.scene_graph
        support = playback.task.support
        try:
            engine = MakeRenderEngineVtk(_render_parameters(support))
            self._graph.AddRenderer(RENDERER, engine)
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error
        self._diagram = playback.scene.builder.Build()
        self._context = self._diagram.CreateDefaultContext()

    def image_at(self, tick: int, picture: Picture) -> NDArray[np.uint8]:
        """Picture of this scene at a tick, rendered by updating ``picture``."""
        self.playback.set(self._context, tick)
        context = self._graph.GetMyContextFromRoot(self._context)
        query = self._graph.get_query_output_port().Eval(context)
        try:
            return picture.update(query)
        except RuntimeError as error:
            raise _cannot_render(str(error)) from error


class FrameRenderer:
    """Renders recorded ticks of one run. An arm that hides a contact or a goal becomes
    transparent.
    """

    def __init__(
        self,
        plan: Plan,
        record: Record,
        size: tuple[int, int] = SIZE,
        models: str = "generated",
        goals: Sequence[Placed] = (),
    ) -> None:
        """Set up the scene and a camera of ``size`` (width, height) [pixels]. ``goals``
        are as in ``Playback``.

        Raises SimulationError if this machine cannot render.
        """
        problem = egl_problem()
        if problem:
            raise _cannot_render(problem)
        self._new_playback = partial(Playback, plan, record, models, goals)
        self._size = size
        self._arms: Arms = tuple(range(len(plan.task.robots)))
        self._scenes: dict[Arms, _Scene] = {}
        self.playback = self._new_playback()
        width, height = size
        self.aim(contact_view(self.playback, FIELD, width / height))

    def aim(self, view: View) -> None:
        """Take pictures from another view."""
        self.view = view
        self._opacity = ArmOpacity(self.playback, view.position)
        self._pictures: dict[Arms, Picture] = {}

    def approach(self, tick: int) -> None:
        """Move the camera near the object and its contacts at a tick, without changing
        its direction.
        """
        width, height = self._size
        points = near_points(self.playback, tick)
        direction = self.view.position - self.view.target
        self.aim(fit_view(points, direction, FIELD, width / height))

    def image(self, time: float) -> NDArray[np.uint8]:
        """Picture (height, width, 3) at ``time`` [s] of the run."""
        (tick,) = self.playback.ticks_at(np.array([time]))
        return self.image_at(tick)

    def image_at(self, tick: int) -> NDArray[np.uint8]:
        """Picture (height, width, 3) at a recorded tick."""
        return np.asarray(self._mixed(tick, self._opacity.of_tick(tick), self._arms))

    def _mixed(self, tick: int, opacity: Sequence[float], shown: Arms) -> Image.Image:
        """Picture with the arms ``shown``, the first of them at their ``opacity``.

        For a transparent arm, pictures with and without the arm are mixed.
        """
        if not opacity:
            return Image.fromarray(self._picture(tick, shown))
        *others, share = opacity
        full = self._mixed(tick, others, shown)
        if share > OPAQUE:
            return full
        without = tuple(arm for arm in shown if arm != len(others))
        return Image.blend(self._mixed(tick, others, without), full, share)

    def _picture(self, tick: int, arms: Arms) -> NDArray[np.uint8]:
        """Picture with the given arms. Its scene is made on first use."""
        if arms not in self._scenes:
            self._scenes[arms] = _Scene(self._new_playback(), arms)
        if arms not in self._pictures:
            self._pictures[arms] = Picture(self._size, look_at(self.view))
        return self._scenes[arms].image_at(tick, self._pictures[arms])


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
            Image.fromarray(renderer.image(time)).save(temporary)
        paths.append(path)
    return paths


def write_pictures(
    plan: Plan,
    record: Record,
    out: Path,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> list[Path]:
    """Write pictures of start, contact (close up) and end of a run into ``out``, and
    return their paths. Raises SimulationError if this machine cannot render.
    """
    renderer = FrameRenderer(plan, record, STILL_SIZE, models, goals)
    usual = renderer.view

    def picture(name: str, tick: int) -> Any:
        renderer.aim(usual)
        if name == CLOSE:
            renderer.approach(tick)
        canvas = Canvas(renderer.image_at(tick))
        overlay = Overlay(renderer.playback, renderer.view, STILL_SIZE, small=True)
        overlay.draw(canvas, tick)
        return canvas.image()

    return write_stills(record.arrays["phase"], picture, out)


def write_video(
    plan: Plan,
    record: Record,
    out: Path,
    frames_per_second: float | None = None,
    size: tuple[int, int] = FILM_SIZE,
    models: str = "generated",
    goals: Sequence[Placed] = (),
) -> Path:
    """Write the run as an animation in real time, with forces, paths and a caption.
    Return its path.

    The suffix of ``out`` determines the format and the usual rate: .mp4, .webp or .gif.
    A folder gets run.mp4, or run.webp without av. ``size`` is (width, height) [pixels],
    ``goals`` are as in ``Playback``. Raises SimulationError if this machine cannot
    render, or for another format.
    """
    out = film_path(out)
    rate = frames_per_second or film_rate(out)
    renderer = FrameRenderer(plan, record, size, models, goals)
    overlay = Overlay(renderer.playback, renderer.view, size)
    ticks = film_ticks(record.arrays["time"], rate)
    told = run_timeline(plan, record, np.array(ticks))
    title = f"{plan.task.name}: {', '.join(record.modes)}"
    meanings = legend(overlay.contacts.entries())

    def picture(frame: int) -> Any:
        canvas = Canvas(renderer.image_at(ticks[frame]))
        overlay.draw(canvas, ticks[frame])
        canvas.paste(meanings)
        caption(canvas, title, told, frame)
        return canvas.image()

    return write_film(len(ticks), picture, out, rate)


def _render_parameters(support: Support) -> RenderEngineVtkParams:
    """Background and lights: one light on the support, and a weaker one at the camera."""
    above = LightParameter(
        type="directional", frame="world", direction=_light(support), intensity=0.75
    )
    ahead = LightParameter(
        type="directional", frame="camera", direction=[0.1, 0.2, 1.0], intensity=0.6
    )
    return RenderEngineVtkParams(default_clear_color=BACKGROUND, lights=[above, ahead])


def _light(support: Support) -> list[float]:
    """Direction of the light in the world. The light falls onto the support from above."""
    frame = support.frame
    along = LIGHT if frame.faces_up else STEEP_LIGHT
    return list(frame.direction(along))


def look_at(view: View) -> RigidTransform:
    """X_WC of a camera (z forward, x right, y down) with an upright picture."""
    x, y, z = axes(view.position - view.target)
    return RigidTransform(RotationMatrix(np.column_stack([x, y, z])), view.position)


def egl_problem() -> str | None:
    """Reason why EGL has no device to render on, or None.

    Also None on a system without EGL. The check is needed because the renderer ends the
    process if there is no device.
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
