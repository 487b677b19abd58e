"""The paper's experiments as data: shipped tasks, what is changed in each, and the paper's own figures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from pushpressslide.core.errors import PushPressSlideError


@dataclass(frozen=True, slots=True)
class PaperFigure:
    """A figure that the paper gives."""

    value: float  # SI units, radians
    about: str = ""  # how the paper qualifies it: "over", "about", "within"


@dataclass(frozen=True, slots=True)
class Variant:
    """One run: a shipped task, and the fields of it that are set otherwise."""

    name: str  # of its folder
    title: str
    task: str  # of a shipped task
    overrides: tuple[str, ...] = ()  # a.b=c each, as of `pps run --set`
    paper: Mapping[str, PaperFigure] = field(default_factory=dict)  # by key of result.json


@dataclass(frozen=True, slots=True)
class Comparison:
    """A claim of the paper: ``changed`` does better than ``base``."""

    base: str  # name of a variant
    changed: str
    words: str  # what the change is, as the subject of a sentence


@dataclass(frozen=True, slots=True)
class Experiment:
    """Several runs that belong to one claim of the paper."""

    name: str
    title: str
    source: str  # where in the paper
    claim: str  # what the paper says
    variants: tuple[Variant, ...]
    why: str  # what decides the outcome, whatever the figures
    comparisons: tuple[Comparison, ...] = ()


SECTION = "Section IV-A, single-arm planar pushing"
WITHIN = {
    "final_position_error": PaperFigure(0.015, "within"),
    "final_yaw_error": PaperFigure(math.radians(2.0), "within"),
}
# A path on which the joint term holds its contact: the shipped one, with a longer straight end, it does not
PATH = ("motion.run_in=0.1",)
FORCE_ONLY = (*PATH, "motion.velocity_servo=false", "motion.force_gain=1.0", "limits.time=120")


def _joint_term(stiffness: float) -> tuple[str, ...]:
    """Overrides that switch the joint-tracking term on, with a stiffness in N m/rad."""
    return ("motion.joint_tracking=true", f"motion.joint_stiffness={stiffness:g}")


JOINT_TRACKING = Experiment(
    name="joint-tracking",
    title="With and without the joint-tracking term",
    source=SECTION,
    claim="The same trajectory is executed with the pushing force alone and with a low-gain joint-tracking "
    "term on top. The paper finds it over three times as fast with the term, and 10 to 19 % tighter.",
    variants=(
        Variant(
            "force",
            "Pushing force alone",
            "rear-push-rear",
            FORCE_ONLY,
            {
                "motion_duration": PaperFigure(100.0, "over"),
                "rms_position_error": PaperFigure(0.095),
                "rms_end_effector_error": PaperFigure(0.096),
                "rms_yaw_error": PaperFigure(math.radians(17.27)),
            },
        ),
        Variant(
            "force-joint",
            "Force and joint term, 10 N m/rad",
            "rear-push-rear",
            (*FORCE_ONLY, *_joint_term(10.0)),
            {
                "motion_duration": PaperFigure(30.0, "about"),
                "rms_position_error": PaperFigure(0.085),
                "rms_end_effector_error": PaperFigure(0.086),
                "rms_yaw_error": PaperFigure(math.radians(14.0)),
            },
        ),
        Variant(
            "force-joint-20",
            "Force and joint term, 20 N m/rad",
            "rear-push-rear",
            (*FORCE_ONLY, *_joint_term(20.0)),
        ),
        Variant(
            "force-joint-shipped",
            "Force and joint term on the shipped path",
            "rear-push-rear",
            (*FORCE_ONLY[1:], *_joint_term(10.0)),
        ),
        Variant("servo", "Force and velocity servo", "rear-push-rear", PATH),
        Variant(
            "servo-joint-10",
            "Servo and joint term, 10 N m/rad",
            "rear-push-rear",
            (*PATH, *_joint_term(10.0)),
        ),
        Variant(
            "servo-joint-30",
            "Servo and joint term, 30 N m/rad",
            "rear-push-rear",
            (*PATH, *_joint_term(30.0)),
        ),
    ),
    why="A force fixes the direction of a quasi-static slide, never its speed: just below friction the "
    "object sticks, just above it the surplus alone decides how fast it creeps, so that a push by force has "
    "no duration of its own. A spring about the joint path of the same time closes that loop: who is late is "
    "pushed harder. So does a velocity servo, and it keeps to the contact's own motion, so that it is "
    "tighter still; beside it the spring has nothing left to do. The spring alone is not robust: it holds "
    "the tip to the planned place in the world, not to the object; stiffer, or on the shipped path with its "
    "longer straight end, it can miss the goal or lose the face where the path bends the other way. The "
    "paper gives neither its poses, nor its speed, nor by how much its force exceeds friction: compare "
    "directions, not seconds.",
    comparisons=(
        Comparison("force", "force-joint", "the joint term on top of the force"),
        Comparison("force", "servo", "the velocity servo on top of the force"),
        Comparison("servo", "servo-joint-10", "the joint term on top of the servo"),
    ),
)
"""Paper: about 30 s against over 100 s; RMS 0.085 m, 0.086 m, 14 deg against 0.095 m, 0.096 m, 17.27 deg."""


def _reach(face: str, title: str) -> Experiment:
    name = f"rear-push-{face}"
    return Experiment(
        name=name,
        title=title,
        source=SECTION,
        claim="A 15 cm cube is pushed to a target pose; it converges to within 15 mm and 2 degrees.",
        variants=(Variant("run", "As shipped", name, (), WITHIN),),
        why="Poses, friction and speed are not in the paper; cube, arm and pushed face are the paper's.",
    )


EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment
    for experiment in (
        JOINT_TRACKING,
        _reach("rear", "Push by the rear face"),
        _reach("left", "Push by the left face"),
    )
}


def chosen(names: list[str] | None) -> tuple[Experiment, ...]:
    """Return the named experiments, each once, in the order given; all of them for None.

    Raises PushPressSlideError, naming the experiments that there are, for an unknown name.
    """
    for name in names or ():
        if name not in EXPERIMENTS:
            allowed = ", ".join(EXPERIMENTS)
            raise PushPressSlideError(f"--only: {name!r} is not an experiment; allowed: {allowed}")
    return tuple(EXPERIMENTS[name] for name in dict.fromkeys(names or EXPERIMENTS))
