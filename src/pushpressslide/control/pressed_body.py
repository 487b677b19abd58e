"""Mass and centre of mass of an object that single presses have dragged, by its turns.

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
from pushpressslide.identification.pressed_travel import PressedTravel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.turns import turns_along

MODEL_SHARE = 0.06  # standard deviation of the model's turns, as a share of them
MODEL_TURN = 0.1  # [rad/m] the same of travels that hardly turn
LEAST_ERROR = 0.05  # of the mass that is known best
STEP = 0.1  # of the difference quotients, in standard deviations of the belief
EVALUATIONS = 8  # of the fit, at most
TIPPED = 3.0  # residual of a travel in which the model tips


class Drag(NamedTuple):
    """A travel, and the drag felt under its press."""

    travel: PressedTravel
    drag: float  # [N]


class PressedBody(NamedTuple):
    """What presses have told of an object."""

    mass: float  # [kg]
    mass_error: float  # as a ``belief.mass_error``
    center: CenterBelief
    friction: float  # of the support


class PressedFit:
    """The last fit of a run: what it is asked for several times after a placement."""

    def __init__(self, scene: Scene) -> None:
        """Bind to the ``scene`` as believed before the run."""
        self._scene = scene
        self._key: tuple[CenterBelief, tuple[Drag, ...]] | None = None
        self._body: PressedBody | None = None

    def body(
        self, center: CenterBelief | None, drags: tuple[Drag, ...]
    ) -> PressedBody | None:
        """``pressed_body`` of the scene. None if the ``center`` is sure."""
        if center is None:
            return None
        key = (center, drags)
        if key != self._key:
            self._key = key
            self._body = pressed_body(self._scene, center, drags)
        return self._body


def pressed_body(
    scene: Scene, center: CenterBelief, drags: Sequence[Drag]
) -> PressedBody | None:
    """Mass and centre of mass by ``drags``. ``scene`` and ``center`` are believed
    without them. None if they tell nothing, or the belief is sure of both.
    """
    from scipy.optimize import least_squares

    unsure = math.log(1.0 + scene.mass_error)
    spread = _square_root(center)
    if not drags or (unsure == 0.0 and not spread.any()):
        return None

    def body(parameters: Array) -> tuple[float, float, float]:
        """Mass [kg] and centre of mass [m] in G of ``parameters`` (3,)."""
        first, *others = parameters - 1.0
        off_x, off_y = (spread @ others).tolist()
        mass = scene.body.mass * math.exp(unsure * float(first))
        return mass, center.x + off_x, center.y + off_y

    def residuals(parameters: Array) -> Array:
        """Errors of belief and turns, each over its standard deviation."""
        errors = _errors(scene, *body(parameters), drags)
        return np.concatenate([parameters - 1.0, errors])

    # about one: a difference quotient has a step relative to the parameter
    fit = least_squares(residuals, np.ones(3), diff_step=STEP, max_nfev=EVALUATIONS)
    P = np.linalg.inv(fit.jac.T @ fit.jac)
    mass, x, y = body(fit.x)
    (xx, xy), (_, yy) = (spread @ P[1:, 1:] @ spread.T).tolist()
    error = min(scene.mass_error, max(LEAST_ERROR, 2.0 * unsure * math.sqrt(P[0, 0])))
    place = CenterBelief(x, y, xx, xy, yy, center.before)
    return PressedBody(mass, error, place, _friction(scene, mass, drags))


def _errors(
    scene: Scene, mass: float, x: float, y: float, drags: Sequence[Drag]
) -> Array:
    """Errors (n,) of the turns of a body with its ``mass`` [kg] and its centre at ``x``
    and ``y`` [m] in G, each over its standard deviation.
    """
    body = replace(scene.body, mass=mass, center_of_mass=(x, y))
    friction = _friction(scene, mass, drags)
    presses = []
    for travel, _ in drags:
        place = (travel.place[0] - x, travel.place[1] - y)
        presses.append(Press(body, friction, place, travel.load, scene.rho))
    directions = [math.atan2(*reversed(travel.way)) for travel, _ in drags]
    lengths = np.array([travel.length for travel, _ in drags])
    turns = np.array([travel.turn for travel, _ in drags])
    unsure = np.array([travel.deviation for travel, _ in drags])
    expected = turns_along(presses, np.array(directions)) * lengths
    deviations = np.sqrt(
        unsure**2 + (MODEL_SHARE * turns) ** 2 + (MODEL_TURN * lengths) ** 2
    )
    out: Array = np.nan_to_num((turns - expected) / deviations, nan=TIPPED)
    return out


def _friction(scene: Scene, mass: float, drags: Sequence[Drag]) -> float:
    """Friction of the support under an object of a ``mass`` [kg]."""
    weight = scene.weight_on * mass / scene.body.mass
    frictions = [drag / (weight + travel.load) for travel, drag in drags]
    return math.fsum(frictions) / len(frictions)


def _square_root(center: CenterBelief) -> Array:
    """Square root (2, 2) [m] of the covariance of a ``center``."""
    P = np.array(((center.xx, center.xy), (center.xy, center.yy)))
    values, vectors = np.linalg.eigh(P)
    out: Array = vectors * np.sqrt(np.maximum(values, 0.0))
    return out
