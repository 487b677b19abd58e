"""Picture of a scene from a fixed camera. Only the part that changes is rendered again."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    FrameId,
    QueryObject,
    RenderCameraCore,
    Role,
    SceneGraphInspector,
)
from pydrake.math import RigidTransform
from pydrake.systems.sensors import CameraInfo

from pushpressslide.core.arrays import Array
from pushpressslide.view.drake.camera import FIELD

RENDERER = "frames"
CLIPPING = ClippingRange(0.05, 20.0)  # [m]
EDGE = 3  # [pixels] about what has moved
SMALLEST_MOVE = 0.5  # [pixels] that is rendered anew

Pixels = NDArray[np.uint8]
Box = tuple[int, int, int, int]
"""Left, upper, right and lower edge [pixels]."""


class Picture:
    """The last picture of a scene, by the renderer ``RENDERER``."""

    def __init__(self, size: tuple[int, int], X_WC: RigidTransform) -> None:
        """Start without a picture. ``size`` is (width, height) [pixels]."""
        self._size = size
        self._X_WC = X_WC
        self._focal = 0.5 * size[1] / math.tan(0.5 * FIELD)
        self._corners: dict[FrameId, Array] = {}
        self._drawn: dict[FrameId, Array] = {}
        self._pixels: Pixels = np.zeros((size[1], size[0], 3), dtype=np.uint8)

    def update(self, query: QueryObject) -> Pixels:
        """Picture (height, width, 3) of the scene in its present state. The next update
        changes it in place.
        """
        box = self._changed(query)
        if box is not None:
            left, upper, right, lower = box
            self._pixels[upper:lower, left:right] = self._render(query, box)
        return self._pixels

    def _changed(self, query: QueryObject) -> Box | None:
        """Part of the picture in which something has moved. None if nothing has."""
        width, height = self._size
        if not self._corners:
            self._corners = _corners(query.inspector())
            self._drawn = {
                frame: self._places(query, frame, points)
                for frame, points in self._corners.items()
            }
            return (0, 0, width, height)
        boxes = []
        for frame, points in self._corners.items():
            drawn = self._drawn[frame]
            places = self._places(query, frame, points)
            if np.abs(places - drawn).max() > SMALLEST_MOVE:
                self._drawn[frame] = places
                boxes += [places, drawn]
        if not boxes:
            return None
        # a camera of Drake has the middle of its view in its picture
        middle = 0.5 * np.array([self._size])
        places = np.concatenate([*boxes, middle - 1.0, middle + 1.0])
        low = np.floor(places.min(axis=0)) - EDGE
        high = np.ceil(places.max(axis=0)) + EDGE
        left, upper = np.clip(low, 0, self._size).astype(int).tolist()
        right, lower = np.clip(high, 0, self._size).astype(int).tolist()
        return (left, upper, right, lower)

    def _places(self, query: QueryObject, frame: FrameId, points: Array) -> Array:
        """Pixels (N, 2) of ``points`` (N, 3) [m] in a frame.

        For a body beside the camera they are far outside the picture, on all sides.
        """
        X_CF = self._X_WC.inverse().multiply(query.GetPoseInWorld(frame))
        x, y, depth = X_CF.multiply(points.T)
        middle = 0.5 * np.array(self._size)
        if depth.min() < CLIPPING.near():
            far = np.sign(points[:, :2]) * 10.0 * middle
            return np.asarray(far + np.column_stack([x, y]) * self._focal)
        return np.asarray(
            middle + self._focal * np.column_stack([x, y]) / depth[:, None]
        )

    def _render(self, query: QueryObject, box: Box) -> Pixels:
        left, upper, right, lower = box
        width, height = self._size
        intrinsics = CameraInfo(
            right - left,
            lower - upper,
            self._focal,
            self._focal,
            0.5 * width - 0.5 - left,
            0.5 * height - 0.5 - upper,
        )
        core = RenderCameraCore(RENDERER, intrinsics, CLIPPING, RigidTransform())
        world = query.inspector().world_frame_id()
        camera = ColorRenderCamera(core, False)
        seen = query.RenderColorImage(camera, world, self._X_WC)
        return np.asarray(seen.data[:, :, :3])


def _corners(inspector: SceneGraphInspector) -> dict[FrameId, Array]:
    """Corners (N, 3) [m] of boxes about everything that renderers show of each frame."""
    out: dict[FrameId, list[Array]] = {}
    for geometry in inspector.GetAllGeometryIds(Role.kPerception):
        box = inspector.GetObbInGeometryFrame(geometry)
        if box is None:
            continue
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        X_FB = inspector.GetPoseInFrame(geometry).multiply(box.pose())
        points = X_FB.multiply((signs * box.half_width()).T).T
        out.setdefault(inspector.GetFrameId(geometry), []).append(points)
    return {frame: np.concatenate(parts) for frame, parts in out.items()}
