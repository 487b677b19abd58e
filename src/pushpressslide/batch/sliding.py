"""The motion of many bodies on their supports under compliant tips: of each the twist at
which all forces balance.

One tick of quasi-statics (docs/mechanics.md, sections 1 to 3), by the method of
``planar.sliding``, which is that for one: a step of it is one formula, and all bodies
that are not yet balanced take it together. Frame B, twists (v_x, v_y, rho w) and
wrenches (f_x, f_y, tau / rho) of the centre of pressure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.batch.balance import Friction, Held, balancing
from pushpressslide.batch.checks import Flags
from pushpressslide.batch.elementwise import Argument, Table, values
from pushpressslide.batch.side_contact import NO_TIP, SideTip
from pushpressslide.batch.support import Support
from pushpressslide.batch.wrench_twist import TwistColumns
from pushpressslide.core.arrays import Array
from pushpressslide.mechanics.balance import (
    BALANCE,
    DRAG_SPEED,
    HALVINGS,
    STEPS,
    TRIALS,
)

Rows = NDArray[np.intp]


def slide(support: Support, tips: Sequence[Array], guesses: Array) -> Array:
    """Return the twists (n, 3) at which supports and tips balance, to 1e-9 of mu_s N.

    ``tips`` are one or two arrays (n, 10), the fields of ``SideTip``; ``guesses``
    (n, 3) the twists of the tick before; the support's figures are single numbers or
    (n,). A body that no tip touches rests. As ``planar.sliding.slide``: Newton's method
    from the guess, and where that fails the body is let go from rest, held back by drag.
    """
    out = np.zeros((len(guesses), 3))
    resting = np.all([tip[:, 2] <= 0.0 for tip in tips], axis=0)
    rows = np.flatnonzero(~resting)
    held = np.zeros((len(guesses), 5))
    held[:, 0] = support.max_force
    balance = _Balance(support, held, tuple(tips)).of(rows)
    with np.errstate(all="ignore"):
        twists, found = balance.solved(guesses[rows])
        lost = np.flatnonzero(~found)
        twists[lost] = balance.of(lost).let_go()
    out[rows] = twists
    return out


class _Step(NamedTuple):
    """Newton's steps under trial, each body at its own."""

    start: Array  # (n, 3) twists before them
    force: Array  # (n, 3) [N] left over there
    step: Array  # (n, 3)
    low: Array  # (n,) share of the step that was too near
    high: Array  # (n,) that was too far
    trials: Array  # (n,) of this step so far
    steps: Array  # (n,) taken so far


@dataclass(frozen=True, slots=True, eq=False)
class _Balance:
    """What support friction and drag take, less what the tips give, as a function of
    the twists (n, 3).
    """

    support: Support
    held: Array  # (n, 5) the fields of ``Held``
    tips: tuple[Array, ...]  # (n, 10) each, the fields of ``SideTip``

    def of(self, rows: Rows | Flags) -> _Balance:
        """Return that of some rows."""
        tips = tuple(tip[rows] for tip in self.tips)
        return _Balance(self.support, self.held[rows], tips)

    def left_over(self, twists: Array) -> tuple[Array, Array]:
        """Return the forces (n, 3) that nothing balances, and Newton's steps (n, 3)."""
        arguments: list[Argument] = [
            Table(TwistColumns, np.ascontiguousarray(twists)),
            Friction(*self.support.frictions(twists)),
            Table(Held, self.held),
            *(Table(SideTip, tip) for tip in self.tips),
            *[NO_TIP] * (2 - len(self.tips)),
        ]
        force, step = values(balancing, arguments, (len(twists),), (3, 3))
        return force, step

    def solved(self, twists: Array) -> tuple[Array, Flags]:
        """Return the balanced twists that Newton's method reaches from ``twists``, and
        where it does.
        """
        out = twists.copy()
        n = len(out)
        found = np.zeros(n, dtype=np.bool_)
        rows = np.arange(n)
        balance = self
        force, step = self.left_over(twists)
        zeros = np.zeros(n)
        s = _Step(twists, force, step, zeros, zeros + 1.0, zeros, zeros)
        while True:
            done = _size(s.force) < BALANCE * balance.held[:, 0]
            out[rows[done]] = s.start[done]
            found[rows[done]] = True
            on = ~done & np.isfinite(s.step).all(axis=1) & (s.steps < STEPS)
            if not on.all():
                rows = rows[on]
                balance = balance.of(on)
                s = _Step(*(column[on] for column in s))
            if not len(rows):
                return out, found
            s = balance.tried(s)

    def tried(self, s: _Step) -> _Step:
        """Return the steps after one more trial: the next ones, or the same ones,
        shorter or longer, where a trial leads too far or leaves too much.
        """
        halved = s.trials > 0.0
        share = np.where(halved, 0.5 * (s.low + s.high), 1.0)
        twists = s.start + share[:, None] * s.step
        ahead, following = self.left_over(twists)
        far = _too_far(ahead, s.force, s.step)
        near = halved & ~far & _too_near(ahead, s.force, s.step)
        again = (far | near) & (s.trials < HALVINGS)
        new = ~again[:, None]
        return _Step(
            np.where(new, twists, s.start),
            np.where(new, ahead, s.force),
            np.where(new, following, s.step),
            np.where(again, np.where(near, share, s.low), 0.0),
            np.where(again, np.where(far, share, s.high), 1.0),
            np.where(again, s.trials + 1.0, 0.0),
            np.where(again, s.steps, s.steps + 1.0),
        )

    def let_go(self) -> Array:
        """Return the balanced twists (n, 3) of bodies that are let go from rest, held
        back by a drag.
        """
        out = np.zeros((len(self.held), 3))
        drag = self.held[:, 0] / DRAG_SPEED
        rows = np.arange(len(out))
        for _ in range(TRIALS):
            if not len(rows):
                break
            free = self.of(rows)
            held = free.held.copy()
            held[:, 1] = drag[rows]
            held[:, 2:] = out[rows]
            moved, ok = replace(free, held=held).solved(out[rows])
            drag[rows] *= np.where(ok, 0.5, 4.0)
            out[rows[ok]] = moved[ok]
            ended, found = free.of(ok).solved(moved[ok])
            ends = rows[ok][found]
            out[ends] = ended[found]
            rows = np.setdiff1d(rows, ends)
        return out


def _dot(a: Array, b: Array) -> Array:
    out: Array = np.einsum("ni,ni->n", a, b)
    return out


def _size(force: Array) -> Array:
    """Return the sizes (n,) [N] of forces and moments (n, 3)."""
    return np.sqrt(_dot(force, force))


def _too_far(ahead: Array, force: Array, step: Array) -> Flags:
    """Return whether a step leads beyond balance: the force ahead points back, by more
    than half of what pointed on.
    """
    on = -_dot(force, step)
    return (
        (on > 0.0)
        & (2.0 * _dot(ahead, step) > on)
        & (2.0 * _size(ahead) > _size(force))
    )


def _too_near(ahead: Array, force: Array, step: Array) -> Flags:
    """Return whether more than half of the force is left over, and points on."""
    return (2.0 * _dot(ahead, step) < _dot(force, step)) & (
        2.0 * _size(ahead) > _size(force)
    )
