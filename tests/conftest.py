"""Settings of the whole suite, and runs made by hand whose figures are known in advance."""

import math
import os
import sysconfig
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from itertools import compress
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import settings

from pushpressslide.core.control import PHASES
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Box, ObjectModel, Robot, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.rom.drives import HeldDrive, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.taskfile.mesh_file import read_mesh

WITH_DRAKE = ("drake", "view/test_replay.py")
"""Files that import Drake at their top; without it they are left out."""

collect_ignore = list(WITH_DRAKE) if find_spec("pydrake") is None else []
if find_spec("pydrake") is None or find_spec("mujoco") is None:
    collect_ignore += ["mujoco"]


def _turned(profile: list[tuple[float, float]], sections: int = 48):
    """Mesh of a solid of revolution; radius and height [m] of its profile."""
    return trimesh.creation.revolve(np.array(profile), sections=sections)


def _brick(size: tuple[float, float, float], at: tuple[float, float, float]):
    transform = trimesh.transformations.translation_matrix(at)
    return trimesh.creation.box(size, transform=transform)


def _chamfered() -> trimesh.Trimesh:
    """Box of 120 x 80 x 50 mm with chamfers of 4 mm at base and top."""
    rings = ((0.0, 0.004), (0.004, 0.0), (0.046, 0.0), (0.05, 0.004))
    corners = [
        (sx * (0.06 - inset), sy * (0.04 - inset), z)
        for z, inset in rings
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return trimesh.convex.convex_hull(np.array(corners))


def _mug() -> trimesh.Trimesh:
    """Mug of 80 mm with a handle along x that begins 14 mm above the table."""
    wall = [(0, 0), (0.04, 0), (0.04, 0.09), (0.036, 0.09), (0.036, 0.005), (0, 0.005)]
    return trimesh.util.concatenate(
        [
            _turned(wall),
            _brick((0.03, 0.012, 0.012), (0.052, 0.0, 0.075)),
            _brick((0.03, 0.012, 0.012), (0.052, 0.0, 0.02)),
            _brick((0.012, 0.012, 0.067), (0.066, 0.0, 0.0475)),
        ]
    )


def _stool() -> trimesh.Trimesh:
    """Plate of 180 x 120 x 40 mm on four feet of 20 x 20 x 30 mm."""
    feet = [
        _brick((0.02, 0.02, 0.03), (x, y, 0.015))
        for x in (-0.07, 0.07)
        for y in (-0.04, 0.04)
    ]
    return trimesh.util.concatenate([_brick((0.18, 0.12, 0.04), (0, 0, 0.05)), *feet])


def _lying() -> trimesh.Trimesh:
    """Bottle of 70 mm that lies along y."""
    turn = trimesh.transformations.rotation_matrix(0.5 * math.pi, (1, 0, 0))
    return trimesh.creation.cylinder(0.035, 0.2, sections=40, transform=turn)


STANDING = {
    "chamfered": _chamfered,
    "cup": lambda: _turned(
        [(0, 0), (0.03, 0), (0.04, 0.1), (0.036, 0.1), (0.027, 0.004), (0, 0.004)]
    ),
    "bowl": lambda: _turned(
        [
            (0, 0),
            (0.03, 0),
            (0.03, 0.004),
            (0.07, 0.05),
            (0.066, 0.05),
            (0.026, 0.01),
            (0, 0.01),
        ]
    ),
    "ring": lambda: trimesh.creation.annulus(0.04, 0.06, 0.03, sections=48),
    "mug": _mug,
    "stool": _stool,
    "lying": _lying,
    "ball": lambda: trimesh.creation.icosphere(3, 0.05),
}
"""Meshes of bodies that are no upright prisms."""


@pytest.fixture(scope="session")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], MeshBody]:
    """Return bodies from ``STANDING`` by name, read from a file."""
    folder = tmp_path_factory.mktemp("standing")

    def body(name: str) -> MeshBody:
        file = folder / f"{name}.stl"
        if not file.exists():
            STANDING[name]().export(file)
        solid = read_mesh(str(file), 1.0)
        assert isinstance(solid, MeshBody)
        return solid

    return body


PUBLIC_ARMS = "PUSHPRESSSLIDE_PUBLIC_ARMS"
"""Environment variable with folders of unpacked wheels, in place of installations."""


@pytest.fixture(scope="session")
def public_file() -> Callable[[str, str], Path]:
    """Return a function: the path of a package's file, or a skip by its name."""

    def path_of(package: str, path: str) -> Path:
        unpacked = filter(None, os.environ.get(PUBLIC_ARMS, "").split(os.pathsep))
        for place in (*unpacked, sysconfig.get_paths()["purelib"]):
            whole = Path(place) / path
            if whole.is_file():
                return whole
        pytest.skip(f"{package} is not installed")

    return path_of


@pytest.fixture(scope="session")
def task_of_mode() -> dict[str, str]:
    """Return a shipped task for each mode."""
    return {
        "rear_push": "rear-push-rear",
        "press_slide": "press-slide",
        "parallel_push": "parallel-push",
        "orthogonal_push": "orthogonal-push",
        "bimanual_press_slide": "bimanual-slide",
        "press_and_push": "pivot",
    }


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option of a share of the cases."""
    text = "run every n-th case, from the first one on"
    parser.addoption("--every", type=int, default=1, metavar="n", help=text)


@pytest.hookimpl(trylast=True)  # after the markers
def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Leave out the cases that ``--every`` does not choose."""
    every = config.getoption("--every")
    left_out = [item for i, item in enumerate(items) if i % every]
    items[:] = items[::every]
    if left_out:
        config.hook.pytest_deselected(items=left_out)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what is left out."""
    if collect_ignore:
        left_out = ", ".join(collect_ignore)
        terminalreporter.write_line(f"Drake is not installed; left out: {left_out}")


# No test asserts wall time: a deadline of an example would be one, red on a busy
# machine. The examples are the same every time, so that a change is red for what it
# changed; ``pytest --hypothesis-profile=search`` draws others.
settings.register_profile(
    "pushpressslide", deadline=None, print_blob=True, derandomize=True
)
settings.register_profile(
    "search", deadline=None, print_blob=True, derandomize=False, max_examples=500
)
settings.load_profile("pushpressslide")


DT = 0.01
TOUCH = 20
MOVE = 400
RELEASE = 30  # [s], ticks
PUSH = 3.0  # [N]
# arm, place in B [m], load [N], shear in B [N]
PRESSES = ((1, (0.05, -0.03), 10.0, (2.0, 1.0)), (0, (-0.05, 0.03), 6.0, (1.0, -1.0)))


@dataclass(frozen=True)
class Made:
    task: Task
    plan: Plan
    record: Record

    def with_arrays(self, **arrays):
        return replace(
            self, record=replace(self.record, arrays={**self.record.arrays, **arrays})
        )

    def with_record(self, **fields):
        return replace(self, record=replace(self.record, **fields))

    def with_segments(self, *segments):
        return replace(self, plan=replace(self.plan, segments=segments))

    def with_contacts(self, *contacts):
        return self.with_segments(
            *(replace(segment, contacts=contacts) for segment in self.plan.segments)
        )

    @property
    def choice(self):
        """The choice that the plan was made from."""
        plan = self.plan
        mode = plan.segments[0].mode
        return Choice(mode, "by hand", plan.contacts, plan.segments, 5.0)

    @property
    def move(self):
        return self.record.arrays["phase"] == PHASES.index("move")


def perfect(model="hand"):
    """A box pushed from behind along an arc, exactly on its reference, force inside the
    cone.
    """
    start = Pose2(0.4, -0.1, 0.2)
    length = 0.3
    # its axle is 0.05 m ahead of the CoM
    rho = math.sqrt(0.05 * 0.075)
    car = RearSteerCar((-0.075, 0.0), (1.0, 0.0), (0.0, 0.0), rho, 0.5)
    drive = RearSteerDrive(car, shift=0.0, max_friction=PUSH)
    X_BV = drive.X_BV
    path = ArcPath(start.compose(X_BV), ((2.0, length),))
    goal = path.end.compose(X_BV.inverse())
    body = ObjectModel(Box((0.15, 0.10, 0.08)), 1.0, (0.0, 0.0))
    task = Task(
        "by-hand",
        body,
        start,
        goal,
        (Robot(model, (0.0, 0.0, 0.0)),),
        contact_friction=0.5,
    )
    contact = Contact(0, "side", (-0.075, 0.0), (1.0, 0.0), 0.03)
    profile = SpeedProfile(length, 0.1, 0.5)
    segment = Segment("rear_push", (contact,), drive, path, profile, goal, 0.1)
    plan = Plan(task, (segment,))

    n = TOUCH + MOVE + RELEASE
    phase = np.repeat(
        [PHASES.index(p) for p in ("touch", "move", "release")], [TOUCH, MOVE, RELEASE]
    )
    s = np.clip((np.arange(n) - TOUCH) / (MOVE - 1), 0.0, 1.0) * length
    poses = [plan.object_pose(segment, v) for v in s]
    pose = np.array([(p.x, p.y, p.yaw) for p in poses])
    tip = np.array([[(*p.apply((-0.075 - 0.02, 0.0)), 0.03)] for p in poses])
    force = np.array([[(*p.rotate((PUSH, 0.4 * PUSH)), 0.0)] for p in poses])
    force[phase != PHASES.index("move")] = 0.0
    samples = [path.pose(v) for v in np.linspace(0.0, length, 200)]
    arrays = {
        "time": DT * np.arange(n),
        "phase": phase.astype(float),
        "leg": np.zeros(n),
        "placement": np.zeros(n),
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
    }
    meta = {"time_step": DT, "start_tips": [[0.1, 0.2, 0.3]]}
    record = Record(
        arrays, "goal_reached", "", "planar", 7, 0.5, ("rear_push",), plan, meta
    )
    return Made(task, plan, record)


def two_presses(model="hand"):
    """The box pressed by two arms in two segments: along the arc, then turned about
    its CoM.

    Each with the load and the shear (in B) of PRESSES.
    """
    made = perfect(model)
    robots = tuple(Robot(model, (0.0, y, 0.0)) for y in (0.3, -0.3))
    contacts = tuple(
        Contact(arm, "top", point, (0.0, 0.0), 0.08, load)
        for arm, point, load, _ in PRESSES
    )
    (first,) = made.plan.segments
    surface = DraggedSurface(PUSH, 0.05)
    here = HeldDrive(surface, 0.1, (0.0, 0.0), 0.0, 0.5)
    corner = first.path.end.compose(first.X_BV.inverse())
    spin = TwistPath.between((corner, corner.compose(Pose2(0.0, 0.0, 0.5))), 0.1)
    task = replace(made.task, robots=robots, goal=spin.end)
    profile = SpeedProfile(spin.length, 0.1, 0.5)
    first = replace(
        first,
        mode="bimanual_press_slide",
        contacts=contacts,
        drive=replace(here, point=first.X_BV.position),
        goal=corner,
    )
    then = replace(
        first, drive=here, goal=spin.end, path=spin, profile=profile, cone_margin=0.05
    )
    plan = Plan(task, (first, then))

    arrays = dict(made.record.arrays)
    n = len(arrays["time"])
    half = TOUCH + MOVE // 2
    s = np.clip((np.arange(n) - TOUCH) / (MOVE // 2 - 1), 0.0, 1.0) * first.path.length
    turn = np.clip((np.arange(n) - half) / (MOVE // 2 - 1), 0.0, 1.0) * spin.length
    stretch = (np.arange(n) >= half).astype(float)
    poses = [
        plan.object_pose(then, b) if k else plan.object_pose(first, a)
        for k, a, b in zip(stretch, s, turn, strict=True)
    ]
    pose = np.array([(p.x, p.y, p.yaw) for p in poses])
    tips = np.zeros((n, 2, 3))
    forces = np.zeros((n, 2, 3))
    move = arrays["phase"] == PHASES.index("move")
    for arm, point, load, shear in PRESSES:
        tips[:, arm] = [(*p.apply(point), 0.08 + 0.02) for p in poses]
        forces[move, arm] = [(*p.rotate(shear), -load) for p in compress(poses, move)]
    samples = [
        part.path.pose(v)
        for part in plan.segments
        for v in np.linspace(0.0, part.path.length, 200)
    ]
    frames = np.array([(f.x, f.y, f.yaw) for f in (first.X_BV, then.X_BV)])
    arrays |= {
        "object_pose": pose,
        "reference_pose": pose.copy(),
        "object_twist": np.gradient(pose, DT, axis=0),
        "stretch": stretch,
        "vehicle_frame": frames[stretch.astype(int)],
        "progress": np.where(stretch, turn, s),
        "tip_position": tips,
        "tip_reference": tips.copy(),
        "measured_force": forces,
        "command_force": forces.copy(),
        "plan_path": np.array([(p.x, p.y, p.yaw) for p in samples]),
        "plan_stretch": np.repeat([0.0, 1.0], 200),
    }
    return Made(
        task, plan, replace(made.record, arrays=arrays, modes=("bimanual_press_slide",))
    )


@pytest.fixture
def run():
    return perfect()


@pytest.fixture
def pressed():
    return two_presses()


@pytest.fixture
def presses():
    return PRESSES


@pytest.fixture
def arm_run():
    """The same with the joints of a Panda that holds still at its home posture."""
    from pushpressslide.robots.facts import load_facts

    made = perfect("panda")
    facts = load_facts("panda")
    n = len(made.record.arrays["time"])
    q = np.tile(facts.home, (n, 1))
    positions = np.zeros((n, 7))
    pose = made.record.arrays["object_pose"]
    positions[:, 0], positions[:, 3] = (
        np.cos(0.5 * pose[:, 2]),
        np.sin(0.5 * pose[:, 2]),
    )
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
