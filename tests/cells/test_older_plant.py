"""A simulator written for version 0.3, with a plant of one piece, still runs."""
# mypy: ignore-errors

import warnings

import pushpressslide as pps
from pushpressslide.control.plant import PlantRow
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.twist_path import integrate
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide.planning.side_contacts import before_contacts
from pushpressslide.selection.placement_planner import PlansAlone

GRAVITY = 9.81  # [m/s^2]
PASSES = 12
SOFTEST = 50.0  # [N s/m] of a command without damping


class MyPlant:
    """A box, and the tip at one of its faces."""

    name = "mine"
    overhead = 6.0  # [s]
    joint_paths = ()
    arm_limits = ()
    meta = {"time_step": 0.004}  # noqa: RUF012

    def __init__(self, plan: pps.Plan) -> None:
        task = plan.part(plan.segments[0])
        self.time = 0.0
        self.task = task
        (self.contact,) = plan.contacts
        self.radius = task.robots[0].tip_radius
        self.X = task.true_start.compose(task.object.X_GB)  # X_WB
        point, height = self.contact.tip_place(
            self.radius, before_contacts(task, plan.contacts)
        )
        self.place = (*self.X.apply(point), height)
        self.speed = self.force = self.twist = (0.0, 0.0, 0.0)
        body = task.object
        rho = rho_fit(support_pressure(body.shape, center_of_mass=body.center_of_mass))
        drag = task.support.friction * body.mass * GRAVITY
        self.surface = EllipsoidLimitSurface(drag, rho)

    def measure(self) -> Measurement:
        tip = TipState(self.place, self.speed, self.force)
        pose = self.X.compose(self.task.object.X_GB.inverse())
        return Measurement(self.time, pose, (tip,))

    def apply(self, commands) -> None:
        (self.command,) = commands

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
        """Speed [m/s] into the face of a velocity in the world."""
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

    def row(self) -> PlantRow:
        return PlantRow((*self.X.rotate(self.twist[:2]), self.twist[2]), (self.force,))

    def readings(self):
        return ()

    def diverged(self):
        return None

    def prepare(self):
        return PlansAlone()

    def hand_over(self, placement, kept_arms):
        raise NotImplementedError("this plant has one placement")


def test_a_plant_of_one_piece_runs_with_warnings() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        record = pps.run_loop(MyPlant(plan), plan)
    figures = pps.result(record)
    assert figures["success"], record.reason_text
    assert figures["final_position_error"] < 1e-3
    assert record.engine == "mine"
    assert record.meta["time_step"] == 0.004
    said = " ".join(str(one.message) for one in warned)
    assert "control.cell" in said
    assert "Plan.part" in said
