"""A compliant tip that pushes a flat face of a body on the ellipsoid, on arrays: the
planar engine's contact with one tip, where its exact surface is replaced by an ellipsoid.

The tip's law is f = f_0 - b v, v the velocity of its centre: a force and a damper, the
same in all directions of the plane. A body that slides has the twist that is normal to
its ellipsoid, so that the force follows from one unknown, how fast it slides: Newton's
steps on 1/N, which is nearly linear in it. Source: docs/mechanics.md, sections 1 to 3;
``planar.contact`` and ``planar.sliding`` for one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.core.formulas import Column, greater, least, where


class PushingTip(NamedTuple):
    """A tip at a face; places from the centre of pressure, along the inward normal n and
    to its left t.
    """

    fn: Column  # [N] f_0, less b times the speed at which the gap closes
    ft: Column  # [N]
    pn: Column  # [m] of the contact
    pt: Column
    cn: Column  # [m] of the tip's centre along n; along t it is where the contact is
    friction: Column  # of the pair tip/body
    drag: Column  # [N] mu_s N of the body
    square: Column  # [m^2] rho^2


class TipPushed(NamedTuple):
    """What the tip does: its force on the body, and how the body moves."""

    fn: Column  # [N]
    ft: Column
    slide: Column  # b times the body's velocity per force; 0: it is at rest
    sticks: Column  # truth value
    touches: Column  # truth value


def held(
    slide: Column, tip: PushingTip, fn: Column, ft: Column
) -> tuple[Column, Column]:
    """Return (1 + slide A)^-1 (fn, ft), A f the velocity of the tip's centre under f."""
    a = 1.0 + slide * (1.0 + tip.pt * tip.pt / tip.square)
    b = -slide * tip.pt * tip.pn / tip.square
    c = -slide * tip.cn * tip.pt / tip.square
    d = 1.0 + slide * (1.0 + tip.cn * tip.pn / tip.square)
    size = a * d - b * c
    return (d * fn - b * ft) / size, (a * ft - c * fn) / size


def nearer(slide: Column, tip: PushingTip) -> Column:
    """Return ``slide`` after a step of Newton towards the limit of the drag."""
    fn, ft = held(slide, tip, tip.fn, tip.ft)
    moment = tip.pn * ft - tip.pt * fn
    turn = moment / tip.square
    gn, gt = held(slide, tip, fn - tip.pt * turn, ft + tip.cn * turn)
    load = np.sqrt(fn * fn + ft * ft + moment * turn)
    fall = (fn * gn + ft * gt + (tip.pn * gt - tip.pt * gn) * turn) / load
    step = load * (load / tip.drag - 1.0) / fall
    return greater(slide + where(fall > 0.0, step, 0.0), 0.0)


def tip_pushed(tip: PushingTip) -> TipPushed:
    """Return what a tip does at its face: it sticks, slips, or leaves it."""
    slide = nearer(nearer(nearer(nearer(0.0 * tip.fn, tip), tip), tip), tip)
    fn, ft = held(slide, tip, tip.fn, tip.ft)
    sticks = np.abs(ft) <= tip.friction * fn
    # along an edge of its cone the force has one unknown
    side = where(ft > 0.0, tip.friction, -tip.friction)
    moment = tip.pn * side - tip.pt
    turn = moment / tip.square
    most = tip.drag / np.sqrt(1.0 + side * side + moment * turn)
    slips = least(tip.fn, most)
    speed = (tip.fn / where(slips > 0.0, slips, 1.0) - 1.0) / (1.0 - tip.pt * turn)
    fn = where(sticks, fn, slips)
    touches = fn > 0.0
    slide = where(sticks, slide, greater(speed, 0.0))
    return TipPushed(
        where(touches, fn, 0.0),
        where(touches, where(sticks, ft, side * slips), 0.0),
        where(touches, slide, 0.0),
        sticks & touches,
        touches,
    )
