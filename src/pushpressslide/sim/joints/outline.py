"""How near two arms come to each other: distances of their capsules in closed form.

The engine's general search for the distance of two shapes may not end for capsules deep
inside each other.
"""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Capsule, Sphere
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.robots.kinematics import arm_kinematics
from pushpressslide.sim.robot_models import add_robot


class Outline:
    """The capsules of one arm, from base to tip; of other shapes the sphere about their
    bounding box.
    """

    def __init__(self, robot: Robot, index: int) -> None:
        """Read the shapes off the model used for planning."""
        plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
        instance = add_robot(plant, robot, index, collision=True).model_instance
        plant.Finalize()
        inspector = scene_graph.model_inspector()
        self._kin = arm_kinematics(robot)
        chain = self._kin.link_poses(self._kin.facts.home)
        self._links = []
        ends = []
        radii = []
        for i in plant.GetBodyIndices(instance):
            body = plant.get_body(i)
            for shape_id in (
                plant.GetCollisionGeometriesForBody(body)
                if body.name() in chain
                else ()
            ):
                shape = inspector.GetShape(shape_id)
                X_BG = inspector.GetPoseInFrame(shape_id)
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
                self._links.append(body.name())
                ends.append([X_BG @ (center - half), X_BG @ (center + half)])
                radii.append(radius)
        self._ends, self.radii = np.array(ends), np.array(radii)

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


def least_distance(
    one: Outline, other: Outline, postures: Array, others: Array, look: float
) -> float:
    """Return the least distance [m], at most ``look``, < 0 inside each other, of two
    arms in postures (k, n), or (1, n) for one that stands still.
    """
    a, b = np.broadcast_arrays(
        one.segments(postures)[:, :, None], other.segments(others)[:, None]
    )
    radii = one.radii[:, None] + other.radii
    apart = np.linalg.norm((a - b).mean(axis=-2), axis=-1) - radii  # of the middles
    apart -= 0.5 * sum(
        np.linalg.norm(c[..., 1, :] - c[..., 0, :], axis=-1) for c in (a, b)
    )
    near = apart < look
    distances = (
        _segment_distance(a[near], b[near]) - np.broadcast_to(radii, near.shape)[near]
    )
    return float(distances.min(initial=look))


def _segment_distance(a: Array, b: Array) -> Array:
    """Distances (...) [m] of segments (..., 2, 3), one of which has a length (Ericson,
    Real-Time Collision Detection, 5.1.9).
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
