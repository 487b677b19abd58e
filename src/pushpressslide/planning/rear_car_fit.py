"""The car that models a push on one face, fitted to the exact limit surface."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.motion import Motion
from pushpressslide.core.pose import Point
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face
from pushpressslide.mechanics.top import rooms_inside
from pushpressslide.mechanics.virtual_axle import turned
from pushpressslide.planning.rear_car import HARDER, planned_share
from pushpressslide.planning.side_contacts import lone_contact_height, pushable
from pushpressslide.rom.drives import ORIGIN
from pushpressslide.rom.rear_steer_car import STEERING_LIMIT, RearSteerCar

RESOLUTION = 6  # of the base
# numbers of force angles evaluated, up to the one that the object must withstand, and
# from there to the cone's edge
ANGLES = (5, 3)
SIDES = (1.0, -1.0)  # left and right of the heading axis
# [rad] smallest angle of the cone to one side, for a heading axis outside it
LEAST_EDGE = 1e-3


class FittedCar(NamedTuple):
    """Reduced model of a push, and the distance of the model's CoP ahead of the CoM."""

    car: RearSteerCar
    shift: float  # [m]


class FittedFace(NamedTuple):
    """A face, and the cars that model pushes on it."""

    face: Face
    cars: Mapping[float, FittedCar]  # cars by share of the friction; empty if refused
    refusal: Refusal | None


@lru_cache(maxsize=64)
def fitted_faces(scene: Scene, motion: Motion) -> tuple[FittedFace, ...]:
    """Faces that can be pushed, with their cars."""
    pushed = pushable(scene, lone_contact_height(scene, motion), motion.face)
    if not pushed:
        return ()
    twists = push_twists(scene, motion, pushed)
    return tuple(
        fitted_face(scene, motion, face, pair)
        for face, pair in zip(pushed, twists, strict=True)
    )


def fitted_face(scene: Scene, motion: Motion, face: Face, twists: Array) -> FittedFace:
    """Face with its cars, one for each hardness of a path. There are no cars if the
    object tips, or cannot be pushed straight.
    """
    cars = {}
    for harder in HARDER:
        share = planned_share(motion, harder)
        try:
            fitted = fitted_car(scene, motion, face, twists, share)
        except ValueError as error:
            return FittedFace(face, {}, refusal_of(error, "tipping"))
        low, high = fitted.car.curvature_limits
        if not low < 0.0 < high:
            text = f"cannot drive straight: curvature is in [{low:.2f}, {high:.2f}] 1/m"
            return FittedFace(face, {}, Refusal("not_straight", text))
        cars[harder] = fitted
    return FittedFace(face, cars, None)


def looked_at(scene: Scene, motion: Motion, face: Face) -> Array:
    """Sampled force angles (2, 8) [rad] of a push on ``face``, to the left and right of
    the heading axis, up to the cone's edges.
    """
    half = math.atan(scene.contact_friction)
    aside = math.atan2(face.offset, face.depth)  # of the normal from the heading axis
    edges = np.clip([half + aside, half - aside], LEAST_EDGE, STEERING_LIMIT)
    below, above = ANGLES
    planned = motion.curvature_margin
    shares = np.concatenate(
        [
            planned * np.arange(1, below + 1) / below,
            np.linspace(planned, 1.0, above + 1)[1:],
        ]
    )
    return np.outer(edges, shares)


def push_twists(scene: Scene, motion: Motion, pushed: Sequence[Face]) -> Array:
    """Twists (n, 2, 8, 3) of the CoM under pushes on n faces at the sampled angles, to
    the left and to the right.

    If a push to either side tips the object at an angle, the twists to both sides are
    NaN at this and all larger angles.
    """
    count = sum(ANGLES)
    feet = np.repeat([face.foot for face in pushed], 2 * count, axis=0)
    axes = np.array(
        [
            turned(_towards_center(face), side * angle)
            for face in pushed
            for side, angles in zip(SIDES, looked_at(scene, motion, face), strict=True)
            for angle in angles
        ]
    )
    lift = lone_contact_height(scene, motion) * scene.support.friction
    base = DraggedBase(scene.body, lift, RESOLUTION)
    slid = base.slide(np.zeros_like(feet), feet, axes)
    shifts = lift * slid.shares[:, None] * axes
    shifts /= 1.0 - margins.PUSH_TIPPING_MARGIN
    tips = np.isnan(slid.shares) | (rooms_inside(scene.body, shifts) < 0.0)
    twists = slid.twists.reshape(-1, 2, count, 3)
    tipped = np.logical_or.accumulate(tips.reshape(-1, 2, count).any(axis=1), axis=1)
    return np.where(tipped[:, None, :, None], math.nan, twists)


def _towards_center(face: Face) -> Point:
    """Unit vector from a face's foot to the CoM, or the face's normal if the two
    coincide.
    """
    x, y = face.foot
    lever = math.hypot(x, y)
    return (-x / lever, -y / lever) if lever > 0.0 else face.normal


def fitted_car(
    scene: Scene, motion: Motion, face: Face, twists: Array, share: float
) -> FittedCar:
    """Reduced model of a push on ``face`` along a path whose hardest turn is ``share``
    of the tightest.

    On the exact limit surface, the axle's position and the effective wheelbase change
    with the force angle, since the push itself shifts the load. The car has the values
    at the angles of the path's turns, averaged over both sides. At these angles its
    curvature is ``share`` of the tightest among ``twists`` (from ``push_twists``), and
    the car is not steered to tighter curves. A model with a longer wheelbase than the
    object gives stable tracking; a shorter one does not. A thin bar pushed across its
    length turns nearly as tightly at 8 degrees as at the cone's edge, and an even
    thinner bar turns less tightly beyond this angle.

    Raises RefusedError if the object tips at the planned share of the edge.
    """
    mu = scene.contact_friction
    height = lone_contact_height(scene, motion)
    shift = height * scene.support.friction
    if scene.rho is not None:
        car = RearSteerCar(face.foot, face.normal, ORIGIN, scene.rho, mu)
        return FittedCar(car, shift)
    if np.isnan(twists[:, : ANGLES[0]]).any():
        text = "a push at {figure:mm.0f} tips the object where it turns"
        raise RefusedError(Refusal("tipping", text, height, unit="m"))
    lever = math.hypot(*face.foot)
    ex = -face.foot[0] / lever
    ey = -face.foot[1] / lever
    standing = ~np.isnan(twists[0, :, 0])
    vx, vy, w = np.moveaxis(twists[:, standing], -1, 0)
    curvatures = w / (vx * ex + vy * ey)
    tangents = np.tan(looked_at(scene, motion, face)[:, standing])
    wheelbases = tangents.sum(axis=0) / (curvatures[1] - curvatures[0])
    across = ey * vx - ex * vy
    axles = (across[0] - across[1]) / (w[0] - w[1])
    # an ellipsoid about the shifted CoP has both equal; the longer one is stable
    wheelbases = np.maximum(wheelbases, axles - shift)
    turns = tangents.mean(axis=0) / wheelbases
    turning = share * float(turns.max())
    first = int(np.argmax(turns >= turning))
    rising = slice(max(first - 1, 0), first + 1)
    axle = float(np.interp(turning, turns[rising], axles[rising]))
    wheelbase = float(np.interp(turning, turns[rising], wheelbases[rising]))
    rho = math.sqrt(lever * wheelbase)
    # a force to the left turns the object to the right
    leftward, rightward = (tangents / wheelbases).max(axis=1)
    bounds = (-float(leftward), float(rightward))
    car = RearSteerCar(face.foot, face.normal, ORIGIN, rho, mu, bounds)
    return FittedCar(car, axle - wheelbase)
