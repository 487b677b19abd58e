"""A support whose friction differs with place, speed and time, in Drake.

Drake has one friction for each pair of bodies. It is set in each control period to the
mean under the object's base, so that the force is right and the moment is that of an
even support.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pydrake.geometry import RoleAssign
from pydrake.systems.framework import Context

from pushpressslide.core.pose import Pose2
from pushpressslide.core.ridge import NAME as RIDGE
from pushpressslide.core.ridge import Ridge
from pushpressslide.core.task import Task
from pushpressslide.core.truth import refuse_truth
from pushpressslide.mechanics.ground import Ground
from pushpressslide.mechanics.surface_friction import SurfaceFrictions, partner_friction
from pushpressslide.sim.convert import planar_twist
from pushpressslide.sim.plane import SUPPORT
from pushpressslide.sim.scenes import DrakeScene
from pushpressslide.sim.surfaces import rigid_properties

RESOLUTION = 2
"""Of the rule for a mean over the base."""
CHANGED = 1e-4
"""Relative change of the friction from which it is set again."""
ROUGHEST = 1.99
"""Largest friction of the pair over that of the object's surface; 2 is the limit."""


class UnevenGround:
    """The friction of the support under the object of a running simulation."""

    def __init__(
        self, task: Task, seed: int, scene: DrakeScene, context: Context
    ) -> None:
        """Take the support of a ``scene`` with the diagram's ``context``."""
        frictions = SurfaceFrictions.of_task(task)
        plant = scene.plant
        self._ground = Ground.of_truth(task.truth, seed)
        self._frame = task.support.frame
        self._friction = task.support.friction
        self._own = frictions.object
        self._points, areas = task.object.shape.base_rule(RESOLUTION)
        self._weights = areas / areas.sum()
        first = scene.object.floating_velocities_start_in_v()
        self._velocity = plant.num_positions() + first
        self._graph = scene.scene_graph
        self._context = self._graph.GetMyMutableContextFromRoot(context)
        self._source = plant.get_source_id()
        inspector = self._graph.model_inspector()
        self._supports = [
            geometry
            for geometry in plant.GetCollisionGeometriesForBody(plant.world_body())
            if inspector.GetName(geometry).split("::")[-1] in (SUPPORT, RIDGE)
        ]
        self._set = self._friction

    def update(self, x: Sequence[float], pose: Pose2, time: float) -> None:
        """Set the friction for the plant's state ``x``, the object's X_WG and a time
        [s].
        """
        velocity = x[self._velocity : self._velocity + 6]
        twist = planar_twist(velocity, self._frame)
        factors = self._ground.under(self._points, pose, twist, time)
        wanted = self._friction * float(self._weights @ factors)
        pair = min(wanted, ROUGHEST * self._own)
        if abs(pair - self._set) <= CHANGED * self._set:
            return
        self._set = pair
        properties = rigid_properties(partner_friction(pair, self._own))
        for support in self._supports:
            self._graph.AssignRole(
                self._context, self._source, support, properties, RoleAssign.kReplace
            )


def refuse_ground(task: Task) -> None:
    """Raise TaskError for errors of the support or of the base that Drake does not
    have.
    """
    truth = task.truth
    source = task.source or task.name
    even = replace(truth, friction_direction=0.0, feet=0.0)
    refuse_truth(truth, even, source, "with engine drake")
    if task.support.region is None and task.support.opening is None:
        return
    plain = replace(
        truth,
        static_friction=1.0,
        friction_speed=0.0,
        friction_patches=0.0,
        friction_drift=0.0,
        bow=0.0,
    )
    refuse_truth(truth, plain, source, "with engine drake on a support with edges")
    Ridge.of_task(task)
