"""Search for the quickest sequence of motions to the goal, each with its mode, contacts
and end pose.

It is an A* search over poses of the object and the contacts that hold it there. A
motion between two poses is evaluated only when no other motion can be quicker, and
never twice. If a sequence has no joint path, the placement that causes this is banned
and the search continues.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from itertools import count

from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import SKIPPED
from pushpressslide.core.state import HeldContacts
from pushpressslide.modes import MODES
from pushpressslide.modes.base import straight_time
from pushpressslide.planning.free_space import PathsTo, displacement, same_pose
from pushpressslide.planning.overhead import overhead
from pushpressslide.selection.reach_screen import ReachScreen
from pushpressslide.selection.search_notes import (
    DroppedSequence,
    RefusedMotions,
    SearchNotes,
)

START = 0
GOAL = 1
KEPT = 3  # choices of one motion that are followed, each with other contacts
EAGER = 2.0  # weight of the remaining path
SHORTEST = 0.05  # [m] length of the shortest motion, turns included
BLOCKED = (
    1.5  # times its least time, that a motion may take whose straight way is not free
)
# codes of refusals that exclude a mode wherever the object is to go
ALWAYS = frozenset(
    {
        "arms",
        "light",
        "lever",
        "no_faces",
        "normal_force",
        "off_top",
        "smooth_tip",
        "support",
        "tipping",
        "too_close",
    }
)
# refusal codes that exclude a motion with any contacts
HOPELESS = frozenset({"smooth_tip"})

# of a motion by a mode: with the contacts that are held, with whatever contacts where
# none are
EvaluateMotion = Callable[[MotionQuery, str, HeldContacts | None], list[Choice]]


@dataclass(frozen=True, slots=True)
class Node:
    """A state of the search: the object's pose, and the contacts that hold it there."""

    pose: int  # index of the pose X_WG
    held_contacts: HeldContacts | None  # None: nothing, at the start
    since: int  # index of the pose at which it was taken


@dataclass(frozen=True, slots=True)
class Step:
    """One motion of a sequence."""

    start: Node
    end: Node
    choice: Choice


@dataclass(frozen=True, slots=True)
class Reached:
    """A node of a sequence, with the steps that lead to it and the time [s] until then."""

    node: Node
    steps: tuple[Step, ...]
    time: float


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion that has not been evaluated yet."""

    before: Reached
    to: int  # index of a pose
    mode: str
    held_contacts: bool  # with the contacts that it has
    timed: bool = False  # whether the mode's lower bound of the time is known


@dataclass
class LegSearch:
    """The search for one motion, with a cache of evaluated motions."""

    query: MotionQuery
    free_paths: PathsTo  # to the goal
    poses: list[Pose2]  # X_WG: start, goal and via poses; more are added
    touching: ReachScreen
    evaluate: EvaluateMotion
    max_work: (
        int  # work that may be spent on judging motions; one by a push from behind is 1
    )
    # where one push may lead from a pose X_WG; None: only to ``poses``
    successors: Callable[[Pose2], list[Pose2]] | None = None
    evaluated: int = 0  # motions
    spent: int = 0  # work on them
    banned: set[tuple[int, int, HeldContacts]] = field(default_factory=set)
    modes: list[str] = field(default_factory=list)
    _refused: dict[tuple[str, str], RefusedMotions] = field(default_factory=dict)
    _dropped: list[DroppedSequence] = field(default_factory=list)
    _choices_by_motion: dict[
        tuple[int, int, str, HeldContacts | None], list[Choice]
    ] = field(default_factory=dict)
    _lengths: list[float] = field(default_factory=list)
    _led_on: set[int] = field(default_factory=set)  # poses that others were added for
    _least_times: dict[tuple[int, int, str], float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Compute the lengths that depend on the object's size."""
        self._radius = self.query.body.radius

    def know(self, choices: Sequence[Choice]) -> None:
        """Store the choices already evaluated for the motion from start to goal.

        Modes that cannot move the object at all are excluded from the search.
        """
        by_mode: dict[str, list[Choice]] = {}
        for choice in choices:
            by_mode.setdefault(choice.mode, []).append(choice)
        for mode, judged in by_mode.items():
            refusals = [choice.refusal for choice in judged]
            if all(r is not None and r.code in ALWAYS for r in refusals):
                continue
            if _hopeless(judged):
                continue
            self.modes.append(mode)
            self._choices_by_motion[START, GOAL, mode, None] = _best(judged)

    def ban(self, steps: Sequence[Step], first: int, last: int, reason: str) -> None:
        """Exclude the placement made by the ``steps`` from ``first`` to ``last``, with
        its contacts, for ``reason``.
        """
        held_contacts = steps[last].end.held_contacts
        assert held_contacts is not None
        self.banned.add((steps[first].start.pose, steps[last].end.pose, held_contacts))
        modes = tuple(step.choice.mode for step in steps)
        times = (step.choice.time or 0.0 for step in steps)
        self._dropped.append(DroppedSequence(modes, sum(times), reason))

    @property
    def tried(self) -> SearchNotes:
        """Summary of everything that the search has tried so far."""
        often = sorted(self._refused.values(), key=lambda motions: -motions.count)
        poses = len(self.poses) - 2
        return SearchNotes(poses, self.evaluated, tuple(often), tuple(self._dropped))

    def soonest(self) -> tuple[Step, ...]:
        """Quickest sequence that is not banned. Empty if there is none, or if the
        evaluation budget is exceeded.
        """
        order = count()
        heap: list[tuple[float, int, Reached | Motion]] = []
        done: set[Node] = set()
        start = Reached(Node(START, None, START), (), 0.0)
        heappush(heap, (0.0, next(order), start))
        while heap:
            _, _, item = heappop(heap)
            if isinstance(item, Reached):
                if item.node in done:
                    continue
                if item.node.pose == GOAL:
                    return item.steps
                done.add(item.node)
                self._lead_on(item)
                for due, motion in self._motions(item, range(1, len(self.poses))):
                    heappush(heap, (due, next(order), motion))
                continue
            if not self._worth_asking(item):
                continue
            if not item.timed:
                heappush(
                    heap, (self._due(item), next(order), replace(item, timed=True))
                )
                continue
            for after in self._after(item):
                due = after.time + self._ahead(after.node.pose)
                if after.node in done or due > self.query.limits.time:
                    continue
                heappush(heap, (due, next(order), after))
                # the motion to the goal is evaluated before all others
                for due, motion in self._motions(after, (GOAL,)):
                    heappush(heap, (due, next(order), motion))
        return ()

    def _lead_on(self, here: Reached) -> None:
        """Add the poses that one push can reach from a node, if at least two more
        motions are allowed.
        """
        pose = here.node.pose
        if self.successors is None or pose in self._led_on:
            return
        if len(here.steps) + 2 > self.query.limits.legs:
            return
        self._led_on.add(pose)
        known = len(self.poses)
        for X in self.successors(self.poses[pose]):
            if not any(same_pose(X, other) for other in self.poses[:known]):
                self.poses.append(X)

    def _motions(
        self, here: Reached, targets: Iterable[int]
    ) -> list[tuple[float, Motion]]:
        """Motions from a node to some poses, each with a lower bound [s] of the time of
        the sequences through it.
        """
        left = self.query.limits.legs - len(here.steps)
        if left == 0 or here.node.pose == GOAL:
            return []
        if left == 1:
            targets = (GOAL,)
        behind = {step.start.pose for step in here.steps} | {here.node.pose}
        held_contacts = here.node.held_contacts
        out = []
        for to in targets:
            if to in behind or self._short(here.node.pose, to):
                continue
            due = here.time + self._ahead(to) + self._straight(here.node.pose, to)
            for mode in self.modes:
                if not self.touching.can_reach(mode, self.poses, here.node.pose, to):
                    continue
                if held_contacts is not None and held_contacts.mode == mode:
                    out.append((due, Motion(here, to, mode, held_contacts=True)))
                out.append(
                    (due + self._regrasp, Motion(here, to, mode, held_contacts=False))
                )
        return out

    def _due(self, motion: Motion) -> float:
        """Lower bound [s] of the time of the sequences that start with a motion."""
        here = motion.before
        least = self._time_estimate(here.node.pose, motion.to, motion.mode)
        regrasp = 0.0 if motion.held_contacts else self._regrasp
        return here.time + self._ahead(motion.to) + least + regrasp

    def _after(self, motion: Motion) -> list[Reached]:
        """Successor nodes of a motion."""
        here = motion.before
        out = []
        for choice in self._choices(motion):
            contacts = HeldContacts.by(choice.mode, choice.contacts)
            held_contacts = contacts == here.node.held_contacts
            since = here.node.pose
            time = choice.time or 0.0
            if held_contacts:
                since = here.node.since
                time = max(time - self._regrasp, 0.0)
            elif motion.held_contacts:
                continue
            if (since, motion.to, contacts) in self.banned:
                continue
            end = Node(motion.to, contacts, since)
            step = Step(here.node, end, choice)
            out.append(Reached(end, (*here.steps, step), here.time + time))
        return out

    def _key(self, motion: Motion) -> tuple[int, int, str, HeldContacts | None]:
        """Cache key of the choices of a motion."""
        start = motion.before.node
        held_contacts = start.held_contacts if motion.held_contacts else None
        return (start.pose, motion.to, motion.mode, held_contacts)

    def _worth_asking(self, motion: Motion) -> bool:
        """Whether a motion is known to have choices, or may still be evaluated."""
        key = self._key(motion)
        if key in self._choices_by_motion:
            return bool(self._choices_by_motion[key])
        return self.spent < self.max_work and motion.mode in self.modes

    def _choices(self, motion: Motion) -> list[Choice]:
        """Feasible choices of a motion, evaluated at the first request."""
        key = self._key(motion)
        start, end, mode, held_contacts = key
        if key not in self._choices_by_motion:
            self.evaluated += 1
            self.spent += 1 if motion.held_contacts else MODES[mode].evaluation_cost
            asked = self.query.between(self.poses[start], self.poses[end])
            judged = self.evaluate(asked, mode, held_contacts)
            self._choices_by_motion[key] = _best(judged)
            if not self._choices_by_motion[key]:
                self._note(mode, judged)
            if _hopeless(judged) and mode in self.modes:
                self.modes.remove(mode)
        return self._choices_by_motion[key]

    def _note(self, mode: str, evaluated: Sequence[Choice]) -> None:
        """Count a motion that ``mode`` cannot do, under the code of its first refusal."""
        refusals = (choice.refusal for choice in evaluated)
        first = next((r for r in refusals if r is not None and r.code != SKIPPED), None)
        if first is None:
            return
        before = self._refused.get((mode, first.code))
        count = 0 if before is None else before.count
        text = str(first) if before is None else before.text
        motions = RefusedMotions(mode, first.code, count + 1, text)
        self._refused[mode, first.code] = motions

    def _short(self, start: int, end: int) -> bool:
        """Whether a motion is too short to be worthwhile. A motion that ends at the
        goal never is.
        """
        if end == GOAL:
            return False
        shape = self.query.body.shape
        return displacement(shape, self.poses[start], self.poses[end]) < SHORTEST

    def _straight(self, start: int, end: int) -> float:
        """Lower bound [s] of the time of any motion between two poses."""
        ends = (self.poses[start], self.poses[end])
        center = self.query.body.center_of_mass
        return straight_time(*ends, center, self._radius, self.query.motion)

    def _time_estimate(self, start: int, end: int, mode: str) -> float:
        """Estimated minimum time [s] of a motion between two poses with the contacts
        kept. The time is longer if the straight path is blocked.
        """
        key = (start, end, mode)
        if key not in self._least_times:
            ends = (self.poses[start], self.poses[end])
            least = MODES[mode].least_time(self.query.between(*ends))
            if not self.free_paths.space.straight(*ends):
                least = BLOCKED * least + self._regrasp
            self._least_times[key] = least
        return self._least_times[key]

    def _ahead(self, pose: int) -> float:
        """Estimated time [s] from a pose to the goal, weighted to favour nodes near the
        goal.
        """
        while len(self._lengths) < len(self.poses):
            some = self.poses[len(self._lengths) :]
            self._lengths += self.free_paths.lengths(some).tolist()
        return EAGER * self._lengths[pose] / self.query.motion.speed

    @property
    def _regrasp(self) -> float:
        """Cost [s] of changing contacts: release, transfer and touch."""
        return overhead(self.query.motion)


def _hopeless(evaluated: Sequence[Choice]) -> bool:
    """Whether the ``evaluated`` choices show that their mode can never move the object."""
    refusals = (choice.refusal for choice in evaluated)
    return any(r is not None and r.code in HOPELESS for r in refusals)


def _best(choices: Sequence[Choice]) -> list[Choice]:
    """Quickest feasible choice of each placement."""
    out: dict[HeldContacts, Choice] = {}
    for choice in choices:
        if choice.feasible and len(out) < KEPT:
            out.setdefault(HeldContacts.by(choice.mode, choice.contacts), choice)
    return list(out.values())
