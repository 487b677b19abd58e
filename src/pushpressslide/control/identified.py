"""What the controller identified in a run, beside the belief, for the result."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.estimator import EstimatorState
from pushpressslide.control.felt_center import felt_center
from pushpressslide.control.sightings import TURNS_TELL
from pushpressslide.core import margins
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import along
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import ARM_NAMES, Scene
from pushpressslide.identification.center import AXLE, Aside
from pushpressslide.identification.drag import Drag
from pushpressslide.identification.parameter import Parameter
from pushpressslide.identification.running_mean import RunningMean
from pushpressslide.identification.turning import TurnState

LEAST_PICTURES = 10
"""Smallest number of pictures whose scatter gives an interval."""
YIELD = 6e-4
"""Standard deviation [m] of how deep a tip sinks into a face: 1 mm in Drake, 0.1 mm in
MuJoCo.
"""
MOST_UNSURE = 0.5  # largest standard deviation of a rho, as a share of it
NOTHING: Mapping[str, Parameter] = MappingProxyType({})


class Identified(NamedTuple):
    """Parameters identified in the placements of a run, by their names in result.json."""

    parameters: Mapping[str, Parameter] = NOTHING

    def better(self, other: Identified) -> Identified:
        """The surer one of each parameter."""
        surer = dict(self.parameters)
        for name, parameter in other.parameters.items():
            known = surer.get(name)
            if known is None or parameter.deviation < known.deviation:
                surer[name] = parameter
        return Identified(surer)

    def knowing(self, name: str, parameter: Parameter) -> Identified:
        """The same with a ``parameter`` of a ``name``."""
        return Identified({**self.parameters, name: parameter})

    def without(self, name: str) -> Identified:
        """The same without the parameter of a ``name``."""
        kept = {one: self.parameters[one] for one in self.parameters if one != name}
        return Identified(kept)

    @property
    def figures(self) -> dict[str, Any]:
        """Entry ``parameters`` of the record. Empty if nothing is identified."""
        figures = {name: one.figures for name, one in self.parameters.items()}
        return {"parameters": figures} if figures else {}


def identified(
    state: EstimatorState, query: MotionQuery, planned: Segment, belief: Scene
) -> Identified:
    """What an estimator has identified in a placement.

    The placement began with ``query`` and the ``planned`` segment. ``belief`` is the
    scene before the run.
    """
    aside = _aside(state)
    found = {
        "mass_times_friction": _mass_times_friction(state, query, belief, aside),
        "center_of_mass": _center_of_mass(state, query, planned, belief, aside),
        "pose_delay": _pose_delay(state.sightings.delay, query),
        "rho": _rho(state.sightings.turns, query, planned, belief),
        **_tip_offsets(state.sightings.depths, query, planned),
    }
    return Identified({name: one for name, one in found.items() if one is not None})


def _aside(state: EstimatorState) -> Aside | None:
    """Coordinate of the centre of mass in B, if it is identified."""
    identifier = state.prediction.center
    return None if identifier is None else identifier.aside(state.center)


def _center_of_mass(
    state: EstimatorState,
    query: MotionQuery,
    planned: Segment,
    belief: Scene,
    aside: Aside | None,
) -> Parameter | None:
    """Coordinate [m] of the centre of mass across the line to the contact, which may be
    beside the followed one, or across the force of two pushes.
    """
    if len(planned.contacts) > 1:
        prior = CenterBelief.before_run(belief)
        followed = planned if state.filtered is None else state.filtered.segment
        felt = felt_center(state.felt, followed, query, prior)
        return None if felt is None else felt.coordinate
    if aside is None:
        return None
    X_GB = query.X_GB
    direction = X_GB.rotate(aside.across)
    value = along(X_GB.position, direction) + aside.value
    before = along(belief.body.center_of_mass, direction)
    beside, unsure = 0.0, 0.0
    if state.center.filtered:
        filtered = state.filtered
        if filtered is None or not filtered.tells_line:
            return None
        first = filtered.segment.contacts[0]
        radius = query.scene.robots[first.arm].tip_radius
        beside, unsure = filtered.touch_offset(direction, X_GB, radius)
    deviation = math.hypot(aside.deviation, unsure)
    return Parameter(value + beside, deviation, before, direction, aside.at_bound)


def _mass_times_friction(
    state: EstimatorState, query: MotionQuery, belief: Scene, aside: Aside | None
) -> Parameter | None:
    """Mass times support friction [kg], by the drag of a push."""
    identifier = state.prediction.drag
    if aside is None or identifier is None:
        return None
    zeroed = math.sqrt(query.motion.control_period / margins.ARM.first_look)
    lever = aside.deviation / identifier.rho
    drag = Drag.of_windows(state.drag, lever, zeroed * query.sensing.force_noise)
    if drag is None:
        return None
    product = belief.body.mass * belief.support.friction
    unit = product / belief.max_friction()
    return Parameter(unit * drag.mean, unit * drag.deviation, product)


def _pose_delay(delay: RunningMean, query: MotionQuery) -> Parameter | None:
    """Mean delay [s] of pictures, known to a control period at best."""
    if delay.samples < LEAST_PICTURES:
        return None
    sensing = query.sensing
    before = sensing.delay_of_pose + 0.5 * sensing.pose_jitter
    quantised = query.motion.control_period / math.sqrt(12.0)
    return Parameter(delay.mean, math.hypot(delay.error, quantised), before)


def _rho(
    turns: TurnState, query: MotionQuery, planned: Segment, belief: Scene
) -> Parameter | None:
    """Rho [m] by the distance from the only contact to the virtual axle, which pictures
    of turns tell (docs/mechanics.md, sections 2 and 4.3).
    """
    drive = planned.drive
    reach = turns.reach()
    if reach is None or not isinstance(drive, TURNS_TELL):
        return None
    if not query.resisted_by_friction_alone:
        return None
    (contact,) = planned.contacts
    ahead = abs(planned.X_VB.apply(contact.point)[0])
    measured = reach.value
    if contact.kind == "side":  # of the contact, not of the tip's centre behind it
        radius = query.scene.robots[contact.arm].tip_radius
        ex, ey = reach.direction
        measured += radius * (ex * contact.normal[0] + ey * contact.normal[1])
    lever = abs(drive.car.lever)
    square = drive.rho * drive.rho + lever * (measured - ahead)
    if square <= 0.0:
        return None
    rho = math.sqrt(square)
    # the lever of a press is a part of its distance from the centre of mass
    unsure = query.scene.center_error * lever / math.hypot(*contact.point)
    errors = (
        0.5 * lever * reach.deviation / rho,
        0.5 * (square / lever - lever) * unsure / rho,
        0.5 * AXLE * rho,
    )
    deviation = math.hypot(*errors)
    if deviation > MOST_UNSURE * rho:
        return None
    return Parameter(rho, deviation, belief.rho or drive.rho)


def _tip_offsets(
    depths: tuple[RunningMean, ...], query: MotionQuery, planned: Segment
) -> dict[str, Parameter]:
    """Offset [m] of each pushing tip along its contact's normal in G: the error of the
    tip, less that of the pictures.
    """
    offsets = {}
    for depth, contact in zip(depths, planned.contacts, strict=False):
        if depth.samples < LEAST_PICTURES:
            continue
        name = "tip_offset"
        if len(query.scene.robots) > 1:
            name = f"tip_offset_{ARM_NAMES[contact.arm]}"
        unsure = math.hypot(depth.error, YIELD)
        offsets[name] = Parameter(depth.mean, unsure, 0.0, contact.normal)
    return offsets
