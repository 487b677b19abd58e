"""The plan made of the best choices, or the message that explains why there is none."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.query import MotionQuery
from pushpressslide.modes import MODES


def selectable(
    empty: Plan, choices: Sequence[Choice], *, force: bool = False
) -> list[Choice]:
    """Choices that can be used in the plan ``empty``, which has no segments yet.

    With ``force`` it is enough to have a path. Raises InfeasibleTaskError if there are
    no such choices.
    """
    feasible = [c for c in choices if c.segments and (c.feasible or force)]
    if not feasible:
        note = ", and none has a path that could be run anyway" if force else ""
        raise infeasible(empty, choices, note)
    return feasible


def infeasible(
    empty: Plan, choices: Sequence[Choice], search_note: str = "", shortfall: str = ""
) -> InfeasibleTaskError:
    """Error that explains why no choice can do the task.

    ``search_note`` summarises the search over several motions, if there was one.
    ``shortfall`` states why the last sequence has no joint paths.
    """
    _, refused = _refused(empty.queries, choices)
    brief = f"{empty.task.name}: no mode can do this task{search_note}"
    told = next((choice for choice in refused if choice.evaluated), None)
    if told is not None:
        brief += f"; {told.mode}: {told.refusal}"
    message = refusal(empty.queries, choices) + search_note + shortfall
    return InfeasibleTaskError(message, brief, refused)


def refusal(queries: Sequence[MotionQuery], choices: Sequence[Choice]) -> str:
    """One line that explains why no choice can do the task of ``queries``, with all
    reasons.
    """
    part, refused = _refused(queries, choices)
    reasons = "; ".join(
        f"{choice.mode}: {reason}" for choice, reason in gathered(refused)
    )
    return f"{part.source}: no mode can do this task: {reasons}"


def _refused(
    queries: Sequence[MotionQuery], choices: Sequence[Choice]
) -> tuple[MotionQuery, list[Choice]]:
    """Query of the leg without a feasible choice, and the leg's refused choices.
    Choices that need more arms than there are do not count.
    """
    by_leg: dict[int, list[Choice]] = {}
    for choice in choices:
        by_leg.setdefault(choice.leg, []).append(choice)
    refused = list(choices)
    for group in by_leg.values():
        if not any(choice.feasible for choice in group):
            refused = group
            break
    part = queries[refused[0].leg]
    arms = len(part.scene.arms)
    fitting = [c for c in refused if MODES[c.mode].arms <= arms] or refused
    return part, [choice for choice in fitting if not choice.feasible]


def gathered(choices: Sequence[Choice]) -> list[tuple[Choice, str]]:
    """Choices with their refusals, without repetition.

    Choices of a mode that are refused with the same code, or skipped for the same
    reason, are merged into the first of them, which states their number.
    """
    alike: dict[tuple[str, str], list[Choice]] = {}
    for i, choice in enumerate(choices):
        code = str(i)
        if choice.refusal is not None:
            code = choice.refusal.code if choice.evaluated else choice.refusal.text
        alike.setdefault((choice.mode, code), []).append(choice)
    out = []
    for first, *others in alike.values():
        reason = first.reason
        if others:
            reason += f" ({len(others)} more like this)"
        out.append((first, reason))
    return out
