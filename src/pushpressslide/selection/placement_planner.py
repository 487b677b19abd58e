"""The best choice for every placement, among choices for which the arms have joint
paths.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain, groupby
from typing import Any, NamedTuple, Protocol

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import Choice, Contact, Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal, literal
from pushpressslide.selection.planner import infeasible, selectable
from pushpressslide.selection.select import MANY, placements

COMPARED = 2  # choices of a mode, where none leaves the arms all the room
ALIKE = 0.02  # [m] between the contacts of two placements that count as alike

Problems = dict[tuple[str, tuple[Contact, ...], str, str], InfeasibleTaskError]


class PlacementPlanner(Protocol):
    """The plans of consecutive placements, with their joint paths."""

    @property
    def plans(self) -> Sequence[Plan]:
        """The plans so far, one per placement."""

    @property
    def paths(self) -> Sequence[tuple[Any, ...]]:
        """Joint paths of each plan. Empty for a plant without arms."""

    @property
    def margin_share(self) -> float:
        """Share of the room that an unsure object asks for, of the last placement's
        arms. One without arms.
        """

    def add(self, placement: Plan) -> None:
        """Append the plan of a placement.

        Raises InfeasibleTaskError if an arm has no joint path for this placement.
        """

    def keep(self, count: int) -> None:
        """Forget all placements but the first ``count``."""

    def after(self) -> PlacementPlanner:
        """Planner without placements that starts from the arms' state after all
        placements.
        """


@dataclass
class PlansAlone:
    """Placement planner of a plant without arms. It accepts any plan."""

    plans: list[Plan] = field(default_factory=list)
    paths: Sequence[Any] = ()
    margin_share: float = 1.0

    def add(self, placement: Plan) -> None:
        """Append the plan of a placement."""
        self.plans.append(placement)

    def keep(self, count: int) -> None:
        """Forget all placements but the first ``count``."""
        del self.plans[count:]

    def after(self) -> PlansAlone:
        """New planner without placements. There is no state to carry over without arms."""
        return PlansAlone()


class FailedPlacement(NamedTuple):
    """First segment of a placement that failed."""

    segment: Segment
    X_GB: Pose2  # of the belief that it was planned with
    near: float = ALIKE  # [m] between the contacts of placements that would fail, too

    @property
    def anywhere(self) -> FailedPlacement:
        """The same of a press that slid: it would slide anywhere on the top."""
        return self._replace(near=math.inf)

    def repeated_by(self, first: Segment, X_GB: Pose2) -> bool:
        """Whether a placement that begins with ``first`` would fail as this one did."""
        pairs = zip(first.contacts, self.segment.contacts, strict=False)
        near = all(
            math.dist(X_GB.apply(a.point), self.X_GB.apply(b.point)) < self.near
            for a, b in pairs
        )
        return near and first.mode == self.segment.mode


@dataclass
class OtherPlacements:
    """Placement planner that refuses placements like those that failed."""

    planner: PlacementPlanner
    failed: Sequence[FailedPlacement]

    @property
    def plans(self) -> Sequence[Plan]:
        """The plans so far, one per placement."""
        return self.planner.plans

    @property
    def paths(self) -> Sequence[tuple[Any, ...]]:
        """Joint paths of each plan."""
        return self.planner.paths

    @property
    def margin_share(self) -> float:
        """Share of the room of the last placement's arms."""
        return self.planner.margin_share

    def add(self, placement: Plan) -> None:
        """Append the plan of a placement.

        Raises InfeasibleTaskError if it begins with the mode and the contacts of a
        failed one, or if an arm has no joint path.
        """
        first = placement.segments[0]
        X_GB = placement.query.X_GB
        if any(failed.repeated_by(first, X_GB) for failed in self.failed):
            raise InfeasibleTaskError("a motion with such contacts has failed")
        self.planner.add(placement)

    def keep(self, count: int) -> None:
        """Forget all placements but the first ``count``."""
        self.planner.keep(count)

    def after(self) -> PlacementPlanner:
        """Planner that starts after all placements, and refuses none."""
        return self.planner.after()


def prepared(
    planner: PlacementPlanner,
    empty: Plan,
    choices: Sequence[Choice],
    force: bool = False,
    first: int = 0,
) -> list[Choice]:
    """Add the best choice of every placement to ``planner``. Returns the evaluated
    choices, with refusals of the skipped ones.

    ``choices`` are for the plan ``empty``, which has no segments yet, from the leg
    ``first`` on. With ``force``, infeasible choices are also taken if they have a path.
    Raises InfeasibleTaskError if a placement has no usable choice.
    """
    groups = [list(group) for _, group in groupby(choices, lambda c: c.leg)]
    for group in groups:
        selectable(empty, group, force=force)
    for number, group in enumerate(groups):
        problems: Problems = {}
        added = add_first(planner, empty, group, force, problems)
        if not added and not all(choice.evaluated for choice in group):
            more = placements(empty.queries, MANY, first)
            # with more choices a leg may keep the contacts of the previous one
            if [other[0].leg for other in more] == [other[0].leg for other in groups]:
                groups[number] = group = more[number]
                added = add_first(planner, empty, group, force, problems)
        if added:
            continue
        if len(problems) == 1:
            raise next(iter(problems.values()))
        raise infeasible(empty, list(chain.from_iterable(groups)))
    return list(chain.from_iterable(groups))


def add_first(
    planner: PlacementPlanner,
    empty: Plan,
    choices: list[Choice],
    force: bool,
    problems: Problems,
    tries: float = math.inf,
) -> bool:
    """Add the first choice of a placement that has a joint path. Returns whether there
    is one.

    If its arms lack room, it is compared to the next ones of the same mode. Refusals of
    choices without a joint path are written into ``choices`` and ``problems``. Choices
    in ``problems`` are not tried again. At most ``tries`` problems are collected.
    """
    tight: list[tuple[float, str, Plan]] = []
    for i, choice in enumerate(choices):
        if not choice.segments or not (choice.feasible or force):
            continue
        if len(problems) >= tries or len(tight) == COMPARED:
            break
        if tight and choice.mode != tight[0][1]:
            continue
        key = (choice.mode, choice.contacts, choice.label, choice.summary)
        try:
            if key not in problems:
                before = len(planner.plans)
                plan = empty.of_choices([choice]).by_placement[0]
                planner.add(plan)
                if planner.margin_share >= 1.0 or force or len(planner.plans) == before:
                    return True
                tight.append((planner.margin_share, choice.mode, plan))
                planner.keep(before)
                continue
        except InfeasibleTaskError as error:
            problems[key] = error
        reason = str(problems[key]).split(": ", 1)[-1]
        choices[i] = choice.refused(Refusal("joint_path", literal(reason)))
    if tight:
        planner.add(max(tight, key=lambda compared: compared[0])[2])
    return bool(tight)


def with_joint_paths(
    planner: PlacementPlanner, empty: Plan, choices: Sequence[Choice]
) -> list[Choice]:
    """Choices of a task without legs, the feasible ones first. Choices without joint
    paths are refused.

    ``planner`` must be empty, and is empty again afterwards.
    """
    out = []
    for choice in choices:
        if choice.feasible:
            try:
                planner.add(empty.of_choices([choice]).by_placement[0])
            except InfeasibleTaskError as error:
                reason = str(error).split(": ", 1)[-1]
                choice = choice.refused(Refusal("joint_path", literal(reason)))
            planner.keep(0)
        out.append(choice)
    return sorted(out, key=lambda choice: not choice.feasible)
