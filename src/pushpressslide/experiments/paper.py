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


PRESS_WITHIN = {
    "final_position_error": PaperFigure(0.005, "within"),
    "final_yaw_error": PaperFigure(math.radians(1.0), "within"),
}
BACKWARD = (
    "start.x=0.40", "start.y=0.33", "start.yaw_deg=100", "goal.x=0.47", "goal.y=-0.25", "goal.yaw_deg=90",
)  # fmt: skip

PRESS_SLIDE = Experiment(
    name="press-slide",
    title="Pressing on top and sliding",
    source="Section IV-B, single-arm press and slide",
    claim="A 60 x 20 x 10 cm, 0.3 kg object is pressed with 8 N at 0.2 m and slid to a target pose, which it "
    "reaches within 5 mm and 1 degree, aligned by a virtual target beyond the pose.",
    variants=(
        Variant("pulled", "Pulled, as shipped", "press-slide", (), PRESS_WITHIN),
        Variant("pulled-2", "Pulled, second start", "press-slide", ("start.x=0.40", "start.yaw_deg=75")),
        Variant(
            "pulled-3",
            "Pulled, third start",
            "press-slide",
            ("start.x=0.6", "start.y=-0.3", "start.yaw_deg=125"),
        ),
        Variant("pushed", "Pushed", "press-slide", BACKWARD),
        Variant("car", "As a car", "press-slide-car"),
        Variant("forklift", "As a forklift", "press-slide-forklift"),
        Variant("pivot", "Turned on the spot", "press-slide-pivot"),
        Variant("fixed-target", "Target fixed beyond the goal", "press-slide", ("motion.fixed_target=true",)),
    ),
    why="The virtual axle is taken from the exact surface under the load that the drag at the contact's "
    "height shifts, 3 cm ahead of the centre of mass when pulled and 20 cm behind when pushed, and a plan "
    "is made anew whenever the axle is off its path. A target fixed beyond the goal, the literal reading, "
    "leaves part of the lateral error; one that slides along the path leaves none.",
    comparisons=(Comparison("fixed-target", "pulled", "a target that slides along the path"),),
)
"""Paper: within 5 mm and 1 degree."""

TOOL_USE = Experiment(
    name="tool-use",
    title="A pressed object as a tool",
    source="Figure 1",
    claim="The pressed object is used as a tool that pushes another one to its place; no figure is given.",
    variants=(
        Variant("cube", "A cube of 0.5 kg", "tool-use"),
        Variant("heavy", "A cube of 1 kg", "tool-use", ("obstacles.0.mass=1.0",)),
        Variant("aside", "1 cm off the tool's axis", "tool-use", ("obstacles.0.pose.x=0.46",)),
    ),
    why="What the second object adds to the drag is felt at the tip and fed forward; the push is planned "
    "through its centre, so that it does not drift off the face.",
)

EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment
    for experiment in (
        JOINT_TRACKING,
        _reach("rear", "Push by the rear face"),
        _reach("left", "Push by the left face"),
        PRESS_SLIDE,
        TOOL_USE,
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
