"""One planned push from behind, run for many truths at once: pose filter, rear Stanley
law, velocity servo, and a compliant tip that pushes a body on the ellipsoid.

One tick is one formula. It is what the run loop does in the move of a rear push on the
planar engine, with the exact limit surface replaced by an ellipsoid about the true
centre of pressure, and without: the approach, the touch and the release, new plans, what
is identified on the way, another touch. Sources: docs/mechanics.md, sections 1 to 3;
``control.controller``, ``control.tip_motion`` and ``planar.world`` for one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.batch.angles import cos, sin
from pushpressslide.batch.compliant_push import PushingTip, TipPushed, tip_pushed
from pushpressslide.batch.elementwise import run
from pushpressslide.batch.path_pieces import Piece, beside, eased
from pushpressslide.batch.path_steering import (
    Car,
    PathErrors,
    Stanley,
    Steering,
    car_push,
    steered,
)
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, greater, least, where

UNDER_WAY = 0
ARRIVED = 1
LEFT_FACE = 2
ASTRAY = 3
"""How a run stands: ``Motion.end``."""
TURN = 2.0 * math.pi
TOGETHER = 64  # ticks after which the runs that have ended are left out


class PoseColumns(NamedTuple):
    """A pose."""

    x: Column
    y: Column
    yaw: Column


class Motion(NamedTuple):
    """Where the runs are; frame B is at the centre of mass as believed, n and t are along
    the face's inward normal and to its left.
    """

    x: Column  # [m] X_WB
    y: Column
    yaw: Column  # [rad]
    seen_x: Column  # [m] the same as the controller believes
    seen_y: Column
    seen_yaw: Column
    vx: Column  # [m/s] the twist that it expects, of B's origin, in B
    vy: Column
    w: Column  # [rad/s]
    place: Column  # [m] of the tip, along t from B's origin
    gap: Column  # [m]
    ux: Column  # [m/s] reference of the tip's velocity, in the world
    uy: Column
    fn: Column  # [N] force of the tip on the body
    ft: Column
    progress: Column  # [m] along the path
    grip: Column  # share of the steering that may be used
    apart: Column  # [s] since the contact's force was last felt
    off: Column  # [m] largest distance of the axle from the path so far
    time: Column  # [s] since the motion began
    end: Column  # UNDER_WAY, ARRIVED, LEFT_FACE or ASTRAY


class Bodies(NamedTuple):
    """What is true of the bodies."""

    drag: Column  # [N] mu_s N
    lift: Column  # [m/N] height of the contact over the load
    friction: Column  # of the pair tip/body
    n: Column  # [m] centre of mass from where it is believed, along n and t
    t: Column


class Lead(NamedTuple):
    """The laws that lead a body; in B, of the car that is believed."""

    pose_gain: (
        Column  # share of a measured pose's error that corrects the predicted one
    )
    axle_x: Column  # [m] virtual front axle
    axle_y: Column
    ex: Column  # heading axis
    ey: Column
    heading: Column  # [rad] its direction
    wheelbase: Column  # [m] effective
    lever: Column  # [m]
    rho: Column  # [m]
    drag: Column  # [N] mu_s N
    low: Column  # [rad] bounds of the steering angle
    high: Column
    gain: Column  # of the lateral error
    grip_use: Column  # friction utilisation above which the grip falls
    grip_fall: Column  # [1/s]
    grip_rise: Column  # [1/s]
    grip_least: Column


class Touch(NamedTuple):
    """The tip, its face, and the base of the body; in B."""

    nx: Column  # unit inward normal
    ny: Column
    depth: Column  # [m] of the face along n
    right: Column  # [m] ends of the face along t
    left: Column
    radius: Column  # [m] of the tip
    tip_x: Column  # [m] the tip's centre as planned
    tip_y: Column
    friction: Column  # as believed
    felt: Column  # [N] that counts as contact
    kept: Column  # [N] below which it is lost
    damping: Column  # [N s/m]
    force_gain: Column
    acceleration: Column  # [m/s^2] of the tip's reference
    patience: Column  # [s] without a contact's force
    # rho^2 [m^2] of the ellipsoid about the centre of pressure: as the exact surface has
    # it for a force at the tangent k to the line through the centre of mass, less the
    # square of the distance between the two centres
    square: Column  # [m^2] at k = 0
    slope: Column  # [m^2] per |k|
    bend: Column  # [m^2] per k^2
    steepest: Column  # |k| beyond which it stays


class Pace(NamedTuple):
    """How fast it goes: the profile at a time, and what else bounds the speed."""

    progress: Column  # [m]
    speed: Column  # [m/s]
    length: Column  # [m] of the path
    floor: Column  # [m/s] least speed
    most: Column  # [m/s]
    acceleration: Column  # [m/s^2]
    catch_up: Column  # [1/s]
    easing: Column  # [s] over which bends are averaged
    stop: Column  # [m] of path left, at which the motion ends
    astray: Column  # [m] off the path, at which it is given up
    dt: Column  # [s]


class Guide(NamedTuple):
    """What the laws ask for, in B."""

    progress: Column  # [m]
    left: Column  # [m] of the path from the axle
    fx: Column  # [N] at the contact
    fy: Column
    vx: Column  # [m/s] of B's origin
    vy: Column
    w: Column  # [rad/s]


class PushedOn(NamedTuple):
    """Body and tip after a tick."""

    x: Column
    y: Column
    yaw: Column
    place: Column
    gap: Column
    fn: Column
    ft: Column


def ticked(
    m: Motion,
    piece: Piece,
    body: Bodies,
    noise: PoseColumns,
    lead: Lead,
    touch: Touch,
    pace: Pace,
) -> Columns:
    """Return the motion after one tick; of runs that have ended as it was, but for what
    no longer counts.
    """
    seen = believed(m, noise, lead, pace)
    guide = guided(seen, m, piece, lead, pace)
    ux, uy = reference(seen, guide, m, touch, pace)
    grip = eased_grip(m, lead, touch, pace)
    moved = pushed_on(m, (seen, guide, ux, uy), body, touch, pace)
    apart = where(moved.fn < touch.kept, m.apart + pace.dt, 0.0)
    end = where(pace.length - guide.progress <= pace.stop, ARRIVED, UNDER_WAY)
    end = where(apart > touch.patience, LEFT_FACE, end)
    end = where(np.abs(guide.left) > pace.astray, ASTRAY, end)
    return after(m, (seen, guide, moved), (ux, uy, grip, apart, end), pace.dt)


def after(
    m: Motion,
    found: tuple[PoseColumns, Guide, PushedOn],
    kept: tuple[Column, Column, Column, Column, Column],
    dt: Column,
) -> Columns:
    """Return the fields of the motion after a tick of ``dt`` [s]."""
    seen, guide, moved = found
    ux, uy, grip, apart, end = kept
    goes = m.end == UNDER_WAY
    return (
        where(goes, moved.x, m.x),
        where(goes, moved.y, m.y),
        where(goes, moved.yaw, m.yaw),
        seen.x,
        seen.y,
        seen.yaw,
        guide.vx,
        guide.vy,
        guide.w,
        where(goes, moved.place, m.place),
        where(goes, moved.gap, m.gap),
        ux,
        uy,
        moved.fn,
        moved.ft,
        guide.progress,
        grip,
        apart,
        where(goes, greater(np.abs(guide.left), m.off), m.off),
        where(goes, m.time + dt, m.time),
        where(goes, end, m.end),
    )


def believed(m: Motion, noise: PoseColumns, lead: Lead, pace: Pace) -> PoseColumns:
    """Return X_WB as the controller has it: where the body should have moved, corrected
    by the share of what is measured.
    """
    turn = m.w * pace.dt
    c = cos(m.seen_yaw + 0.5 * turn)
    s = sin(m.seen_yaw + 0.5 * turn)
    x = m.seen_x + (c * m.vx - s * m.vy) * pace.dt
    y = m.seen_y + (s * m.vx + c * m.vy) * pace.dt
    yaw = m.seen_yaw + turn
    k = lead.pose_gain
    return PoseColumns(
        x + k * (m.x + noise.x - x),
        y + k * (m.y + noise.y - y),
        yaw + k * (m.yaw + noise.yaw - yaw),
    )


def guided(seen: PoseColumns, m: Motion, piece: Piece, lead: Lead, pace: Pace) -> Guide:
    """Return what the rear Stanley law asks for at the speed of the moment."""
    left = pace.length - m.progress
    wanted = pace.speed + pace.catch_up * (pace.progress - m.progress)
    braking = pace.floor + np.sqrt(pace.acceleration * greater(left, 0.0))
    speed = least(least(greater(wanted, pace.floor), pace.most), braking)
    c = cos(seen.yaw)
    s = sin(seen.yaw)
    at = beside(
        seen.x + c * lead.axle_x - s * lead.axle_y,
        seen.y + s * lead.axle_x + c * lead.axle_y,
        m.progress,
        piece,
    )
    smooth = eased(at, pace.easing * speed, piece)
    turn = smooth.yaw - seen.yaw - lead.heading
    turn = turn - TURN * np.floor(turn / TURN + 0.5)
    law = Stanley(lead.wheelbase, lead.low, lead.high, lead.gain, 1.0, m.grip)
    delta, _ = steered(PathErrors(at.left, turn, smooth.curvature), law)
    car = Car(lead.ex, lead.ey, lead.lever, lead.rho, lead.drag, speed)
    fx, fy, _, vx, vy, w = car_push(Steering(delta), car)
    return Guide(
        at.progress,
        at.left,
        fx,
        fy,
        vx + w * lead.axle_y,
        vy - w * lead.axle_x,
        w,
    )


def reference(
    seen: PoseColumns, guide: Guide, m: Motion, touch: Touch, pace: Pace
) -> tuple[Column, Column]:
    """Return the reference of the tip's velocity [m/s] in the world: that of the twist at
    the tip, no farther from the last one than its acceleration allows.
    """
    c = cos(seen.yaw)
    s = sin(seen.yaw)
    vx = guide.vx - guide.w * touch.tip_y
    vy = guide.vy + guide.w * touch.tip_x
    dx = c * vx - s * vy - m.ux
    dy = s * vx + c * vy - m.uy
    size = np.sqrt(dx * dx + dy * dy)
    step = touch.acceleration * pace.dt
    share = where(size > step, step / where(size > 0.0, size, 1.0), 1.0)
    return m.ux + share * dx, m.uy + share * dy


def eased_grip(m: Motion, lead: Lead, touch: Touch, pace: Pace) -> Column:
    """Return the share of the steering that may be used, by the last force."""
    used = np.abs(m.ft) / (touch.friction * greater(m.fn, touch.felt))
    rate = where(used > lead.grip_use, -lead.grip_fall, lead.grip_rise)
    return least(greater(m.grip + rate * pace.dt, lead.grip_least), 1.0)


def square_of_base(m: Motion, body: Bodies, touch: Touch) -> Column:
    """Return rho^2 [m^2] about the centre of pressure, under the last tick's force."""
    en = body.n - touch.depth
    et = body.t - m.place
    along = en * m.fn + et * m.ft
    across = np.abs(en * m.ft - et * m.fn)
    k = least(across / where(along > 0.0, along, 1.0), touch.steepest)
    k = where(along > 0.0, k, 0.0)
    moved = body.lift * body.lift * (m.fn * m.fn + m.ft * m.ft)
    return touch.square + (touch.slope + touch.bend * k) * k - moved


def pushed_on(
    m: Motion,
    asked: tuple[PoseColumns, Guide, Column, Column],
    body: Bodies,
    touch: Touch,
    pace: Pace,
) -> PushedOn:
    """Return body and tip after a tick under a command: force and velocity."""
    seen, guide, ux, uy = asked
    b = touch.damping
    turned = seen.yaw - m.yaw  # of the command's axes from the body's
    c = cos(turned)
    s = sin(turned)
    gx = touch.force_gain * (c * guide.fx - s * guide.fy)
    gy = touch.force_gain * (s * guide.fx + c * guide.fy)
    c = cos(m.yaw)
    s = sin(m.yaw)
    gx = gx + b * (c * ux + s * uy)
    gy = gy + b * (c * uy - s * ux)
    fn = gx * touch.nx + gy * touch.ny
    ft = touch.nx * gy - touch.ny * gx
    cop_n = body.n + body.lift * m.fn
    cop_t = body.t + body.lift * m.ft
    before = (m.place >= touch.right) & (m.place <= touch.left)
    tip = PushingTip(
        where(before, fn - b * m.gap / pace.dt, -1.0),
        ft,
        touch.depth - cop_n,
        m.place - cop_t,
        touch.depth - touch.radius - cop_n,
        body.friction,
        body.drag,
        square_of_base(m, body, touch),
    )
    pushed = tip_pushed(tip)
    return carried(m, (tip, pushed, fn, ft), (cop_n, cop_t), touch, pace)


def carried(
    m: Motion,
    contact: tuple[PushingTip, TipPushed, Column, Column],
    cop: tuple[Column, Column],
    touch: Touch,
    pace: Pace,
) -> PushedOn:
    """Return body and tip after the tick in which the tip pushed so."""
    tip, pushed, fn, ft = contact
    cop_n, cop_t = cop
    dt = pace.dt
    rate = pushed.slide / touch.damping
    vn = rate * pushed.fn
    vt = rate * pushed.ft
    w = rate * (tip.pn * pushed.ft - tip.pt * pushed.fn) / tip.square
    # the tip's own velocity, less that of the body where the tip is
    slip_n = (fn - pushed.fn) / touch.damping - vn + w * tip.pt
    slip_t = (ft - pushed.ft) / touch.damping - vt - w * (tip.cn - m.gap)
    vn = vn + w * cop_t
    vt = vt - w * cop_n
    vx = touch.nx * vn - touch.ny * vt
    vy = touch.ny * vn + touch.nx * vt
    c = cos(m.yaw + 0.5 * w * dt)
    s = sin(m.yaw + 0.5 * w * dt)
    return PushedOn(
        m.x + (c * vx - s * vy) * dt,
        m.y + (s * vx + c * vy) * dt,
        m.yaw + w * dt,
        m.place + slip_t * dt,
        m.gap - slip_n * dt,
        pushed.fn,
        pushed.ft,
    )


class PathRuns(NamedTuple):
    """A planned push, for any bodies."""

    pieces: Array  # (10, p + 1) of the path: ``path_pieces.pieces_of``
    lead: Lead
    touch: Touch
    pace: Pace  # but for the profile's progress and speed
    profile: Callable[[float], tuple[float, float]]  # progress [m] and speed [m/s]
    noise: Array  # (3,) [m], [m], [rad] standard deviations of a measured pose
    limit: float  # [s] after which runs are ended
    # rows that noise is drawn for: what one is given does not depend on how many there are
    width: int

    def begin(self, poses: Array, place: float, rng: np.random.Generator) -> Array:
        """Return the motion (21, n) of bodies at ``poses`` (n, 3), X_WB, with the tip in
        contact at ``place`` [m]; what is believed of the poses has been filtered.
        """
        motion = np.zeros((len(Motion._fields), len(poses)))
        motion[:3] = poses.T
        k = float(self.lead.pose_gain)
        spread = self.noise * np.sqrt(k / (2.0 - k))
        draws = rng.standard_normal((3, self.width))[:, : len(poses)]
        motion[3:6] = poses.T + spread[:, None] * draws
        motion[Motion._fields.index("place")] = place
        motion[Motion._fields.index("grip")] = 1.0
        return motion

    def finish(self, motion: Array, bodies: Array, rng: np.random.Generator) -> Array:
        """Return the motion (21, n) when every run has ended, or after the limit.

        ``bodies`` (5, n) are the fields of ``Bodies``.
        """
        out = motion.copy()
        rows = np.arange(motion.shape[1])
        at = np.zeros(len(rows), dtype=np.intp)
        pieces = self.pieces[:, at]
        last = round(self.limit / float(self.pace.dt))
        for first in range(0, last, TOGETHER):
            spare = np.empty_like(motion)
            for tick in range(first, min(first + TOGETHER, last)):
                noise = self._noise(rng, rows)
                self._tick((motion, pieces, bodies), noise, tick + 1, spare)
                motion, spare = spare, motion
                self._go_on(motion, pieces, at)
            out[:, rows] = motion
            stay = motion[-1] == UNDER_WAY
            if not stay.any():
                break
            rows = rows[stay]
            at = at[stay]
            motion, pieces, bodies = (
                np.compress(stay, a, axis=1) for a in (motion, pieces, bodies)
            )
        return out

    def _noise(self, rng: np.random.Generator, rows: NDArray[np.intp]) -> PoseColumns:
        """Return the noise of a tick's poses, of ``rows``."""
        if not self.noise.any():
            return PoseColumns(*np.zeros(3))
        draws = rng.standard_normal((3, self.width))
        draws *= self.noise[:, None]
        return PoseColumns(*draws.take(rows, axis=1))

    def _tick(
        self,
        columns: tuple[Array, Array, Array],
        noise: PoseColumns,
        tick: int,
        out: Array,
    ) -> None:
        """Write the motion after a ``tick``, counted from the first, into ``out``."""
        motion, pieces, bodies = columns
        progress, speed = self.profile(tick * float(self.pace.dt))
        pace = self.pace._replace(
            progress=np.float64(progress), speed=np.float64(speed)
        )
        arguments = (
            Motion(*motion),
            Piece(*pieces),
            Bodies(*bodies),
            noise,
            self.lead,
            self.touch,
            pace,
        )
        run(ticked, arguments, (out,))

    def _go_on(self, motion: Array, pieces: Array, at: NDArray[np.intp]) -> None:
        """Let runs that have passed the end of their piece go on with the next."""
        progress = motion[Motion._fields.index("progress")]
        passed = (progress > pieces[4]).nonzero()[0]
        if len(passed):
            at[passed] += 1
            pieces[:, passed] = self.pieces[:, at[passed]]
