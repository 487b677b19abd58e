"""Least distance of two arms: distances of their capsules in closed form.

Drake's general distance query may not terminate for capsules deep inside each other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.geometry import Capsule, GeometryId, SceneGraphInspector, Sphere
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.robots.kinematics import arm_kinematics
from pushpressslide.sim.robot_models import add_robot


class Outline:
    """The capsules of one arm, from base to tip.

    Any other shape is replaced by the sphere about its bounding box.
    """

    def __init__(self, robot: Robot, index: int) -> None:
        """Read the shapes of the planning model."""
        plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
        instance = add_robot(plant, robot, index, collision=True).model_instance
        plant.Finalize()
        self._kin = arm_kinematics(robot)
        chain = self._kin.link_poses(self._kin.facts.home)
        inspector = scene_graph.model_inspector()
        self._links = []
        ends = []
        radii = []
        for i in plant.GetBodyIndices(instance):
            body = plant.get_body(i)
            if body.name() not in chain:
                continue
            for shape in plant.GetCollisionGeometriesForBody(body):
                self._links.append(body.name())
                axis, radius = _capsule(inspector, shape)
                ends.append(axis)
                radii.append(radius)
        self._ends = np.array(ends)
        self.radii = np.array(radii)

    def segments(self, postures: Array) -> Array:
        """Return the ends (k, m, 2, 3) [m] of the axes of m capsules in postures (k,
        n).
        """
        poses = self._kin.link_poses(postures)
        R, p = (
            np.stack([poses[link][i] for link in self._links], axis=1) for i in (0, 1)
        )
        out: Array = self._ends @ np.swapaxes(R, -1, -2) + p[:, :, None]
        return out


def _capsule(inspector: SceneGraphInspector, shape_id: GeometryId) -> tuple[Any, float]:
    """Return the ends of a capsule's axis in its body's frame [m], and its radius [m]."""
    shape = inspector.GetShape(shape_id)
    center = np.zeros(3)
    half = np.zeros(3)
    if isinstance(shape, Capsule):
        radius = shape.radius()
        half = np.array([0.0, 0.0, 0.5 * shape.length()])
    elif isinstance(shape, Sphere):
        radius = shape.radius()
    else:
        box = inspector.GetObbInGeometryFrame(shape_id)
        radius = float(np.linalg.norm(box.half_width()))
        center = box.center()
    X_BG = inspector.GetPoseInFrame(shape_id)
    return [X_BG @ (center - half), X_BG @ (center + half)], radius


def least_distance(
    one: Outline, other: Outline, postures: Array, others: Array, look: float
) -> float:
    """Return the least distance [m] of two arms over postures (k, n), or (1, n) of an
    arm that stands still.

    It is at most ``look``, and negative where the arms intersect.
    """
    a = one.segments(postures)
    b = other.segments(others)
    return float(_distances(a, b, one.radii, other.radii, look).min())


def pair_distances(
    one: Outline, other: Outline, postures: Array, others: Array, look: float
) -> Array:
    """Return the distances (k, j) [m], at most ``look``, of one arm in postures (k, n)
    and the other in postures (j, n), each with each.
    """
    a = np.repeat(one.segments(postures), len(others), axis=0)
    b = np.tile(other.segments(others), (len(postures), 1, 1, 1))
    out = _distances(a, b, one.radii, other.radii, look)
    return out.reshape(len(postures), len(others))


def _distances(
    one: Array, other: Array, radii: Array, other_radii: Array, look: float
) -> Array:
    """Return the least distances (k,) [m], at most ``look``, of capsules about axes
    (k, m, 2, 3) and others; either may be of one posture alone.
    """
    a, b = np.broadcast_arrays(one[:, :, None], other[:, None])
    reach = radii[:, None] + other_radii
    apart = np.linalg.norm((a - b).mean(axis=-2), axis=-1) - reach  # of the middles
    apart -= 0.5 * sum(
        np.linalg.norm(c[..., 1, :] - c[..., 0, :], axis=-1) for c in (a, b)
    )
    near = apart < look
    distances = np.full(near.shape, look)
    exact = (
        _segment_distance(a[near], b[near]) - np.broadcast_to(reach, near.shape)[near]
    )
    distances[near] = np.minimum(exact, look)
    out: Array = distances.min(axis=(-2, -1))
    return out


def _segment_distance(a: Array, b: Array) -> Array:
    """Return distances (...) [m] of segments (..., 2, 3), of which at least one is no
    point (Ericson, Real-Time Collision Detection, 5.1.9).
    """
    u = a[..., 1, :] - a[..., 0, :]
    v = b[..., 1, :] - b[..., 0, :]
    w = a[..., 0, :] - b[..., 0, :]
    uu = (u * u).sum(-1)
    vv = (v * v).sum(-1)
    uv = (u * v).sum(-1)
    uw = (u * w).sum(-1)
    vw = (v * w).sum(-1)
    tiny = 1e-12
    s = np.clip((uv * vw - uw * vv) / np.maximum(uu * vv - uv * uv, tiny), 0.0, 1.0)
    t = np.clip((uv * s + vw) / np.maximum(vv, tiny), 0.0, 1.0)
    s = np.clip((uv * t - uw) / np.maximum(uu, tiny), 0.0, 1.0)
    gap = w + s[..., None] * u - t[..., None] * v
    out: Array = np.sqrt((gap * gap).sum(-1))
    return out
