"""One object on its support, and the tips that touch it: quasi-static, tick by tick,
under tip commands.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pushpressslide.core.control import TipCommand, TipState, Vector3
from pushpressslide.core.footprint import edge_depths
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2, in_axis
from pushpressslide.core.task import Task
from pushpressslide.core.wrench import Twist
from pushpressslide.geometry.inertia import solid_moments
from pushpressslide.kernels.tip_step import (
    Motion,
    carried_body,
    held_force,
    tip_after,
    tip_law,
)
from pushpressslide.mechanics.pressure import center_of_pressure, total_load
from pushpressslide.planar.contact import (
    FREE,
    ContactStatus,
    Pull,
    Response,
    SideContact,
    TipLaw,
    TopContact,
    WedgedContact,
    side_contact,
)
from pushpressslide.planar.contact import Contact as ObjectContact
from pushpressslide.planar.faces import Face, face_of
from pushpressslide.planar.sliding import REST, AnyFriction, slide
from pushpressslide.planar.support import Support
from pushpressslide.planar.support_friction import Vector
from pushpressslide.planar.uneven_friction import UnevenGround

STEP = 1e-4  # [m] down, within which the object stands on what is there
TIP_DRAG = 50.0  # [N s/m] of a tip whose command neither holds nor damps it


class WorldState(NamedTuple):
    """State of object and tips, and their motion in the previous tick."""

    X_WB: Pose2
    tips: tuple[TipState, ...]  # one per robot; the force is zero without contact
    contacts: tuple[ContactStatus, ...]  # one per robot
    twist: Twist  # in B
    tipping: bool  # the load is off the base


class _Wall(NamedTuple):
    """A side that a tip may meet besides its own face."""

    gap: float  # [m]
    law: TipLaw


class _Reach(NamedTuple):
    """One commanded tip at the start of a tick, in B."""

    contact: Contact
    radius: float  # [m]
    place: Point  # [m] of the tip's centre
    gap: float  # [m] to the face, infinite beside it
    law: TipLaw
    press: float  # [N] on the top
    climb: float  # [m/s] upwards
    wall: _Wall | None = None  # of a notch, beside the face

    def touching(
        self, cop: Point, friction: float, dt: float
    ) -> SideContact | WedgedContact | TopContact | None:
        """Possible contact of the tip with its face in a tick. None if the tip does not
        come near the face.
        """
        x = self.place[0] - cop[0]
        y = self.place[1] - cop[1]
        if self.press > 0.0:
            return TopContact((x, y), self.law, friction * self.press)
        if self.contact.kind == "top":
            return None
        own = wall = None
        if self.gap < math.inf:
            own = side_contact((x, y), self.radius, self.gap, self.law, friction, dt)
        if self.wall is not None:
            gap, law = self.wall
            wall = side_contact((x, y), self.radius, gap, law, friction, dt)
        if own is None or wall is None:
            return own or wall
        return WedgedContact(own, wall)


class World:
    """True state of a task's object on its support, and of the tips.

    The object has no inertia unless it is pushed, and the tips have no mass: a tip
    exerts the force that its command demands at the tip's velocity. The cap of the
    tip's servo is ignored, since it only limits the effect of an arm's inertia. A tip touches at a point, and its
    friction acts in the plane. The object passes through obstacles, except that a fixed
    obstacle on a wall carries an object standing on it. An object level with an opening
    rests in it.
    """

    def __init__(
        self,
        task: Task,
        contacts: Sequence[Contact],
        dt: float,
        ground: UnevenGround | None = None,
    ) -> None:
        """Prepare the faces of ``contacts``, at most one per robot.

        ``dt`` [s] is the tick. Without a ``ground`` the support has Coulomb's friction.
        """
        gx, gy, gz = task.truth.gravity
        mass = task.object.mass
        wx, wy, press = task.support.frame.components((mass * gx, mass * gy, mass * gz))
        self.weight = (wx, wy)
        self.weighs = any(self.weight)  # in the plane
        self.hangs = any(task.scene.weight_along)  # on a support that is known to lean
        self.ground = ground
        self.own_load = -press  # [N] in the plane, and on the support
        self.task = task
        self.dt = dt
        # from the believed centre of mass to the true one, the origin of B here
        self.contacts = tuple(c.shifted(task.center_error) for c in contacts)
        self.arms = {c.arm for c in self.contacts}
        truth = task.truth
        self.support = Support(
            task.object.shape, task.object.center_of_mass, truth.bow, truth.feet
        )
        from shapely import Polygon

        region = task.support.region
        self._region = None if region is None else Polygon(region)
        self.faces = [
            face_of(task.object, c, task.robots[c.arm].tip_radius)
            for c in self.contacts
        ]

    def start(self, X_WG: Pose2, planned: Pose2, gap: float) -> WorldState:
        """State with the object at ``X_WG`` and the tips before their contacts.

        Each tip is ``gap`` [m] before its contact on an object at ``planned``. A tip
        without a contact is at its robot's base.
        """
        X_WB = planned.compose(self.task.object.X_GB)
        places = list(self.task.scene.bases)
        for contact in self.contacts:
            point, height = contact.tip_place(
                self.task.robots[contact.arm].tip_radius, gap
            )
            places[contact.arm] = (*X_WB.apply(point), height)
        tips = tuple(resting(place) for place in places)
        X_WB = X_WG.compose(self.task.object.X_GB)
        return WorldState(
            X_WB, tips, tuple("free" for _ in tips), Twist(0.0, 0.0, 0.0), False
        )

    def step(
        self,
        state: WorldState,
        commands: Sequence[TipCommand | None],
        pushed: Vector3 | None = None,
        time: float = 0.0,
    ) -> WorldState:
        """State after one tick, which begins at a ``time`` [s].

        With ``pushed``, a force [N] and moment [N m] at the centre of mass, the object
        has inertia in this tick.

        A tip without a command stays in place. A tip without a contact is at its
        commanded position and touches nothing.
        """
        X_WB = state.X_WB
        axis = (math.cos(X_WB.yaw), math.sin(X_WB.yaw))
        reaches = [
            self._reach(state, axis, contact, face, command)
            for contact, face in zip(self.contacts, self.faces, strict=True)
            if (command := commands[contact.arm]) is not None
        ]
        cop, load = self._load(state, axis, reaches)
        tipping = self._over_edge(X_WB, cop)
        cop, friction, off_base = self.support.under(cop)
        tipping = tipping or off_base
        mu = self.task.contact_friction
        touching = [reach.touching(cop, mu, self.dt) for reach in reaches]
        acting: list[ObjectContact] = [t for t in touching if t is not None]
        if pushed is not None:
            acting += self._inertia(state, axis, cop, pushed)
        vx, vy, w = REST
        held = (mu + self.task.support.friction) * load > math.hypot(*self.weight)
        if held:
            if self.weighs:
                acting.append(Pull((-cop[0], -cop[1]), in_axis(axis, self.weight)))
            guess = state.twist.moved_to(cop)
            limit = self.task.support.friction * load
            under: AnyFriction = friction
            if self.ground is not None:
                moving = state.twist
                under = self.ground.under(self.support, cop, X_WB, moving, time)
            vx, vy, w = slide(under, limit, acting, (guess.vx, guess.vy, guess.w))
        if self.hangs:
            (vx, vy, w), tipping = self._carried(
                X_WB, Twist(vx, vy, w, cop), tipping or not held
            )
        pose = (X_WB.x, X_WB.y, X_WB.yaw)
        X_after = carried_body(axis, pose, (vx, vy, w), cop, self.dt)
        motion = ((vx, vy, w), cop, X_after, self.dt)
        tips = list(state.tips)
        for arm, command in enumerate(commands):
            if command is None:
                tips[arm] = resting(tips[arm].position)
            elif arm not in self.arms:
                tips[arm] = _led(command)
        statuses: list[ContactStatus] = ["free"] * len(tips)
        for reach, contact in zip(reaches, touching, strict=True):
            response = FREE if contact is None else contact.response((vx, vy, w))
            arm = reach.contact.arm
            tips[arm] = self._tip_after(state, axis, reach, response, motion)
            statuses[arm] = response.status
        twist = Twist(vx, vy, w, cop)
        return WorldState(Pose2(*X_after), tuple(tips), tuple(statuses), twist, tipping)

    def _inertia(
        self, state: WorldState, axis: Point, cop: Point, pushed: Vector3
    ) -> list[TopContact]:
        """The object's inertia, pushed at its centre, as two masses of half its mass.

        A mass m that moved at v takes the force m (v' - v) / dt to move at v'
        (implicit Euler). ``axis`` is the direction of B's x axis, ``cop`` [m] in B.
        """
        body = self.task.object
        arm = math.sqrt(solid_moments(body.shape)[2])  # [m]
        mass = 0.5 * body.mass / self.dt
        fx, fy = in_axis(axis, (pushed[0], pushed[1]))
        masses = []
        for place in (arm, -arm):
            before = state.twist.moved_to((place, 0.0))
            force = (
                0.5 * fx + mass * before.vx,
                0.5 * fy + 0.5 * pushed[2] / place + mass * before.vy,
            )
            law = TipLaw((1.0, 0.0), force, (mass, mass))
            masses.append(TopContact((place - cop[0], -cop[1]), law, math.inf))
        return masses

    def _tip_after(
        self,
        state: WorldState,
        axis: Point,
        reach: _Reach,
        response: Response,
        motion: Motion,
    ) -> TipState:
        """A tip after one tick, for a given motion of the object."""
        x, y, z = state.tips[reach.contact.arm].position
        before = (axis, (x, y), reach.place, reach.law)
        free = response.status == "free"
        place, velocity, force = tip_after(before, response.force, free, motion)
        return TipState(
            (*place, z + self.dt * reach.climb),
            (*velocity, reach.climb),
            (*force, -reach.press),
        )

    def _reach(
        self,
        state: WorldState,
        axis: Point,
        contact: Contact,
        face: Face,
        command: TipCommand,
    ) -> _Reach:
        """The part of a tip's motion in a tick that does not depend on the object's
        motion. ``axis`` is the direction of B's x axis.
        """
        X_WB = state.X_WB
        dt = self.dt
        x, y, z = state.tips[contact.arm].position
        place = in_axis(axis, (x - X_WB.x, y - X_WB.y))
        gap, normal = face.gap(place, z)
        c = math.cos(command.normal_yaw)
        s = math.sin(command.normal_yaw)
        kn, kt, kz = command.stiffness
        bn, bt, bz = command.damping
        tx, ty, tz = command.position
        ux, uy, uz = command.velocity
        fx, fy, fz = command.force
        led = ((fx, fy), (tx - x, ty - y), (ux, uy), (kn, kt), (bn, bt))
        force = in_axis(axis, held_force((c, s), led))
        # at a side the dampings are taken along the face's own axes, a few degrees off
        # the command's
        law_axis = normal if contact.kind == "side" else in_axis(axis, (c, s))
        damping_plane = (_damping(bn, kn, dt), _damping(bt, kt, dt))
        law = _law(law_axis, force, damping_plane)
        beside, inwards = face.wall(place, z)
        wall = None
        if beside < math.inf:
            wall = _Wall(beside, _law(inwards, force, damping_plane))
        lift = fz + kz * (tz - z) + bz * uz
        damping = _damping(bz, kz, dt)
        press = -(lift + damping * gap / dt) if contact.kind == "top" else 0.0
        radius = self.task.robots[contact.arm].tip_radius
        if press > 0.0:
            return _Reach(contact, radius, place, gap, law, press, -gap / dt)
        return _Reach(contact, radius, place, gap, law, 0.0, lift / damping, wall)

    def _load(
        self, state: WorldState, axis: Point, reaches: Sequence[_Reach]
    ) -> tuple[Point, float]:
        """CoP [m] in B and load [N] on the support, from the presses of this tick and
        the horizontal forces of the previous tick.
        """
        own = self.own_load
        top = self.task.object.shape.top_height
        presses = [reach.press for reach in reaches]
        load = total_load(own, presses)
        if load == 0.0:
            return (0.0, 0.0), load
        places = []
        forces = []
        heights = []
        for reach in reaches:
            contact = reach.contact
            tip = state.tips[contact.arm]
            places.append(reach.place)
            forces.append(in_axis(axis, tip.force))
            heights.append(top if contact.kind == "top" else tip.position[2])
        forces.append(in_axis(axis, self.weight))
        heights.append(0.5 * top)
        cop = center_of_pressure(own, (0.0, 0.0), presses, places, forces, heights)
        return cop, load

    def _over_edge(self, X_WB: Pose2, cop: Point) -> bool:
        """Whether a load at ``cop`` [m] in B tips the object over the support's edge."""
        if self._region is None:
            return False
        X_WG = X_WB.compose(self.task.object.X_GB.inverse())
        place = np.array([X_WB.apply(cop)])
        shape = self.task.object.shape
        return bool(edge_depths(shape, [X_WG], place, self._region)[0] < 0.0)

    def _carried(self, X_WB: Pose2, twist: Twist, falling: bool) -> tuple[Vector, bool]:
        """Twist of an object on a wall, and whether the object is still falling.

        The object comes to rest on a fixed obstacle or in the opening, or else moves
        with ``twist``.
        """
        X_WG = X_WB.compose(self.task.object.X_GB.inverse())
        shape = self.task.object.shape
        opening = self.task.support.opening
        scene = self.task.scene
        moving = (twist.vx, twist.vy, twist.w)
        inside = opening is not None and opening.holds(X_WG, shape)
        at_com = twist.moved_to((0.0, 0.0))
        vx, vy = X_WB.rotate((at_com.vx, at_com.vy))
        if vx * self.weight[0] + vy * self.weight[1] >= 0.0:  # not lifted
            if opening is not None and inside:
                lowest = not opening.holds(scene.lowered(X_WG, STEP), shape)
            else:
                lowest = scene.on_ledge(X_WG, STEP)
            if lowest:
                return REST, False
        return moving, falling and not inside


def _law(axis: Point, force: Point, damping: Point) -> TipLaw:
    """Law of a tip along an axis, from its force f_0 [N] in B."""
    return TipLaw(*tip_law(axis, force, damping))


def _damping(damping: float, stiffness: float, dt: float) -> float:
    """Damping [N s/m] of a tip over a tick, including its spring. The spring is
    evaluated at the end of the tick.
    """
    total = damping + stiffness * dt
    return total if total > TIP_DRAG else TIP_DRAG


def _led(command: TipCommand) -> TipState:
    return TipState(command.position, command.velocity, (0.0, 0.0, 0.0))


def resting(position: Vector3) -> TipState:
    """A tip at rest that touches nothing."""
    return TipState(position, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
