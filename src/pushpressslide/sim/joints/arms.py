"""The joint paths of all arms of a plan, so that two arms keep clear of each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pushpressslide.control.controller import RETREAT
from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.robots.continuation import continuation
from pushpressslide.robots.kinematics import arm_kinematics
from pushpressslide.sim.joints.clearance import LOOK
from pushpressslide.sim.joints.joint_path import ArmPath, ArmSearch
from pushpressslide.sim.joints.outline import Outline, least_distance
from pushpressslide.sim.joints.postures import Miss, Move

Array = NDArray[np.float64]
Found = tuple[Move, JointPath]

# [m] least distance of the arms' capsules, which hold the real outline with 1 cm to
# spare
APART = 0.005
SAMPLES = 60  # of an approach at which the distance is looked at
GLANCE = 6  # of so many samples along the contacts one is looked at first
RETREAT_SAMPLES = 7
IN_TURN = 8  # pairs for which a way round the other arm is searched


def joint_paths(
    plan: Plan,
    *,
    force: bool = False,
    postures: tuple[Array, ...] | None = None,
    holding: frozenset[int] = frozenset(),
) -> tuple[ArmPath, ...]:
    """Return each arm's joint path and how its tool is held; two arms keep clear of
    each other, one waiting for the other where they would meet on their way to the
    object.

    ``postures``: where each arm (n,) [rad] is now, None: in its ready posture;
    ``holding``: arms that already have their contact, and keep it. ``force`` takes the
    best there is. Raises InfeasibleTaskError, with the figure that decides, where an
    arm has no path, or two arms come too near to each other.
    """
    starts = postures or (None,) * len(plan.task.robots)
    searches = [
        ArmSearch(
            plan,
            arm,
            start,
            holds=arm in holding,
            others={
                i: q
                for i, q in enumerate(starts)
                if i in holding and i != arm and q is not None
            },
        )
        for arm, start in enumerate(starts)
    ]
    if len(searches) > 1:
        return _Together(plan, searches, force).paths()
    move, path = _first(searches[0], searches[0].paths(force=force))
    return ((path, move.posture.attitude),)


def drawn_back(
    plan: Plan, paths: tuple[ArmPath, ...], holding: frozenset[int] = frozenset()
) -> tuple[Array, ...]:
    """Return each arm's posture (n,) [rad] after a plan, its tip drawn back from the
    contact; ``holding`` arms keep their contact.
    """
    last = plan.segments[-1]
    X_WB = last.path.end.compose(last.X_BV.inverse())
    contacts = {c.arm: c for c in plan.contacts if c.arm not in holding}
    out = []
    for arm, (path, attitude) in enumerate(paths):
        q = path.move[-1]
        if arm in contacts:
            kin = arm_kinematics(plan.task.robots[arm])
            R, p = kin.tip_pose(q)
            back = np.linspace(
                p,
                p - RETREAT * np.array(contacts[arm].direction(X_WB)),
                RETREAT_SAMPLES,
            )
            q = continuation(
                kin, back, np.full(len(back), attitude.yaw(R)), q, attitude
            ).q[-1]
        out.append(q)
    return tuple(out)


def _first(search: ArmSearch, several: Iterator[Found]) -> Found:
    for found in several:
        return found
    raise search.refusal()


class _Together:
    """The search for two joint paths that keep apart."""

    def __init__(self, plan: Plan, searches: list[ArmSearch], force: bool) -> None:
        self.plan = plan
        self.searches = searches
        self.force = force
        self.nearest = (0, "", -math.inf)
        self._outlines = [Outline(robot, i) for i, robot in enumerate(plan.task.robots)]

    def paths(self) -> tuple[ArmPath, ...]:
        """Return the arms' own best paths where they keep apart, else the pair that
        does with the best of the lesser joint margins.
        """
        several = [search.paths(force=self.force) for search in self.searches]
        best = [
            _first(search, found)
            for search, found in zip(self.searches, several, strict=True)
        ]
        if self._along(best) >= APART or self.force:
            done = self._waiting(best)
            if done is not None:
                return done
        options = [[first, *found] for first, found in zip(best, several, strict=True)]
        pairs = sorted(
            product(*options), key=lambda pair: -min(move.margin for move, _ in pair)
        )
        apart = []
        for pair in pairs:
            if self._along(pair) >= APART:
                done = self._waiting(pair)
                if done is not None:
                    return done
                apart.append(pair)
        for pair in apart[:IN_TURN]:
            done = self._in_turn(pair)
            if done is not None:
                return done
        task = self.plan.task
        _, where, nearest = self.nearest
        raise InfeasibleTaskError(
            f"{task.source or task.name}: robots: {where} the arms come as near as "
            f"{nearest * 1e3:.1f} mm to each other, allowed from {APART * 1e3:.0f} mm"
        )

    def _along(self, found: Sequence[Found]) -> float:
        """Return the arms' least distance [m] along the contacts, by a glance where
        that is too small.
        """
        left, right = (move.posture.q for move, _ in found)
        least = self._least(left[::GLANCE], right[::GLANCE])
        if least >= APART:
            least = self._least(left, right)
        self.nearest = max(self.nearest, (0, "along the contacts", least))
        return least

    def _least(self, left: Array, right: Array) -> float:
        """Return the arms' least distance [m], at most LOOK, over postures (k, n) of
        each.
        """
        one, other = self._outlines
        return least_distance(one, other, left, right, LOOK)

    def _waiting(self, found: Sequence[Found]) -> tuple[ArmPath, ...] | None:
        """Return both paths, one waiting for the other where need be."""
        left, right = (float(path.approach_time[-1]) for _, path in found)
        for delays in ((0.0, 0.0), (0.0, left), (right, 0.0)):
            done = self._on_the_way(found, delays, force=self.force and delays[0] > 0.0)
            if done is not None:
                return done
        return None

    def _in_turn(self, found: Sequence[Found]) -> tuple[ArmPath, ...] | None:
        """Return both paths, one round the other where that waits before its own way,
        or after it.
        """
        for first, second in ((0, 1), (1, 0)):
            moves = [move for move, _ in found]
            here = {second: found[second][1].approach[0]}
            leading = self.searches[first].path(
                moves[first], others=here, thorough=True
            )
            if isinstance(leading, Miss):
                continue
            there = {first: leading.approach[-1]}
            trailing = self.searches[second].path(
                moves[second], others=there, thorough=True
            )
            if isinstance(trailing, Miss):
                continue
            paths = [leading, trailing]
            delays = [0.0, float(leading.approach_time[-1])]
            order = (first, second)
            pair = [(moves[arm], paths[order.index(arm)]) for arm in (0, 1)]
            done = self._on_the_way(pair, [delays[order.index(arm)] for arm in (0, 1)])
            if done is not None:
                return done
        return None

    def _on_the_way(
        self, found: Sequence[Found], delays: Sequence[float], *, force: bool = False
    ) -> tuple[ArmPath, ...] | None:
        """Return both paths, each begun after its delay [s], where the arms keep apart
        on the way.
        """
        waiting = [
            _after(path, delay) for (_, path), delay in zip(found, delays, strict=True)
        ]
        times = np.linspace(
            0.0, max(float(path.approach_time[-1]) for path in waiting), SAMPLES
        )
        clear = self._least(*(_sampled(path, times) for path in waiting))
        self.nearest = max(self.nearest, (1, "on the way to the object", clear))
        if clear < APART and not force:
            return None
        return tuple(
            (
                replace(path, clearance=min(path.clearance, clear, self._along(found))),
                move.posture.attitude,
            )
            for (move, _), path in zip(found, waiting, strict=True)
        )


def _after(path: JointPath, delay: float) -> JointPath:
    """The path of an arm that waits ``delay`` [s] at its start."""
    if delay == 0.0:
        return path
    times = np.concatenate([[0.0], path.approach_time + delay])
    return replace(
        path,
        approach_time=times,
        approach=np.concatenate([path.approach[:1], path.approach]),
    )


def _sampled(path: JointPath, times: Array) -> Array:
    """Postures (m, n) of the approach at ``times`` (m,)."""
    return np.column_stack(
        [np.interp(times, path.approach_time, column) for column in path.approach.T]
    )
