"""All of the paper's experiments, by name."""

from __future__ import annotations

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide_studies.paper.experiment import Experiment
from pushpressslide_studies.paper.one_arm import (
    IDENTIFIED_RHO,
    JOINT_TRACKING,
    PRESS_SLIDE,
    REAR_PUSH,
    TOOL_USE,
)
from pushpressslide_studies.paper.two_arms import (
    PIVOT_AND_MOVE,
    PRESS_FIT,
    TWO_ARMS,
)

AXLE = "virtual-axle"  # the analysis of virtual_axle.py, in its light form
EXPERIMENTS: dict[str, Experiment] = {
    experiment.name: experiment
    for experiment in (
        REAR_PUSH,
        JOINT_TRACKING,
        PRESS_SLIDE,
        IDENTIFIED_RHO,
        TOOL_USE,
        TWO_ARMS,
        PIVOT_AND_MOVE,
        PRESS_FIT,
    )
}


def chosen(names: list[str] | None) -> tuple[tuple[Experiment, ...], bool]:
    """Named experiments, and whether the virtual axle is among them.

    Each occurs once, in the given order. With None they are all experiments. For an
    unknown name, PushPressSlideError lists the known experiments.
    """
    known = [*EXPERIMENTS, AXLE]
    for name in names or ():
        if name not in known:
            allowed = ", ".join(known)
            raise PushPressSlideError(
                f"--only: {name!r} is not an experiment; allowed: {allowed}"
            )
    wanted = dict.fromkeys(names or known)
    return tuple(EXPERIMENTS[name] for name in wanted if name != AXLE), AXLE in wanted
