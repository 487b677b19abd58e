"""A steering law of your own beside ours, on the shipped tasks of a mode.

A push from behind is a car that steers with its rear wheel. Ours is the Stanley law at
the virtual front axle; here a law that is proportional to the errors takes its place.
The rest stays: contact, path, force inside the friction cone, joint torques.
"""

import math

import pushpressslide as pps
from pushpressslide.core.plan import Segment
from pushpressslide.core.query import MotionQuery
from pushpressslide.modes.base import Tracker
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_car import RearPushTracker

TASKS = ("rear-push-rear", "rear-push-left", "push-t")
BY_OFFSET = 3.0  # [rad/m]
BY_HEADING = 0.5


class Proportional:
    """Steers a car by its errors, and by the curvature of its path."""

    def __init__(self, car: RearSteerCar) -> None:
        self.wheelbase = car.effective_wheelbase
        self.low, self.high = car.steering_limits

    def __call__(
        self,
        left_error: float,
        heading_error: float,
        curvature: float,
        steering_scale: float,
    ) -> tuple[float, bool]:
        """Return the angle [rad] of the force from the heading axis, and whether it was
        clipped. A force to the left turns a rear-steer car to the right.
        """
        turn = math.atan(self.wheelbase * curvature)
        wanted = -(turn + BY_OFFSET * left_error + BY_HEADING * heading_error)
        angle = min(max(wanted, steering_scale * self.low), steering_scale * self.high)
        return angle, angle != wanted


class MyController(pps.Controller):
    """Our controller with that law."""

    def tracking_law(self, query: MotionQuery, segment: Segment) -> Tracker:
        drive = segment.drive
        law = Proportional(drive.car)
        return RearPushTracker(law, drive.car, drive.X_BV, drive.max_friction)


print("task              law      off the path (RMS)  off the goal")
for name in TASKS:
    plan = pps.plan(pps.load_task(name))
    assert {segment.mode for segment in plan.segments} == {"rear_push"}
    for law in (pps.Controller, MyController):
        figures = pps.run(plan, engine="planar", controller=law).figures
        rms = 1e3 * figures["path_rms_error"]
        off = 1e3 * figures["final_position_error"]
        whose = "ours" if law is pps.Controller else "mine"
        print(f"{name:17} {whose:8} {rms:12.2f} mm {off:12.2f} mm")
        assert figures["success"]
