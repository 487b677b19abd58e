"""Beliefs that a task's uncertainty allows, for tasks that the stated one makes
infeasible.

A motion that only might fail is tried: a recovery can mend it, a refusal cannot.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.scene import Belief
from pushpressslide.core.task import Task
from pushpressslide.jobs.stages import StageOptions, StageRunner
from pushpressslide.jobs.tiers import FRICTION, drawn_world


def hopes(task: Task) -> Iterator[Task]:
    """Yield the task as it is, planned without its uncertainties, with the likeliest
    centre of mass, and with the most favourable frictions and mass that they allow.
    """
    yield task
    planned = task.belief.planned_for_errors
    if planned:
        yield replace(task, dares=True)
    error = task.belief.center_error
    if error > 0.0:
        center = task.scene.body.likeliest_center(error)
        belief = replace(task.belief, center_of_mass=center)
        yield replace(task, belief=belief, dares=True)
    if planned or task.belief.mass_error > 0.0:
        yield replace(task, belief=_favourable(task), dares=True)


def _favourable(task: Task) -> Belief:
    """Belief in less drag and more grip, by the errors that the task states."""
    error = task.belief.friction_error
    full = task.full_belief
    _, most = FRICTION
    assert full.support_friction is not None
    assert full.contact_friction is not None
    assert full.mass is not None
    return replace(
        task.belief,
        support_friction=(1.0 - error) * full.support_friction,
        contact_friction=min((1.0 + error) * full.contact_friction, most),
        mass=(1.0 - task.belief.mass_error) * full.mass,
    )


def hopeful_runner(task: Task, options: StageOptions) -> StageRunner:
    """Runner of the first of ``hopes`` that is feasible, in the world of the task's tier.

    Raises InfeasibleTaskError, that of the task as it is, if none is.
    """
    refused: InfeasibleTaskError | None = None
    for hope in hopes(drawn_world(task, options.seed, options.engine)):
        try:
            return StageRunner(hope, options)
        except InfeasibleTaskError as error:
            refused = refused or error
    assert refused is not None
    raise refused
