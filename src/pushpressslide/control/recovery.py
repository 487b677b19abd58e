"""Recovery: a plan for the remaining task from the measured pose, with identified
parameters and any allowed mode and contacts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.core import margins
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.motion import Limits
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import ReasonCode
from pushpressslide.core.scene import Scene
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Restart, Task
from pushpressslide.identification.parameter_estimates import (
    ParameterEstimates,
    dragged_friction,
)
from pushpressslide.identification.tip_friction import TipFriction
from pushpressslide.modes.base import ENOUGH
from pushpressslide.planning.pressed.harder import slid_friction
from pushpressslide.selection.placement_planner import (
    FailedPlacement,
    OtherPlacements,
    PlacementPlanner,
)
from pushpressslide.selection.solve import nudged, solved

RECOVERABLE: frozenset[ReasonCode] = frozenset(
    {
        "goal_missed",
        "contact_lost",
        "force_limit",
        "torque_limit",
        "joint_limit",
        "reference_jump",
        "collision",
    }
)
"""Failures after which arms that have drawn back can start again."""

OF_ARMS: frozenset[ReasonCode] = frozenset({"torque_limit", "joint_limit", "collision"})
"""Failures of the arms, which the same contacts would repeat."""


def restart(
    scene: Scene,
    segment: Segment,
    pose: Pose2,
    estimates: ParameterEstimates,
    center: CenterBelief | None = None,
) -> Restart:
    """Start of the remaining task in ``scene``.

    The task was interrupted in ``segment``, with the object at ``pose``, X_WG. What is
    believed of its ``center`` of mass replaces that of the estimates.
    """
    load = sum(contact.load for contact in segment.contacts)
    friction = dragged_friction(scene, load, estimates.drag)
    rho = scene.rho
    if rho is not None and estimates.rho is not None:
        rho = estimates.rho
    state = WorldState({OBJECT: pose})
    if center is not None:
        place, error = center.place, center.error
        return Restart(state, segment.leg, place, friction, rho, center_error=error)
    x, y = scene.body.center_of_mass
    dx, dy = estimates.center
    return Restart(state, segment.leg, (x + dx, y + dy), friction, rho)


def after_slides(
    start: Restart, scene: Scene, segment: Segment, friction: TipFriction | None = None
) -> Restart:
    """The ``start`` after a ``segment`` whose contacts slid: the tip has less friction
    than believed. Presses slide as well if the support has more: each has half of the
    error, unless the tips' ``friction`` was measured as they slid.
    """
    share = margins.SLID_SHARE
    if any(contact.kind == "side" for contact in segment.contacts):
        return replace(start, contact_friction=share * scene.contact_friction)
    if friction is not None:
        return _after_known_slides(start, scene, friction)
    load = sum(contact.load for contact in segment.contacts)
    ratio = slid_friction(scene, load) / scene.contact_friction
    share = min(math.sqrt(ratio), share)
    return replace(
        start,
        contact_friction=share * scene.contact_friction,
        support_friction=start.support_friction / share,
    )


def _after_known_slides(start: Restart, scene: Scene, friction: TipFriction) -> Restart:
    """The ``start`` after slides that told the tips' ``friction``. Where they dragged
    with more than the support resists as believed, the support has more friction. On a
    slope they drag with the weight as well.
    """
    support = start.support_friction
    resisted = scene.max_friction(friction.load)
    if friction.drag > resisted and not any(scene.weight_along):
        least = scene.support.friction * friction.drag / resisted
        support = max(support, least / margins.SLID_SHARE)
    return replace(start, contact_friction=friction.value, support_friction=support)


def after_force_limit(start: Restart, limits: Limits) -> Restart:
    """The ``start`` after contacts that reached the force limit: plans have less."""
    share = margins.LIMITED_SHARE * limits.planned_share
    return replace(start, planned_share=share)


def planned_anew(
    plan: Plan,
    restart_state: Restart,
    prepare: Callable[[], PlacementPlanner],
    *,
    bounded: bool = False,
    before: Task | None = None,
) -> Plan:
    """Plan for the remaining task of ``plan``, made by the empty placement planner that
    ``prepare`` returns. ``before`` is the task as believed before the run (default: that
    of ``plan``).

    A short push that ends within the goal's tolerances is tried first, then the task's
    own mode and contacts, then any others. If none gives a plan, the identified
    friction is replaced by the believed friction, since a jammed object seems to have
    more friction than it has; then the errors of the belief are ignored; then the
    support has the least friction that they allow; then the centre of mass is the
    likeliest one. Where a slide has told the tips' friction, the errors are ignored
    before all this, first with that centre; then the support alone has more friction;
    then the slide is ignored. After a force limit, plans that lead on with less force
    are tried first.

    The arms wait meanwhile: of these further beliefs, sequences of motions are searched
    for the believed friction without errors only, and after all others. No belief has
    less friction than the support is known to have, unless no other gives a plan and
    they need not be ``bounded``.
    Raises InfeasibleTaskError if there is no plan.
    """
    task = plan.task
    before = before or task
    free = replace(restart_state, free=True)
    planner = prepare()
    short = nudged(planner, _remaining(plan, free))
    if short is not None:
        return short
    further = [(one, False) for one in _further(task, free, before)]
    tried: list[tuple[Task, bool]] = []
    refused: InfeasibleTaskError | None = None
    beliefs = [
        (restart_state, True),
        (free, True),
        *further,
        (_daring(task, free, before), True),
    ]
    if not bounded:  # the object may have been held by something else
        free = replace(free, least_friction=0.0)
        unbounded = [free, *_further(task, free, before)]
        beliefs += [(one, False) for one in unbounded]
    for one, sequences in beliefs:
        rest = task.resumed(one)
        if (rest, True) in tried or (rest, sequences) in tried:
            continue
        if tried:
            planner = prepare()
        tried.append((rest, sequences))
        try:
            return _planned(plan, one, planner, sequences)
        except InfeasibleTaskError as error:
            refused = refused or error
    assert refused is not None
    raise refused


def planned_otherwise(
    plan: Plan,
    restart_state: Restart,
    prepare: Callable[[], PlacementPlanner],
    failed: Sequence[FailedPlacement],
    *,
    before: Task | None = None,
) -> Plan:
    """Plan for the remaining task, as from ``planned_anew``, that does not begin like
    a ``failed`` placement, if there is another.

    Raises InfeasibleTaskError if there is no plan.
    """

    def prepare_others() -> PlacementPlanner:
        """Empty planner of other placements."""
        return OtherPlacements(prepare(), failed)

    try:
        return planned_anew(
            plan, restart_state, prepare_others, bounded=True, before=before
        )
    except InfeasibleTaskError:
        return planned_anew(plan, restart_state, prepare, before=before)


def _further(task: Task, free: Restart, before: Task) -> list[Restart]:
    """Further beliefs from which a plan may lead on, if there is none from ``free``.
    ``before`` is the task as believed before the run.
    """
    further: list[Restart] = []
    whole = None
    if before.limits.planned_share != task.limits.planned_share:
        whole = before.limits.planned_share
    if free.planned_share is not None:
        further.append(replace(free, planned_share=whole))
    if free.contact_friction is not None:
        dared = replace(free, dares=True)
        kept = replace(dared, contact_friction=_tip_friction(task, before))
        share = min(1.0, free.contact_friction / before.scene.contact_friction)
        alone = replace(kept, support_friction=free.support_friction / share)
        further += [_likeliest(task, dared), dared, alone, kept]
    dared = _daring(task, free, before)
    least = (1.0 - before.belief.friction_error) * before.scene.support.friction
    weakest = replace(dared, support_friction=least)
    further += [replace(dared, dares=free.dares), dared]
    if free.planned_share is not None:  # what slides at best needs all the force
        further.append(replace(weakest, planned_share=whole))
    return [*further, weakest, _likeliest(task, dared)]


def _likeliest(task: Task, dared: Restart) -> Restart:
    """The belief of ``dared`` with the likeliest centre of mass."""
    error = dared.center_error
    if error is None:
        error = task.belief.center_error
    body = replace(task.object, center_of_mass=dared.center_of_mass)
    return replace(dared, center_of_mass=body.likeliest_center(error))


def _daring(task: Task, free: Restart, before: Task) -> Restart:
    """The belief ``before`` the run, without its errors, from the place of ``free``."""
    return replace(
        free,
        contact_friction=_tip_friction(task, before),
        support_friction=before.scene.support.friction,
        dares=True,
    )


def _tip_friction(task: Task, before: Task) -> float | None:
    """Friction of the tips as believed ``before`` the run. None if that of ``task`` is."""
    believed = before.scene.contact_friction
    return None if believed == task.scene.contact_friction else believed


def _planned(
    plan: Plan, restart_state: Restart, planner: PlacementPlanner, sequences: bool
) -> Plan:
    empty = _remaining(plan, restart_state)
    return solved(planner, empty, ENOUGH, sequences=sequences).plan


def _remaining(plan: Plan, restart_state: Restart) -> Plan:
    """Plan for the remaining task of ``plan``, without segments."""
    if plan.from_search:  # other motions than those found before may lead on
        restart_state = replace(restart_state, leg=0, legs=())
    rest = plan.task.resumed(restart_state)
    return Plan(rest, (), restart_state, plan.from_search, plan.may_push)
