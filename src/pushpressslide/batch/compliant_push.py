"""The name that a tip which pushes a body on the ellipsoid had before: ``batch.sliding``."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np

from pushpressslide.batch.rows import answers, figures_of, spread
from pushpressslide.batch.sliding import slide
from pushpressslide.batch.support import ellipsoid_support
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.compliant_tip import FREE, STICK, side_touch


class PushingTip(NamedTuple):
    """Tips at faces (n,); places from the centre of pressure, along the inward normal n
    and to its left t.
    """

    fn: Array  # [N] f_0, less b times the speed at which the gap closes
    ft: Array  # [N]
    pn: Array  # [m] of the contact
    pt: Array
    cn: Array  # [m] of the tip's centre along n; along t it is where the contact is
    friction: Array  # of the pair tip/body
    drag: Array  # [N] mu_s N of the body
    square: Array  # [m^2] rho^2


class TipPushed(NamedTuple):
    """What tips do: their forces on the bodies, and how these move."""

    fn: Array  # [N]
    ft: Array
    slide: Array  # b times the body's velocity per force; 0: it is at rest
    sticks: Array  # truth value
    touches: Array  # truth value


def tip_pushed(tip: PushingTip) -> TipPushed:
    """Return what tips do at their faces: they stick, slip, or leave them."""
    warnings.warn(
        "pushpressslide.batch.compliant_push.tip_pushed is deprecated; call "
        "pushpressslide.batch.sliding.slide",
        DeprecationWarning,
        stacklevel=2,
    )
    fn, ft, pn, pt, cn, friction, drag, square = np.broadcast_arrays(*tip)
    rho = np.sqrt(square)
    one = np.ones_like(rho)
    none = 0.0 * one
    columns = (one, none, fn, ft, one, one, friction, -pt / rho, pn / rho, cn / rho)
    rows = np.stack(columns, axis=-1)
    twists = slide(ellipsoid_support(drag, rho), [rows], np.zeros((len(rows), 3)))
    twists[:, 2] /= rho
    law = ((one, none), (fn, ft), (one, one))
    contact = figures_of(((pn, pt), (cn, pt), law, friction, none))
    out = answers(side_touch, spread(twists), contact, columns=11)
    force = out[:, :2]
    status = out[:, 6]
    size = np.where(status == FREE, 1.0, (force * force).sum(axis=1))
    slides = (force * twists[:, :2]).sum(axis=1) / size
    touches = status != FREE
    return TipPushed(force[:, 0], force[:, 1], slides, status == STICK, touches)
