"""Beliefs that a task's uncertainty allows, for tasks that the stated one makes
infeasible.

A motion that only might fail is tried: a recovery can mend it, a refusal cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple, TypeVar

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.scene import Belief
from pushpressslide.core.task import Task
from pushpressslide.jobs.stages import StageOptions, StageRunner
from pushpressslide.jobs.tiers import FRICTION, drawn_world

Planned = TypeVar("Planned")


def hopes(task: Task) -> Iterator[Task]:
    """Yield the task as it is, planned without its uncertainties, with the likeliest
    centre of mass, and with the most favourable frictions and masses that they allow.
    """
    yield task
    # planned for no errors, the task is what it would be without them
    tried = [] if task.belief.planned_for_errors else [task.full_belief]
    for belief in _beliefs(task):
        hope = replace(task, belief=belief, dares=True)
        if hope.full_belief not in tried:
            tried.append(hope.full_belief)
            yield hope


def _beliefs(task: Task) -> Iterator[Belief]:
    """Yield beliefs within the errors of that of the ``task``."""
    centers = [task.belief]
    error = task.belief.center_error
    if error > 0.0:
        likeliest = task.scene.body.likeliest_center(error)
        centers.append(replace(task.belief, center_of_mass=likeliest))
    if task.belief.planned_for_errors:
        yield from centers
    if task.belief.states_errors:
        for amounts in _favourable(task):
            for belief in centers:
                yield amounts.put_into(belief)


class _Amounts(NamedTuple):
    """Frictions and mass that a belief may have."""

    support: float
    contact: float
    mass: float  # [kg]

    def put_into(self, belief: Belief) -> Belief:
        """The ``belief`` with these amounts."""
        return replace(
            belief,
            support_friction=self.support,
            contact_friction=self.contact,
            mass=self.mass,
        )


def _favourable(task: Task) -> list[_Amounts]:
    """Amounts within the errors that the ``task`` states, all with the most grip: the
    least drag, the least friction of the support alone, and a heavier object, which is
    felt before it slides.
    """
    error = task.belief.friction_error
    full = task.full_belief
    _, most = FRICTION
    assert full.support_friction is not None
    assert full.contact_friction is not None
    assert full.mass is not None
    grip = min((1.0 + error) * full.contact_friction, most)
    least = (1.0 - error) * full.support_friction
    lighter, heavier = (
        (1.0 + sign * task.belief.mass_error) * full.mass for sign in (-1.0, 1.0)
    )
    return [
        _Amounts(least, grip, lighter),
        _Amounts(least, grip, full.mass),
        _Amounts(full.support_friction, grip, heavier),
    ]


def hopeful_runner(task: Task, options: StageOptions) -> StageRunner:
    """Runner of the first of ``hopes`` that is feasible, in the world of the task's tier.

    Raises InfeasibleTaskError, that of the task as it is, if none is.
    """
    world = drawn_world(task, options.seed, options.engine)
    return of_first_hope(world, lambda hope: StageRunner(hope, options))


def of_first_hope(task: Task, plan: Callable[[Task], Planned]) -> Planned:
    """Result of ``plan`` for the first of ``hopes`` that is feasible.

    Raises InfeasibleTaskError, that of the task as it is, if none is.
    """
    refused: InfeasibleTaskError | None = None
    for hope in hopes(task):
        try:
            return plan(hope)
        except InfeasibleTaskError as error:
            refused = refused or error
    assert refused is not None
    raise refused
