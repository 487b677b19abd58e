"""Runs made by hand, whose figures are known in advance."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from pushpressslide.core.control import PHASES
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Box, ObjectModel, Robot, Task

DT, TOUCH, MOVE, RELEASE = 0.01, 20, 400, 30  # [s], ticks
PUSH = 3.0  # [N]


@dataclass(frozen=True)
class Made:
    task: Task
    plan: Plan
    record: Record

    def with_arrays(self, **arrays):
        return replace(self, record=replace(self.record, arrays={**self.record.arrays, **arrays}))

    def with_record(self, **fields):
        return replace(self, record=replace(self.record, **fields))

    @property
    def move(self):
        return self.record.arrays["phase"] == PHASES.index("move")


def perfect(model="hand"):
    """A box pushed from behind along an arc, exactly on its reference, force inside the cone."""
    start, length = Pose2(0.4, -0.1, 0.2), 0.3
    path = ArcPath(Pose2(0.4, -0.1, 0.2).compose(Pose2(0.05, 0.0, 0.0)), ((2.0, length),))
    X_BV = Pose2(0.05, 0.0, 0.0)
    goal = path.end.compose(X_BV.inverse())
    body = ObjectModel(Box((0.15, 0.10, 0.08)), 1.0, (0.0, 0.0))
    task = Task("by-hand", body, start, goal, (Robot(model, (0.0, 0.0, 0.0)),), contact_friction=0.5)
    contact = Contact(0, "side", (-0.075, 0.0), (1.0, 0.0), 0.03)
    choice = Choice("rear_push", True, "by hand", (contact,), length, 5.0, 0.1, {"rho": 0.05}, path)
    plan = Plan(task, choice, path, SpeedProfile(length, 0.1, 0.5), X_BV)

    n = TOUCH + MOVE + RELEASE
    phase = np.repeat([PHASES.index(p) for p in ("touch", "move", "release")], [TOUCH, MOVE, RELEASE])
    s = np.clip((np.arange(n) - TOUCH) / (MOVE - 1), 0.0, 1.0) * length
    poses = [plan.object_pose(v) for v in s]
    pose = np.array([(p.x, p.y, p.yaw) for p in poses])
    tip = np.array([[(*p.apply((-0.075 - 0.02, 0.0)), 0.03)] for p in poses])
    force = np.array([[(*p.rotate((PUSH, 0.4 * PUSH)), 0.0)] for p in poses])
    force[phase != PHASES.index("move")] = 0.0
    samples = [path.pose(v) for v in np.linspace(0.0, length, 200)]
    arrays = {
        "time": DT * np.arange(n),
        "phase": phase.astype(float),
        "leg": np.zeros(n),
        "stretch": np.zeros(n),
        "vehicle_frame": np.tile([X_BV.x, X_BV.y, X_BV.yaw], (n, 1)),
        "object_pose": pose,
        "object_twist": np.gradient(pose, DT, axis=0),
        "reference_pose": pose.copy(),
        "tracking_error": np.zeros((n, 3)),
        "progress": s,
        "steering": np.zeros(n),
        "wanted_wrench": np.zeros((n, 3)),
        "allocated_wrench": np.zeros((n, 3)),
        "command_force": force.copy(),
        "measured_force": force,
        "tip_position": tip,
        "tip_reference": tip.copy(),
        "tick_track": np.full(n, 1e-5),
        "tick_allocate": np.full(n, 2e-6),
        "tick_execute": np.zeros(n),
        "tick_total": np.full(n, 3e-5),
        "plan_path": np.array([(p.x, p.y, p.yaw) for p in samples]),
        "plan_stretch": np.zeros(len(samples)),
        "plan_X_BV": np.array([X_BV.x, X_BV.y, X_BV.yaw]),
    }
    meta = {"time_step": DT, "start_tips": [[0.1, 0.2, 0.3]]}
    record = Record(arrays, "goal_reached", "", "planar", 7, 0.5, ("rear_push",), meta)
    return Made(task, plan, record)


@pytest.fixture
def run():
    return perfect()


@pytest.fixture
def arm_run():
    """The same with the joints of a Panda that holds still at its home posture."""
    from pushpressslide.robots.facts import load_facts

    made, facts = perfect("panda"), load_facts("panda")
    n = len(made.record.arrays["time"])
    q = np.tile(facts.home, (n, 1))
    positions = np.zeros((n, 7))
    pose = made.record.arrays["object_pose"]
    positions[:, 0], positions[:, 3] = np.cos(0.5 * pose[:, 2]), np.sin(0.5 * pose[:, 2])
    positions[:, 4:6], positions[:, 6] = pose[:, :2], 0.04
    post = np.tile([math.cos(0.15), 0.0, 0.0, math.sin(0.15), 0.3, 0.3, 0.1], (n, 1))
    post[-1, 4:6] += (0.03, 0.04)
    made = made.with_arrays(
        joint_position_0=q,
        joint_velocity_0=np.zeros_like(q),
        joint_torque_0=0.25 * np.tile(facts.effort_limit, (n, 1)),
        joint_reference_0=q.copy(),
        torque_share_0=np.where(np.arange(n) % 10 == 0, 1.2, 0.5),
        object_pose_3d=positions,
        body_post=post,
    )
    return made.with_record(engine="drake")
