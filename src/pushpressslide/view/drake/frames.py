"""Pictures of a run, rendered without a display."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops
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
from pushpressslide.view.film import CLOSE, STILL_SIZE, write_stills

OPAQUE = 0.999  # opacity from which on nothing is mixed
COARSE = 3  # pixels across a pixel of a coarse picture
COARSEST = 0.5  # opacity up to which an arm may be coarse
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
        coarse: bool = False,
    ) -> None:
        """Set up the scene and a camera of ``size`` (width, height) [pixels]. ``goals``
        are as in ``Playback``. ``coarse``: faint arms are rendered at a smaller size.

        Raises SimulationError if this machine cannot render.
        """
        problem = egl_problem()
        if problem:
            raise _cannot_render(problem)
        self._new_playback = partial(Playback, plan, record, models, goals)
        self._size = size
        self._arms: Arms = tuple(range(len(plan.task.robots)))
        self._coarse = coarse
        self._scenes: dict[Arms, _Scene] = {}
        self.playback = self._new_playback()
        width, height = size
        self.aim(contact_view(self.playback, FIELD, width / height))

    def aim(self, view: View) -> None:
        """Take pictures from another view."""
        self.view = view
        self._opacity = ArmOpacity(self.playback, view.position)
        self._pictures: dict[tuple[Arms, int], Picture] = {}

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

    def _mixed(
        self, tick: int, opacity: Sequence[float], shown: Arms, part: int = 1
    ) -> Image.Image:
        """Picture with the arms ``shown``, the first ones at their ``opacity``, at a
        ``part`` of its width. Pictures without and with an arm that is seen through are
        mixed.
        """
        if not opacity:
            return Image.fromarray(self._picture(tick, shown, part))
        *others, share = opacity
        if share > OPAQUE:
            return self._mixed(tick, others, shown, part)
        hidden = tuple(arm for arm in shown if arm != len(others))
        without = self._mixed(tick, others, hidden, part)
        if not self._coarse or part > 1 or share > COARSEST:
            full = self._mixed(tick, others, shown, part)
            return Image.blend(without, full, share)
        return _blend_coarse(
            without,
            self._mixed(tick, others, hidden, COARSE),
            self._mixed(tick, others, shown, COARSE),
            share,
        )

    def _picture(self, tick: int, arms: Arms, part: int) -> NDArray[np.uint8]:
        """Picture with these arms. Its scene is made when first needed."""
        if arms not in self._scenes:
            self._scenes[arms] = _Scene(self._new_playback(), arms)
        key = (arms, part)
        if key not in self._pictures:
            width, height = self._size
            size = (round(width / part), round(height / part))
            self._pictures[key] = Picture(size, look_at(self.view))
        return self._scenes[arms].image_at(tick, self._pictures[key])


def _blend_coarse(
    picture: Image.Image, without: Image.Image, full: Image.Image, share: float
) -> Image.Image:
    """``picture`` with what is in ``full`` and not in ``without``, at an opacity
    ``share``. These two are smaller.
    """
    box = ImageChops.difference(without, full).getbbox()
    if box is None:
        return picture
    across = picture.width / full.width
    down = picture.height / full.height
    left, upper, right, lower = box
    place = (
        round(left * across),
        round(upper * down),
        round(right * across),
        round(lower * down),
    )
    size = (place[2] - place[0], place[3] - place[1])
    differ = ImageChops.difference(without.crop(box), full.crop(box)).convert("L")
    mask = differ.point([0] + [round(255 * share)] * 255)
    linear = Image.Resampling.BILINEAR
    picture.paste(full.resize(size, linear, box), place, mask.resize(size, linear))
    return picture


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
