"""Gymnasium spaces of observations and actions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from gymnasium.spaces import Box

from pushpressslide.learning.push_task import PushTask


def observation_space(push: PushTask) -> Any:
    """Space of one observation (8,), laid out as ``pushing.OBSERVATION``."""
    r = push.reach
    high = np.array([r, r, math.pi, r, r, math.pi, r, r])
    return Box(-high, high, dtype=np.float64)


def action_space(push: PushTask) -> Any:
    """Space of one action (2,): the velocity [m/s] of the tip."""
    limit = push.speed_limit
    return Box(-limit, limit, (2,), dtype=np.float64)
