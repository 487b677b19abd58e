"""Odds that a plan leads to its goal without a recovery, over truths that the belief's
stated errors allow.

Both frictions and the mass are drawn evenly within ``belief.friction_error`` and
``belief.mass_error``, the centre of mass evenly on the disc of ``belief.center_error``.
A centre off the base is replaced by the believed one, since the object stands. At
places along the planned path, quasi-statics gives the contact forces that move each
true object as planned:

    slip      forces leave their true cones; the tips slide against the servo's damping,
              farther than all touches of the planned places put back
    tipping   the centre of pressure lies off the base
    off path  no forces in the believed cones move the object as planned; or one contact
              cannot turn it to either side as much as the heading error of the true
              centre needs

The limit surface is the ellipsoid of the segment's drive, with the true load, friction
and centre. Two contacts share the forces as their equal dampings do. The object is taken
to be on its path, with the centre identified, and wider turns than planned to be found
by replans. The odds do not see approach and touch, noise and delay, transients, a
pressure that differs from the planned one, replans that go round in circles, obstacles,
edges of a table, pushed bodies, or limits of the arms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.batch.limit_surface import EllipsoidSurface
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.squeeze import Squeeze
from pushpressslide.modes import MODES
from pushpressslide.rom.drives import (
    RearSteerDrive,
    SurfaceDrive,
    UnicycleDrive,
)

TRUTHS = 500
PLACES = 12  # of a segment at which its forces are compared
RETOUCHES = 3  # times that a tip which slid is put back, as in control.supervisor
BACK = 4.0
"""Curvature [1/m] that turns the heading by an angle [rad] over a path of a length [m],
and leaves the ends of the path in place, times length over angle."""
STANDS, SLIP, TIPPING, OFF_PATH = range(4)

Flags = NDArray[np.bool_]


class Truths(NamedTuple):
    """True parameters of n objects on their supports."""

    support_friction: Array  # (n,)
    contact_friction: Array  # (n,)
    mass: Array  # (n,) [kg]
    centers: Array  # (n, 2) [m] centres of mass in B


class Loads(NamedTuple):
    """Loads of n objects on their supports."""

    friction: Array  # (n,) [N] mu_s N
    centers: Array  # (n, 2) [m] centres of pressure in B, without drag


@dataclass(frozen=True, slots=True)
class Odds:
    """Numbers of truths by what fails first."""

    truths: int
    slip: int
    tipping: int
    off_path: int

    @property
    def arrivals(self) -> int:
        """Number of truths for which nothing fails."""
        return self.truths - self.slip - self.tipping - self.off_path

    @property
    def share(self) -> float:
        """Share of the truths for which nothing fails."""
        return self.arrivals / self.truths


def drawn_truths(scene: Scene, seed: int = 0, count: int = TRUTHS) -> Truths:
    """Truths drawn within the errors that a believed scene states."""
    rng = np.random.default_rng(seed)
    support, contact, mass = rng.uniform(-1.0, 1.0, (3, count))
    distances = scene.center_error * np.sqrt(rng.random(count))
    angles = rng.uniform(-math.pi, math.pi, count)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    centers = distances[:, None] * directions
    gauge = scene.body.shape.gauge()
    stands = [gauge(x, y) < 1.0 for x, y in (centers - _middle(scene)).tolist()]
    return Truths(
        scene.support.friction * (1.0 + scene.friction_error * support),
        scene.contact_friction * (1.0 + scene.friction_error * contact),
        scene.body.mass * (1.0 + scene.mass_error * mass),
        np.where(np.array(stands)[:, None], centers, 0.0),
    )


def odds(
    queries: Sequence[MotionQuery],
    segments: Sequence[Segment],
    seed: int = 0,
    count: int = TRUTHS,
) -> Odds:
    """Odds of a plan's ``segments``. ``queries`` are those of all legs.

    Raises PushPressSlideError for an object with a weight along its support.
    """
    scene = queries[0].scene
    if any(scene.weight_along):
        kind = scene.support.kind
        reason = f"support.kind {kind} is not allowed; allowed: a level table"
        raise PushPressSlideError(f"--odds: {reason}")
    truths = drawn_truths(scene, seed, count)
    failures = [
        _failures(queries[segment.leg], segment, truths) for segment in segments
    ]
    first = _first(np.concatenate([np.zeros((count, 1), dtype=int), *failures], axis=1))
    counts = np.bincount(first, minlength=4).tolist()
    return Odds(count, counts[SLIP], counts[TIPPING], counts[OFF_PATH])


def ranked_by_odds(
    queries: Sequence[MotionQuery], choices: Sequence[Choice]
) -> list[Choice]:
    """The ranked ``choices`` of one placement. Feasible ones whose odds fall short of the
    best odds by more than ``motion.risk`` follow the others, the better odds first.

    The order is kept without ``motion.risk``, in a search for sequences, and with a
    weight along the support. ``queries`` are those of all legs.
    """
    query = queries[choices[0].leg] if choices else queries[0]
    risk = query.motion.risk
    if risk is None or query.from_search or any(query.scene.weight_along):
        return list(choices)
    feasible = [choice for choice in choices if choice.feasible]
    shares = [odds(queries, choice.segments).share for choice in feasible]
    least = max(shares, default=0.0) - risk
    shortfalls = [0.0 if share >= least else least - share for share in shares]
    order = sorted(range(len(feasible)), key=shortfalls.__getitem__)
    refused = [choice for choice in choices if not choice.feasible]
    return [feasible[i] for i in order] + refused


def _first(failures: NDArray[np.int_]) -> NDArray[np.int_]:
    """First failure of each row, or STANDS."""
    rows = np.arange(len(failures))
    out: NDArray[np.int_] = failures[rows, (failures != STANDS).argmax(axis=1)]
    return out


def _failures(query: MotionQuery, segment: Segment, truths: Truths) -> NDArray[np.int_]:
    """Failures (n, m) of n truths at m places of a segment."""
    guides = _guides(query, segment)
    loads = _true_loads(segment.contacts, truths)
    tips = _tips(query.scene, segment, guides, truths, loads)
    judge = _one_press
    if len(segment.contacts) > 1:
        judge = _two_contacts
    elif segment.contacts[0].kind == "side":
        judge = _one_push
    slips, off = judge(query, segment, guides, truths, loads)
    out: NDArray[np.int_] = np.select(
        [tips, slips, off], [TIPPING, SLIP, OFF_PATH], STANDS
    )
    return out


def _guides(query: MotionQuery, segment: Segment) -> list[Guidance]:
    """Guidance on the path, at evenly spaced places."""
    tracker = MODES[segment.mode].tracker(query, segment)
    speed = segment.profile.speed
    out = []
    for s in np.linspace(0.0, segment.path.length, PLACES).tolist():
        X_WB = segment.body_pose(s)
        out.append(tracker.step(segment.path, X_WB, s, speed, 1.0))
    return out


def _true_loads(contacts: Sequence[Contact], truths: Truths) -> Loads:
    """Loads under the presses among ``contacts``."""
    own = truths.mass * GRAVITY
    load = own.copy()
    moments = own[:, None] * truths.centers
    for contact in contacts:
        load += contact.load
        moments += contact.load * np.array(contact.point)
    return Loads(truths.support_friction * load, moments / load[:, None])


def _planned_loads(scene: Scene, contacts: Sequence[Contact]) -> Loads:
    """Loads (1,) of the believed object under the presses among ``contacts``."""
    believed = Truths(
        np.array([scene.support.friction]),
        np.array([scene.contact_friction]),
        np.array([scene.body.mass]),
        np.zeros((1, 2)),
    )
    return _true_loads(contacts, believed)


def _lifts(scene: Scene, segment: Segment, truths: Truths) -> Array:
    """Displacement (n,) [m] of the centres of pressure by a drag of mu_s N."""
    lift = scene.support.friction * segment.contacts[0].height
    if isinstance(segment.drive, SurfaceDrive):
        lift = segment.drive.surface.lift
    return lift * truths.support_friction / scene.support.friction


def _tips(
    scene: Scene,
    segment: Segment,
    guides: Sequence[Guidance],
    truths: Truths,
    loads: Loads,
) -> Flags:
    """Whether n truths tip at m places."""
    gauge = scene.body.shape.gauge()
    forces = np.array([(guide.fx, guide.fy) for guide in guides])
    drags = forces / segment.drive.max_friction
    lifts = _lifts(scene, segment, truths)
    cops = loads.centers[:, None] + lifts[:, None, None] * drags
    places = (cops - _middle(scene)).reshape(-1, 2).tolist()
    out: Flags = np.array([gauge(x, y) > 1.0 for x, y in places])
    return out.reshape(cops.shape[:2])


def _middle(scene: Scene) -> Array:
    """Middle (2,) [m] of the base in B."""
    body = scene.body
    out: Array = np.array(body.shape.middle) - np.array(body.center_of_mass)
    return out


def _slid(
    query: MotionQuery, segment: Segment, excess: Array, back: float = 0.0
) -> Flags:
    """Whether tips slide too far, under forces ``excess`` (n, m) [N] beyond friction.

    ``back`` [m/s] is the speed at which they are moved back meanwhile.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        speeds = np.nan_to_num(excess / query.motion.servo_damping, posinf=np.inf)
    time = segment.profile.duration / excess.shape[1]
    distances = np.cumsum(np.maximum(speeds - back, 0.0), axis=1) * time
    out: Flags = distances > (RETOUCHES + 1) * margins.ARM.retouch
    return out


def _one_push(
    query: MotionQuery,
    segment: Segment,
    guides: Sequence[Guidance],
    truths: Truths,
    loads: Loads,
) -> tuple[Flags, Flags]:
    """Whether a tip slides too far, and whether its cone is too narrow to steer."""
    drive = segment.drive
    assert isinstance(drive, RearSteerDrive)
    car = drive.car
    nx, ny = car.normal
    x, y = (np.array(car.cop) + truths.centers - np.array(car.contact)).T
    wheelbases = car.rho**2 / np.hypot(x, y)
    axes = np.arctan2(nx * y - ny * x, nx * x + ny * y)  # from the normal
    cones = np.arctan(truths.contact_friction)
    curvatures = np.array([guide.w for guide in guides]) / segment.profile.speed
    steering = np.arctan(wheelbases[:, None] * curvatures)
    led = (1.0 - margins.STEERING_RESERVE) * math.atan(car.mu)
    angles = np.clip(axes[:, None] - steering, -led, led)
    forces = _sizes(segment, guides) * loads.friction[:, None]
    beyond = np.sin(np.abs(angles) - cones[:, None]) / np.cos(cones)[:, None]
    slips = _slid(query, segment, forces * np.maximum(beyond, 0.0))
    # the angle that is left on the narrower side turns the object back
    room = np.minimum(cones, led) - np.abs(axes)
    back = BACK * np.abs(axes - car.eta) / segment.path.length
    off = np.tan(np.maximum(room, 0.0)) < wheelbases * back
    return slips, np.repeat((off | (room <= 0.0))[:, None], len(guides), axis=1)


def _sizes(segment: Segment, guides: Sequence[Guidance]) -> Array:
    """Sizes (m,) of the wanted forces, as shares of mu_s N."""
    sizes = [math.hypot(guide.fx, guide.fy) for guide in guides]
    return np.array(sizes) / segment.drive.max_friction


def _one_press(
    query: MotionQuery,
    segment: Segment,
    guides: Sequence[Guidance],
    truths: Truths,
    loads: Loads,
) -> tuple[Flags, Flags]:
    """Whether a press does not drag the object, though it is put back and pressed
    harder, and whether its steering is too weak.
    """
    (contact,) = segment.contacts
    most = max(contact.load, query.planned_force)
    load = min(margins.HARDER**RETOUCHES * contact.load, most)
    harder = (load - contact.load) * truths.support_friction
    needed = _sizes(segment, guides) * (loads.friction + harder)[:, None]
    slips = needed > (truths.contact_friction * load)[:, None]
    drive = segment.drive
    if not isinstance(drive, UnicycleDrive):
        return slips, np.zeros_like(slips)
    lever = np.array(contact.point) - np.array(drive.center)
    x, y = (np.array(contact.point) - loads.centers).T
    wheelbases = drive.car.rho**2 / np.hypot(x, y)
    turned = np.arctan2(lever[0] * y - lever[1] * x, lever[0] * x + lever[1] * y)
    back = BACK * np.abs(turned) / segment.path.length
    off = math.tan(drive.steepest) < wheelbases * back
    return slips, np.repeat(off[:, None], len(guides), axis=1)


def _two_contacts(
    query: MotionQuery,
    segment: Segment,
    guides: Sequence[Guidance],
    truths: Truths,
    loads: Loads,
) -> tuple[Flags, Flags]:
    """Whether tips slide too far, and whether two contacts could not move the object as
    planned even with the believed friction.

    The tips' dampings are equal, so that the forces are the allocated ones plus the
    smallest change that makes up the needed wrench. A squeeze along the line between the
    contacts changes no wrench. A tip slides as fast as brings the forces into their
    cones by this squeeze.
    """
    scene = query.scene
    believed = scene.contact_friction
    allocate = MODES[segment.mode].allocator_of(segment, believed)
    shares = [allocate(guide.fx, guide.fy, guide.tau) for guide in guides]
    planned = np.array([share.forces for share in shares]).reshape(-1, 4)
    normals = np.array([share.normals for share in shares])
    maps = np.array(
        [row for c in segment.contacts for row in _map_rows(*c.point)]
    )  # (4, 3), of twists to velocities
    change = maps @ np.linalg.inv(maps.T @ maps)
    needed = _needed_wrenches(scene, segment, guides, truths, loads)
    forces = planned + (needed - planned @ maps) @ change.T
    squeeze = Squeeze(segment.contacts, forces, normals)
    low, high, sliding = squeeze.bounds(truths.contact_friction)
    excess = np.clip(0.0, low, high)
    fits = low <= high
    back = 0.0
    if all(contact.kind == "side" for contact in segment.contacts):
        back = margins.ARM.return_share * segment.profile.speed
    slid = _slid(query, segment, np.where(fits, np.abs(excess) / sliding, np.inf), back)
    low, high, _ = squeeze.bounds(np.full(len(forces), believed))
    return slid & (low <= high), slid & (low > high)


def _map_rows(x: float, y: float) -> tuple[tuple[float, ...], ...]:
    """Velocity of a point [m] of B by a twist of B's origin."""
    return (1.0, 0.0, -y), (0.0, 1.0, x)


def _needed_wrenches(
    scene: Scene,
    segment: Segment,
    guides: Sequence[Guidance],
    truths: Truths,
    loads: Loads,
) -> Array:
    """Wrenches (n, m, 3) about B's origin that move n truths as planned at m places."""
    drive = segment.drive
    planned = _planned_loads(scene, segment.contacts)
    rho = drive.rho
    assert rho is not None
    centers = np.array(drive.center) + loads.centers - planned.centers
    surface = EllipsoidSurface(
        (drive.max_friction * loads.friction / planned.friction)[:, None],
        rho,
        centers[:, None],
        _lifts(scene, segment, truths)[:, None],
    )
    twists = [guide.twist.moved_to((0.0, 0.0))[:3] for guide in guides]
    return surface.wrenches(np.array(twists))
