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
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.scene import Scene
from pushpressslide.identification.parameter_estimates import MOST_FRICTION
from pushpressslide.identification.pressed_travel import (
    PressedTravel,
    without_repeats,
)
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.turns import dragged_along

# standard deviations of the model: of a turn and of a drag, as shares of them
MODEL_SHARE = 0.06
MODEL_FORCE = 0.06
TIP_PLACE = 2e-3  # [m] standard deviation of a tip's place on the object
LEAST_ERROR = 0.05  # of the mass that is known best
MEMBERS = 20  # of the ensemble
STEPS = 3  # in which it is updated
OUTLYING = 2.0  # standard deviations above which what is measured counts less


class PressedBody(NamedTuple):
    """What presses have told of an object."""

    mass: float  # [kg]
    mass_error: float  # as a ``belief.mass_error``
    center: CenterBelief
    friction: float  # of the support

    def within(self, scene: Scene) -> Scene:
        """The ``scene`` with mass and friction of the body."""
        return replace(
            scene,
            body=replace(scene.body, mass=self.mass),
            support=replace(scene.support, friction=self.friction),
        )


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
    if not travels:
        return None
    fit = _Fit(scene, center, without_repeats(travels), force_noise)
    rng = np.random.default_rng(0)
    members = fit.prior(rng)
    for _ in range(STEPS):
        members = fit.updated(members, rng)
    return fit.pressed_body(members)


class _Fit:
    """Ensemble smoother (Emerick and Reynolds, Computers & Geosciences 55, 2013) of mass,
    centre and drag. It needs no derivatives of the model, which is rough.

    Members (K, 4) are logarithms of the mass and of the drag over the believed ones, and
    between them the centre in standard deviations of its belief.
    """

    def __init__(
        self,
        scene: Scene,
        center: CenterBelief,
        travels: Sequence[PressedTravel],
        force_noise: float,
    ) -> None:
        """Bind to what is believed, and to ``travels`` with forces of a standard
        deviation ``force_noise`` [N].
        """
        self._scene = scene
        self._center = center
        self._travels = travels
        self._spread = _square_root(center)
        self._load = math.fsum(travel.load for travel in travels) / len(travels)
        self._directions = np.array([travel.direction for travel in travels])
        self._lengths = np.array([travel.length for travel in travels])
        turns = np.array([travel.turn for travel in travels])
        forces = np.array([travel.force for travel in travels])
        unsure = np.array([travel.deviation for travel in travels])
        pictures = np.array([travel.pictures for travel in travels])
        levers = np.array([math.dist(one.place, center.place) for one in travels])
        aside = np.hypot(TIP_PLACE / np.maximum(levers, TIP_PLACE), unsure)
        likeliest = self._body(np.zeros(4))
        straight, _ = self._dragged(likeliest, self._directions)
        beside, _ = self._dragged(likeliest, self._directions + aside)
        sensitive = np.nan_to_num((beside - straight) * self._lengths)
        turn_errors = np.sqrt(unsure**2 + (MODEL_SHARE * turns) ** 2 + sensitive**2)
        force_errors = np.hypot(MODEL_FORCE * forces, force_noise / np.sqrt(pictures))
        self._errors = np.concatenate([turn_errors, force_errors])
        self._measured = np.concatenate([turns, forces]) / self._errors

    def prior(self, rng: np.random.Generator) -> Array:
        """Members (K, 4) as believed."""
        scene = self._scene
        # what is hoped for is at the edge of what is believed
        wide = 2.0 if scene.dares else 1.0
        unsure = wide * math.log(1.0 + scene.mass_error)
        unsure_friction = wide * math.log(1.0 + scene.friction_error)
        normal = rng.normal(size=(MEMBERS, 4))
        normal -= normal.mean(0)
        normal = np.linalg.solve(np.linalg.cholesky(np.cov(normal.T)), normal.T).T
        mass = unsure * normal[:, 0]
        weight = GRAVITY * scene.body.mass
        loaded = np.log((weight * np.exp(mass) + self._load) / (weight + self._load))
        drag = unsure_friction * normal[:, 3] + loaded
        return np.column_stack([mass, normal[:, 1:3], drag])

    def updated(self, members: Array, rng: np.random.Generator) -> Array:
        """Members (K, 4) after one of STEPS updates by all that is measured."""
        expected = np.array([self._expected(member) for member in members])
        middle = np.nan_to_num(np.nanmean(expected, axis=0))
        expected = np.where(np.isnan(expected), middle, expected)
        off = self._measured - expected
        A = members - members.mean(0)
        G = expected - expected.mean(0)
        C = G.T @ G / MEMBERS
        beyond = off.mean(0) / np.sqrt(1.0 + np.diag(C)) / OUTLYING
        noise = STEPS * np.maximum(1.0, beyond * beyond)
        gain = np.linalg.solve(C + np.diag(noise), G.T @ A / MEMBERS)
        off += np.sqrt(noise) * rng.normal(size=off.shape)
        updated: Array = members + off @ gain
        return updated

    def pressed_body(self, members: Array) -> PressedBody:
        """Mean of the ``members`` (K, 4), and how they spread."""
        body = self._body(members.mean(0))
        P = np.cov(members.T)
        spread = self._spread
        (xx, xy), (_, yy) = (spread @ P[1:3, 1:3] @ spread.T).tolist()
        common = TIP_PLACE * TIP_PLACE  # the same in all travels
        error = max(LEAST_ERROR, 2.0 * math.sqrt(P[0, 0]))
        place = CenterBelief(
            body.x, body.y, xx + common, xy, yy + common, self._center.before
        )
        return PressedBody(
            body.mass, min(self._scene.mass_error, error), place, body.friction
        )

    def _body(self, member: Array) -> _Body:
        """Body of a ``member`` (4,)."""
        off_x, off_y = (self._spread @ member[1:3]).tolist()
        scene = self._scene
        mass = scene.body.mass * math.exp(float(member[0]))
        # the drag tells friction and mass together
        before, now = (GRAVITY * m + self._load for m in (scene.body.mass, mass))
        friction = scene.support.friction * math.exp(float(member[3])) * before / now
        x, y = self._center.x + off_x, self._center.y + off_y
        return _Body(mass, x, y, min(friction, MOST_FRICTION))

    def _expected(self, member: Array) -> Array:
        """Turns and forces (2 n,) of a ``member``, over their errors. Turns are NaN where
        it would tip.
        """
        body = self._body(member)
        turns, shares = self._dragged(body, self._directions)
        weight = GRAVITY * body.mass
        loads = np.array([weight + travel.load for travel in self._travels])
        forces = np.nan_to_num(shares, nan=1.0) * body.friction * loads
        out: Array = np.concatenate([turns * self._lengths, forces]) / self._errors
        return out

    def _dragged(self, body: _Body, directions: Array) -> tuple[Array, Array]:
        """``dragged_along`` of a ``body``, in ``directions`` (n,) [rad]."""
        scene = self._scene
        model = replace(scene.body, mass=body.mass, center_of_mass=(body.x, body.y))
        presses = []
        for travel in self._travels:
            x, y = travel.place
            contact = (x - body.x, y - body.y)
            presses.append(Press(model, body.friction, contact, travel.load, scene.rho))
        return dragged_along(presses, directions)


def _square_root(center: CenterBelief) -> Array:
    """Square root (2, 2) [m] of the covariance of a ``center``."""
    P = np.array(((center.xx, center.xy), (center.xy, center.yy)))
    values, vectors = np.linalg.eigh(P)
    out: Array = vectors * np.sqrt(np.maximum(values, 0.0))
    return out
