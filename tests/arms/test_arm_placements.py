"""Joint paths of the placements that are ahead."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.placements import ArmPlacements
from pushpressslide.sim.arm_library import DRAKE


def test_paths_are_kept_if_no_prepared_planner_has_a_plan() -> None:
    paths: Any = [("first",), ("second",)]
    placements = ArmPlacements(DRAKE, [], paths)
    placements.prepare()
    assert placements._prepared.paths == []
    placements.restore()
    assert placements._prepared.paths == paths


def test_only_arms_beside_each_other_have_a_distance() -> None:
    """It is 0 or less where one is in the other's place."""
    robots = pps.load_task("parallel-push").robots
    placements = ArmPlacements(DRAKE, [], [])
    assert placements.spacing(robots[:1]) is None
    spacing = placements.spacing(robots)
    assert spacing is not None
    home = [np.array(DRAKE.model(one).facts.home, float) for one in robots]
    apart = spacing(home)
    assert apart > 0.0
    same = placements.spacing((robots[0], robots[0]))
    assert same is not None
    assert same(home) < 0.0 < apart == pytest.approx(apart)
