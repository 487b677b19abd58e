"""Playback of a run in Drake with its recorded torques. Nothing is measured, decided or
recorded.

The time of a playback is the share of the physics in the time of a run.
"""

from __future__ import annotations

from time import perf_counter
from typing import NamedTuple

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.sim.station import Station


class Playback(NamedTuple):
    """Result of a playback of recorded torques."""

    wall_time: float  # [s]
    object_pose: Array  # (7,) quaternion (w, x, y, z) and position [m] in the end


def played_back(plan: Plan, record: Record, *, models: str = "generated") -> Playback:
    """Simulate ``plan`` from its start with the torques of its ``record``.

    The recorded run must have ended without a recovery.
    """
    motion = plan.query.motion
    station = Station(plan, models=models, time_step=motion.time_step)
    arms = range(len(plan.task.robots))
    for i, robot in enumerate(station.scene.robots):
        start = record.arrays[f"joint_position_{i}"][0]
        station.plant.SetPositions(station.plant_context, robot.model_instance, start)
    station.simulator.Initialize()
    torques = list(
        zip(*(record.arrays[f"joint_torque_{i}"] for i in arms), strict=True)
    )
    began = perf_counter()
    for number, tick in enumerate(torques, start=1):
        for i in arms:
            station.set_torque(i, tick[i])
        station.simulator.AdvanceTo(number * motion.control_period)
    wall_time = perf_counter() - began
    first = station.scene.object.floating_positions_start()
    return Playback(wall_time, station.state_vector()[first : first + 7])
