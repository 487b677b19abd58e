"""A simulator of your own under our controller: one box that a tip pushes on one face.

A plan runs in a cell: arms that are read and obey commands, a tracker that sees the
object, and a clock. Here the box is quasi-static on an ellipsoid, and the tip has no
mass: it moves as its command's force, spring and damper ask for, less what the box holds
against it.
"""

import pushpressslide as pps
from pushpressslide.control.cell import Applied, ArmState, Cell, TipAlone
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import TipState
from pushpressslide.core.twist_path import integrate
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide.planning.side_contacts import before_contacts

GRAVITY = 9.81  # [m/s^2]
PASSES = 12
SOFTEST = 50.0  # [N s/m] of a command without damping


class MyWorld:
    """A box, and the tip at one of its faces: a clock, and what sees the object."""

    simulated = True  # time rests while the controller thinks

    def __init__(self, plan: pps.Plan) -> None:
        task = plan.task
        query = plan.query
        self.time = 0.0
        self.task = task
        (self.contact,) = plan.contacts
        self.radius = task.robots[0].tip_radius
        self.X = plan.true_start.compose(task.object.X_GB)  # X_WB
        point, height = self.contact.tip_place(
            self.radius, before_contacts(query.scene, query.motion, plan.contacts)
        )
        self.place = (*self.X.apply(point), height)
        self.speed = self.force = self.twist = (0.0, 0.0, 0.0)
        self.command = None
        body = task.object
        rho = rho_fit(support_pressure(body.shape, center_of_mass=body.center_of_mass))
        drag = task.support.friction * body.mass * GRAVITY
        self.surface = EllipsoidLimitSurface(drag, rho)

    def read(self) -> StampedPose:
        return StampedPose(self.time, self.X.compose(self.task.object.X_GB.inverse()))

    def failure(self) -> None:
        """Nothing goes wrong here."""

    def advance(self) -> None:
        dt = self.task.motion.control_period
        self.time += dt
        self.force = self.twist = self.speed = (0.0, 0.0, 0.0)
        if self.command is None:
            return
        nx, ny = self.contact.normal
        x, y = self.X.unapply(self.place[:2])
        touched = (x + self.radius * nx, y + self.radius * ny)
        px, py = self.contact.point
        gap = (px - touched[0]) * nx + (py - touched[1]) * ny
        velocity = self._against((0.0, 0.0), dt)
        if self._into(velocity) > gap / dt:
            mu = self.task.contact_friction
            push = (self.surface, touched, (nx, ny), mu)
            held = self.command.force[:2]
            for _ in range(
                PASSES
            ):  # the tip's velocity and what the box holds against it
                velocity = self._against(held, dt)
                if self._into(velocity) <= 0.0:
                    break
                # the tool turns with the box: its tip does not roll along the face
                turn = self.radius * self.twist[2]
                vx, vy = self.X.unrotate(velocity)
                out = push_outcome(*push, (vx - turn * ny, vy + turn * nx))
                force = self.X.rotate(out.force)
                held = (0.5 * (held[0] + force[0]), 0.5 * (held[1] + force[1]))
                self.twist = (out.twist.vx, out.twist.vy, out.twist.w)
            self.force = (*held, 0.0)
        self.X = integrate(self.X, self.twist, dt)
        x, y, _ = self.place
        height = self.command.position[2]
        self.place = (x + velocity[0] * dt, y + velocity[1] * dt, height)
        self.speed = (*velocity, 0.0)

    def _into(self, velocity) -> float:
        """Return how fast [m/s] a velocity in the world leads into the face."""
        vx, vy = self.X.unrotate(velocity)
        return vx * self.contact.normal[0] + vy * self.contact.normal[1]

    def _against(self, held, dt):
        """Return the tip's velocity [m/s] in the plane with a force ``held`` [N] against
        it: force, spring and damper of its command are in balance with that.
        """
        command = self.command
        frame = pps.Pose2(0.0, 0.0, command.normal_yaw)  # of the contact
        lack = [r - p for r, p in zip(command.position, self.place, strict=True)]
        fs = frame.unrotate([f - h for f, h in zip(command.force, held, strict=False)])
        ds = frame.unrotate(lack[:2])
        vs = frame.unrotate(command.velocity[:2])
        out = []
        for f, d, v, k, b in zip(
            fs, ds, vs, command.stiffness, command.damping, strict=False
        ):
            out.append((f + k * (d + v * dt) + b * v) / (max(b, SOFTEST) + k * dt))
        return frame.rotate(out)


class MyTip(TipAlone):
    """The tip, as an arm: it is read, and obeys the last command."""

    def __init__(self, world: MyWorld) -> None:
        self.world = world

    def read(self) -> ArmState:
        world = self.world
        return ArmState(world.time, TipState(world.place, world.speed, world.force))

    def send(self, command) -> Applied:
        self.world.command = command
        return Applied()


task = pps.load_task("rear-push-left")
plan = pps.plan(task)
world = MyWorld(plan)
cell = Cell("mine", world, [MyTip(world)], world)
mine = pps.run_loop(cell, plan)
figures = pps.result(mine)
print(mine, f"{1e3 * figures['final_position_error']:.2f} mm from the goal")
assert figures["success"]
