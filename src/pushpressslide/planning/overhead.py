"""How long approach, touch and release take: estimated alike for all modes, so that their motions are
compared.
"""

from __future__ import annotations

from pushpressslide.core.task import Task

TOUCH_SPEED = 0.03  # [m/s] of a tip on the last centimetres
PRESS_RATE = 60.0  # [N/s] at which a contact is loaded
APPROACH = 5.0  # [s] typical time from the home posture to before the touch; the planar engine begins there
SETTLING = 1.8  # [s] of lining up, believing the touch, and drawing back


def overhead(task: Task, load: float = 0.0) -> float:
    """Return the typical time [s] that a run takes besides its motion, pressed with ``load`` [N]."""
    return APPROACH + task.motion.approach_distance / TOUCH_SPEED + load / PRESS_RATE + SETTLING
