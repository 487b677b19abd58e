"""Mode selection: every mode and placement that the robots allow, evaluated and ranked."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from typing import Any

from pushpressslide.core.plan import (
    Choice,
    Contact,
    MotionPath,
    Plan,
    same_places,
)
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.core.scene import ARM_NAMES
from pushpressslide.core.state import HeldContacts
from pushpressslide.core.task import Task
from pushpressslide.modes import MODES
from pushpressslide.modes.base import ENOUGH, Feasibility, Mode, ranking_key, search
from pushpressslide.planning.either_arm import nearest_arms
from pushpressslide.selection.clearance import path_refusal
from pushpressslide.selection.odds import ranked_by_odds

MANY = 3 * ENOUGH
"""Number of choices per mode that are evaluated if the first ones have no joint paths.
"""

Way = tuple[tuple[Contact, ...], tuple[MotionPath, ...]]
FALLS = Refusal(
    "falls",
    "the object falls when the arms let go: nothing carries it where the previous leg "
    "ends",
)
AT_GOAL = Refusal(SKIPPED, "the object is at its goal already")
ENDS = Refusal("no_continuation", "its contacts allow no continuation")


def select(task: Task, enough: int = 1) -> list[Choice]:
    """All choices for ``task``, the quickest feasible one first. Never empty.

    Joint paths are not checked here but in ``jobs.run.run``. A choice that cannot do
    the task has a refusal with the deciding number. Once ``enough`` choices of a mode
    are feasible, or too many are blocked, its other choices are skipped, and their
    refusals say why. With legs, choices are grouped by placement, in order; ``leg`` is
    the first leg of a placement. Raises TaskError for a task with several goals.
    """
    if Plan(task).at_goal:
        return choices_at_goal(task)
    return list(chain.from_iterable(placements(task.queries(), enough)))


def choices_at_goal(task: Task) -> list[Choice]:
    """Choices of all modes, skipped because the object is at its goal already."""
    names = MODES if task.modes is None else task.modes
    return [Choice(name, refusal=AT_GOAL) for name in names]


def placements(
    queries: Sequence[MotionQuery], enough: int = 1, first: int = 0
) -> list[list[Choice]]:
    """Choices for each placement of the arms, best first.

    ``queries`` are those of all legs. A leg for which the arms can keep their contacts
    becomes a further segment of the previous placement. Legs before ``first`` are
    already done.
    """
    parts = queries[first:]
    allowed = [set(part.modes or MODES) for part in parts]
    if any(before & after for before, after in pairwise(allowed)):
        # the next leg may need other contacts than the quickest ones
        enough = max(enough, ENOUGH)
    groups = [_select_leg(parts[0], first, enough)]
    for leg, part in enumerate(parts[1:], start=first + 1):
        ahead = _select_leg(part, leg, enough)
        lengthened = [_lengthened(choice, ahead) for choice in groups[-1]]
        if any(choice.feasible for choice in lengthened):
            groups[-1] = ranked_by_odds(queries, _ranked(lengthened))
            continue
        if not part.scene.carried(part.start):
            ahead = [choice.refused(choice.refusal or FALLS) for choice in ahead]
        groups.append(ahead)
    return groups


def _select_leg(leg_query: MotionQuery, leg: int, enough: int) -> list[Choice]:
    """All choices for one leg of a task, best first."""
    return [of_leg(choice, leg) for choice in _select(leg_query, enough)]


def evaluate_motion(
    query: MotionQuery, mode: str, held_contacts: HeldContacts | None
) -> list[Choice]:
    """Choices of a mode for one motion, best first. Only a few are evaluated.

    With ``held_contacts``, only these contacts are considered.
    """
    part = replace(query, modes=(mode,), from_search=True)
    return _select(part, 2, None if held_contacts is None else held_contacts.contacts)


def of_leg(choice: Choice, leg: int) -> Choice:
    """The choice, marked as one for a given leg of its task."""
    segments = tuple(replace(segment, leg=leg) for segment in choice.segments)
    return replace(choice, leg=leg, segments=segments)


def _lengthened(choice: Choice, ahead: list[Choice]) -> Choice:
    """The ``choice`` extended by the best of ``ahead`` with the same contacts.

    The result is infeasible if no choice continues with these contacts.
    """
    if not choice.feasible:
        return choice
    for after in ahead:
        same = after.mode == choice.mode and same_places(
            after.contacts, choice.contacts
        )
        if not (same and after.feasible):
            continue
        time = None
        # contacts are kept: only the time of the motion counts
        if choice.time is not None:
            time = choice.time + sum(s.profile.duration for s in after.segments)
        segments = (*choice.segments, *after.segments)
        return replace(choice, segments=segments, time=time)
    return choice.refused(ENDS)


def _ranked(choices: list[Choice]) -> list[Choice]:
    """The ``choices``, ranked. Choices of the same mode keep their order.

    Of equally quick modes, the one whose contacts squeeze the object least comes first.
    """
    squeeze: dict[str, float] = {}
    for choice in choices:
        squeeze.setdefault(choice.mode, contact_squeeze(choice))
    return sorted(choices, key=lambda c: (*ranking_key(c), squeeze[c.mode]))


def contact_squeeze(choice: Choice) -> float:
    """Fraction of the pushing forces that cancels if all side contacts push equally
    hard.
    """
    normals = [contact.normal for contact in choice.contacts if contact.kind == "side"]
    if not normals:
        return 0.0
    x, y = map(sum, zip(*normals, strict=True))
    return round(1.0 - math.hypot(x, y) / len(normals), 6)


def _select(
    query: MotionQuery, enough: int, held_contacts: tuple[Contact, ...] | None = None
) -> list[Choice]:
    """All choices for one motion, best first."""
    out: list[Choice] = []
    scene = query.scene
    arms = len(scene.arms)
    if query.motion.risk is not None:  # the quickest may have poor odds
        enough = max(enough, ENOUGH)
    for name in MODES if query.modes is None else query.modes:
        mode = MODES[name]
        if mode.arms > arms:
            text = f"needs {mode.arms} arm(s), the task has {arms}"
            if arms < len(scene.robots):
                text = f"needs {mode.arms} arm(s), motion.arm leaves {arms}"
            out.append(Choice(name, refusal=Refusal("arms", text, arms, mode.arms)))
        elif any(scene.weight_along) and not mode.carries_weight:
            text = (
                f"cannot hold an object on {scene.support.name}; support.kind must be "
                "table"
            )
            out.append(Choice(name, refusal=Refusal("support", text)))
        else:
            for part in _by_tip(query, mode):
                out += mode.choices(
                    part, enough, Feasibility(part, _blocks(part), held_contacts)
                )
    return ranked_by_odds((query,), _ranked(out))


def nudges(query: MotionQuery) -> list[Choice]:
    """Choices of short pushes that end within the goal's tolerances, best first."""
    out: list[Choice] = []
    arms = len(query.scene.arms)
    names = MODES if query.modes is None else query.modes
    for mode in (MODES[name] for name in names):
        if mode.arms <= arms:
            for part in _by_tip(query, mode):
                feasibility = Feasibility(part, _blocks(part))
                out += search(mode.nudges(part), ENOUGH, feasibility)
    return _ranked(out)


def _by_tip(query: MotionQuery, mode: Mode[Any]) -> list[MotionQuery]:
    """One query for each kind of tip with which ``mode`` may touch the object, the kind
    of the nearer arm first.

    Arms with equal tips share all results that depend only on the object.
    """
    tips = {(robot.tip_radius, robot.tip_length) for robot in query.scene.tips}
    if mode.arms > 1 or len(tips) == 1:
        return [query]
    return [
        query.moved_by(replace(query.motion, arm=ARM_NAMES[arm]))
        for arm in nearest_arms(query.scene, query.body_ends, (0.0, 0.0))
    ]


def _blocks(query: MotionQuery) -> Callable[[Choice], Refusal | None]:
    """Function that checks the path of a choice for ``query``.

    Choices of both arms for the same contact share their path, which is checked once.
    """
    refusals: dict[Way, Refusal | None] = {}

    def blocks(choice: Choice) -> Refusal | None:
        """Refusal of a path that is blocked, or None."""
        touched = tuple(replace(contact, arm=0) for contact in choice.contacts)
        path = (touched, tuple(segment.path for segment in choice.segments))
        if path not in refusals:
            refusals[path] = path_refusal(query, choice.segments)
        return refusals[path]

    return blocks
