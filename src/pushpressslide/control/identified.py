"""What the controller identified in a run, beside the belief, for the result."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from pushpressslide.control.estimator import EstimatorState
from pushpressslide.core import margins
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Scene
from pushpressslide.identification.drag import Drag
from pushpressslide.identification.parameter import Parameter


class Coordinate(NamedTuple):
    """Identified coordinate of the centre of mass in G."""

    value: float  # [m]
    deviation: float  # [m] standard deviation
    direction: Point  # in G


class Identified(NamedTuple):
    """Values identified in the placements of a run. None: not identified."""

    drag: Drag | None = None
    center: Coordinate | None = None

    def better(self, other: Identified) -> Identified:
        """The surer one of each value."""
        drag = self.drag
        center = self.center
        if drag is None or (other.drag and other.drag.deviation < drag.deviation):
            drag = other.drag
        if center is None or (
            other.center and other.center.deviation < center.deviation
        ):
            center = other.center
        return Identified(drag, center)

    def figures(self, scene: Scene) -> dict[str, Any]:
        """Entry ``parameters`` of the record: each value beside that believed of the
        ``scene``. Empty if nothing is identified.
        """
        parameters = {}
        if self.drag is not None:
            product = scene.body.mass * scene.support.friction
            unit = product / scene.max_friction()
            mean = unit * self.drag.mean
            deviation = unit * self.drag.deviation
            parameters["mass_times_friction"] = Parameter(mean, deviation, product)
        if self.center is not None:
            value, deviation, direction = self.center
            before = _along(scene.body.center_of_mass, direction)
            center = Parameter(value, deviation, before, direction)
            parameters["center_of_mass"] = center
        figures = {name: one.figures for name, one in parameters.items()}
        return {"parameters": figures} if figures else {}


def identified(state: EstimatorState, query: MotionQuery) -> Identified:
    """What an estimator has identified in a placement that began with ``query``."""
    identifier = state.prediction.center
    aside = None if identifier is None else identifier.aside(state.center)
    if aside is None:
        return Identified()
    X_GB = query.X_GB
    direction = X_GB.rotate(aside.across)
    origin = _along(X_GB.position, direction)
    center = Coordinate(origin + aside.value, aside.deviation, direction)
    if state.prediction.drag is None:
        return Identified(None, center)
    zeroed = math.sqrt(query.motion.control_period / margins.ARM.first_look)
    drag = Drag.of_windows(
        state.drag,
        aside.deviation / state.prediction.drag.rho,
        zeroed * query.sensing.force_noise,
    )
    return Identified(drag, center)


def _along(point: Point, direction: Point) -> float:
    return point[0] * direction[0] + point[1] * direction[1]
