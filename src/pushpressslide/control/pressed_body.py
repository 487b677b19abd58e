"""Mass, centre of mass and friction of an object that single presses have dragged, by its
turns and the drag.

The object of weight W under a press of N has its centre of pressure at the share N / (W +
N) of the way from the centre of mass to the tip. So both decide how it turns in which
direction (docs/mechanics.md, sections 1.2 and 4.1). The planner's own model is fitted to
the travels, with what was believed before the run as the prior.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.core.arrays import Array
from pushpressslide.core.scene import Scene
from pushpressslide.identification.parameter_estimates import MOST_FRICTION
from pushpressslide.identification.pressed_travel import PressedTravel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.turns import dragged_along

# standard deviations of the model: of a turn, as a share of it, and of one that is small
MODEL_SHARE = 0.06
MODEL_TURN = 0.1  # [rad/m]
MODEL_FORCE = 0.06  # of a drag, as a share of it
LEAST_ERROR = 0.05  # of the mass that is known best
STEP = 0.1  # of the difference quotients, in standard deviations of the belief
EVALUATIONS = 8  # of the fit, at most
TIPPED = 3.0  # residual of a travel in which the model tips


class PressedBody(NamedTuple):
    """What presses have told of an object."""

    mass: float  # [kg]
    mass_error: float  # as a ``belief.mass_error``
    center: CenterBelief
    friction: float  # of the support


class _Body(NamedTuple):
    """An object that might have turned like that."""

    mass: float  # [kg]
    x: float  # [m] of its centre, in G
    y: float  # [m]
    friction: float  # of its support


class PressedFit:
    """The last fit of a run: what it is asked for several times after a placement."""

    def __init__(self, scene: Scene, force_noise: float) -> None:
        """Bind to the ``scene`` as believed before the run. Forces have the standard
        deviation ``force_noise`` [N].
        """
        self._scene = scene
        self._noise = force_noise
        self._key: tuple[CenterBelief, tuple[PressedTravel, ...]] | None = None
        self._body: PressedBody | None = None

    def body(
        self, center: CenterBelief | None, travels: tuple[PressedTravel, ...]
    ) -> PressedBody | None:
        """``pressed_body`` of the scene. None if the ``center`` is sure."""
        if center is None:
            return None
        key = (center, travels)
        if key != self._key:
            self._key = key
            self._body = pressed_body(self._scene, center, travels, self._noise)
        return self._body


def pressed_body(
    scene: Scene,
    center: CenterBelief,
    travels: Sequence[PressedTravel],
    force_noise: float = 0.0,
) -> PressedBody | None:
    """Mass, centre of mass and friction by ``travels``, with forces of a standard
    deviation ``force_noise`` [N]. ``scene`` and ``center`` are believed without them.
    None if there are none.
    """
    from scipy.optimize import least_squares

    if not travels:
        return None
    unsure = math.log(1.0 + scene.mass_error)
    unsure_friction = math.log(1.0 + scene.friction_error)
    spread = _square_root(center)

    def body(parameters: Array) -> _Body:
        """Body of ``parameters`` (4,)."""
        first, *others, last = parameters - 1.0
        off_x, off_y = (spread @ others).tolist()
        mass = scene.body.mass * math.exp(unsure * float(first))
        friction = scene.support.friction * math.exp(unsure_friction * float(last))
        x, y = center.x + off_x, center.y + off_y
        return _Body(mass, x, y, min(friction, MOST_FRICTION))

    def residuals(parameters: Array) -> Array:
        """Errors of belief, turns and forces, each over its standard deviation."""
        errors = _errors(scene, body(parameters), travels, force_noise)
        return np.concatenate([parameters - 1.0, errors])

    # about one: a difference quotient has a step relative to the parameter
    fit = least_squares(
        residuals, np.ones(4), diff_step=STEP, max_nfev=EVALUATIONS, loss="soft_l1"
    )
    P = np.linalg.inv(fit.jac.T @ fit.jac)
    best = body(fit.x)
    (xx, xy), (_, yy) = (spread @ P[1:3, 1:3] @ spread.T).tolist()
    error = min(scene.mass_error, max(LEAST_ERROR, 2.0 * unsure * math.sqrt(P[0, 0])))
    place = CenterBelief(best.x, best.y, xx, xy, yy, center.before)
    return PressedBody(best.mass, error, place, best.friction)


def _errors(
    scene: Scene,
    body: _Body,
    travels: Sequence[PressedTravel],
    force_noise: float,
) -> Array:
    """Errors (2 n,) of the turns and forces that a ``body`` would have had in
    ``travels``, each over its standard deviation.
    """
    model = replace(scene.body, mass=body.mass, center_of_mass=(body.x, body.y))
    presses = []
    for travel in travels:
        x, y = travel.place
        contact = (x - body.x, y - body.y)
        presses.append(Press(model, body.friction, contact, travel.load, scene.rho))
    directions = np.array([travel.direction for travel in travels])
    lengths = np.array([travel.length for travel in travels])
    turns = np.array([travel.turn for travel in travels])
    unsure = np.array([travel.deviation for travel in travels])
    forces = np.array([travel.force for travel in travels])
    pictures = np.array([travel.pictures for travel in travels])
    loads = np.array([press.weight + press.load for press in presses])
    expected, shares = dragged_along(presses, directions)
    off = (turns - expected * lengths) / np.sqrt(
        unsure**2 + (MODEL_SHARE * turns) ** 2 + (MODEL_TURN * lengths) ** 2
    )
    off_force = (forces - shares * body.friction * loads) / np.hypot(
        MODEL_FORCE * forces, force_noise / np.sqrt(pictures)
    )
    out: Array = np.nan_to_num(np.concatenate([off, off_force]), nan=TIPPED)
    return out


def _square_root(center: CenterBelief) -> Array:
    """Square root (2, 2) [m] of the covariance of a ``center``."""
    P = np.array(((center.xx, center.xy), (center.xy, center.yy)))
    values, vectors = np.linalg.eigh(P)
    out: Array = vectors * np.sqrt(np.maximum(values, 0.0))
    return out
