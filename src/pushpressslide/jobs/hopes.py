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
    centre of mass, and with the most favourable frictions and masses that they allow.
    """
    yield task
    planned = task.belief.planned_for_errors
    if planned:
        yield replace(task, dares=True)
    likeliest = _likeliest(task)
    if likeliest is not None:
        yield replace(task, belief=likeliest, dares=True)
    if planned or task.belief.mass_error > 0.0:
        for belief in _favourable(task, likeliest):
            yield replace(task, belief=belief, dares=True)


def _likeliest(task: Task) -> Belief | None:
    """Belief in the likeliest centre of mass. None if it is sure."""
    error = task.belief.center_error
    if error == 0.0:
        return None
    center = task.scene.body.likeliest_center(error)
    return replace(task.belief, center_of_mass=center)


def _favourable(task: Task, likeliest: Belief | None) -> Iterator[Belief]:
    """Yield beliefs in more grip, by the errors that the task states, and in less drag
    that rules nothing out, or more that can be felt. After each comes the same with the
    ``likeliest`` centre of mass.
    """
    error = task.belief.friction_error
    lighter, heavier = (1.0 + sign * task.belief.mass_error for sign in (-1.0, 1.0))
    full = task.full_belief
    _, most = FRICTION
    assert full.support_friction is not None
    assert full.contact_friction is not None
    assert full.mass is not None
    grip = min((1.0 + error) * full.contact_friction, most)
    tried: list[tuple[float, float]] = []
    for drag, weight in ((1.0 - error, lighter), (1.0 - error, 1.0), (1.0, heavier)):
        amounts = (drag * full.support_friction, weight * full.mass)
        if amounts in tried:
            continue
        tried.append(amounts)
        for belief in (task.belief, likeliest):
            if belief is not None:
                support, mass = amounts
                yield replace(
                    belief, support_friction=support, contact_friction=grip, mass=mass
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
