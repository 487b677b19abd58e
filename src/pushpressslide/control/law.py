"""The paper's Algorithm 1: one tick of the motion, from the object's state to the tip
commands.

    track     the twist that leads the object along its path, and the wrench for it
    allocate  contact forces inside their cones that make up the wrench
    regulate  each tip: its force, a servo along its motion, its normal force

It is a pure function: its state is passed in and out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.control.adaptation import Adaptation
from pushpressslide.control.following import Following
from pushpressslide.control.insertion import Insertion
from pushpressslide.control.joint_pace import JointPace
from pushpressslide.control.state import Instant, TipMemory
from pushpressslide.control.tip_motion import ContactKeeping, Felt, TipMover, TipTask
from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import TipCommand
from pushpressslide.core.guidance import Guidance
from pushpressslide.kernels.leading import paced

CATCH_UP = 1.5  # [1/s] pull of the time reference on the progress


class Decision(NamedTuple):
    """Result of a tick of the motion."""

    guidance: Guidance
    allocation: Allocation
    commands: tuple[TipCommand, ...]  # one per contact
    tips: tuple[TipMemory, ...]  # memory of each tip
    felt: tuple[Felt, ...]
    wall_times: tuple[float, float]  # [s] to track, to allocate


@dataclass(frozen=True, slots=True)
class Law:
    """Algorithm 1 for one placement of a plan."""

    mover: TipMover
    floor_speed: float  # [m/s] along a path, at its end
    force_gain: float  # on the contact forces
    servo: bool  # whether a servo adds to them
    tracks_joints: bool  # whether the joint reference is a function of time
    insertion: Insertion | None  # into an opening of the support
    waits: bool  # at the end of the last path, for the object to be seated or at rest
    pace: JointPace | None = None  # within the joints' speed limits; None: no arms

    def step(
        self,
        following: Following,
        instant: Instant,
        adaptation: Adaptation,
        tips: Sequence[TipMemory],
        clock: Callable[[], float],
    ) -> Decision:
        """Tip commands at an instant.

        ``clock`` [s] is only recorded.
        """
        X_WB = instant.X_WB
        binding = following.binding
        segment = binding.segment
        speed = instant.pace * self.speed(following, instant.time)
        here = following.joint_progress(X_WB)
        if self.pace is not None:
            allowed = self.pace.speed_at(here)
            speed = min(speed, allowed / max(following.joint_rate, 1.0))

        started = clock()
        guidance = binding.tracker.step(
            segment.path, X_WB, following.progress, speed, adaptation.steering_scale
        ).turning_at_most(margins.ARM.fastest_turn)
        tracked = clock()
        allocation = binding.allocate(guidance.fx, guidance.fy, guidance.tau)
        wall_times = (tracked - started, clock() - tracked)

        twist = guidance.twist
        gain = adaptation.force_gain(self.force_gain, segment.drive.max_friction)
        if instant.rests and not self.waits:
            gain *= margins.RESTING_PUSH
        speeds = self._entry_speeds(instant, tips)
        holds = self._holds(following, allocation)
        points = binding.tip_points
        loads = allocation.normals
        parts = zip(points, allocation.forces, loads, speeds, holds, strict=True)
        tasks = [
            TipTask(twist, point, (gain * fx, gain * fy), load, speed, hold)
            for point, (fx, fy), load, speed, hold in parts
        ]
        progress = following.joint_reference(here, instant.time, self.tracks_joints)
        moved = [
            self.mover.step(memory, instant.context(c, X_WB.yaw, progress), task)
            for memory, c, task in zip(tips, segment.contacts, tasks, strict=True)
        ]
        commands, memories, felt = zip(*moved, strict=True)
        return Decision(guidance, allocation, commands, memories, felt, wall_times)

    def speed(self, following: Following, time: float) -> float:
        """Speed [m/s] along the path: that of the profile, plus a term that makes up
        for a lag.
        """
        profile = following.binding.segment.profile
        planned = profile.state_at(time - following.clock_start)
        left = following.left
        floor = self.floor_speed
        waits = self.waits and not following.ahead and left <= margins.ARM.stop
        pace = (floor, 1.5 * profile.speed, profile.acceleration, CATCH_UP)
        return paced(planned, following.progress, left, 0.0 if waits else floor, pace)

    def _holds(
        self, following: Following, allocation: Allocation
    ) -> list[ContactKeeping | None]:
        """Contact keeping of each tip. None for a tip that needs none."""
        contacts = following.segment.contacts
        if not self.servo:
            return [None] * len(contacts)
        return self.mover.holds(contacts, allocation.normals)

    def _entry_speeds(
        self, instant: Instant, tips: Sequence[TipMemory]
    ) -> list[float | None]:
        """Allowed speed [m/s] of each tip into an opening. None without an opening."""
        if self.insertion is None:
            return [None] * len(tips)
        return self.insertion.speeds(instant.tips, [memory.start for memory in tips])
