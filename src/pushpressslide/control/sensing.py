"""Sensor models of a simulated robot: noise, bias, delay and drop-outs of each sensor
(task field ``sensing``).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Generic, TypeVar

import numpy as np

from pushpressslide.control.camera import Camera
from pushpressslide.control.cell import Applied, Arm, ArmState, Cell, TrueState
from pushpressslide.control.limits import ArmLimits
from pushpressslide.core.control import ArmCommand, TipState, Vector3
from pushpressslide.core.plan import JointPath
from pushpressslide.core.sensing import Sensing

T = TypeVar("T")


class DelayLine(Generic[T]):
    """Delays values by a fixed number of ticks.

    Until the line is full, it returns the first value.
    """

    def __init__(self, delay: float, dt: float) -> None:
        """Delay by ``delay`` [s], rounded to ticks of ``dt`` [s]."""
        self._line: deque[T] = deque(maxlen=1 + round(delay / dt))

    def through(self, value: T) -> T:
        """Put ``value`` in, and return the delayed value."""
        self._line.append(value)
        return self._line[0]


class SensedArm:
    """An arm with sensor faults: the tip's position and force are noisy, biased and
    late.
    """

    def __init__(
        self,
        arm: Arm,
        sensing: Sensing,
        streams: tuple[np.random.Generator, np.random.Generator],
        dt: float,
    ) -> None:
        """Set up the delay lines.

        ``streams`` are the noise of position and force, shared by all arms; ``dt`` [s]
        is the control period.
        """
        self.arm = arm
        self.interface = arm.interface
        self.truth: TipState  # as last read
        self._sensing = sensing
        self._tip_random, self._force_random = streams
        self._losses = [stream.spawn(1)[0] for stream in streams]
        self._tips: DelayLine[TipState] = DelayLine(sensing.delay_of_tips, dt)
        self._forces: DelayLine[Vector3] = DelayLine(sensing.delay_of_force, dt)
        self._out: ArmState | None = None  # what was read last

    @property
    def limits(self) -> ArmLimits | None:
        """Limits of the wrapped arm."""
        return self.arm.limits

    @property
    def path(self) -> JointPath | None:
        """Joint path of the wrapped arm."""
        return self.arm.path

    def connect(self) -> None:
        """Connect the arm."""
        self.arm.connect()

    def disconnect(self) -> None:
        """Disconnect the arm."""
        self.arm.disconnect()

    def read(self) -> ArmState:
        """Delayed, noisy measurements. Two readings at one time give the same values."""
        state = self.arm.read()
        out = self._out
        if out is not None and out.time == state.time:
            return out
        self.truth = state.tip
        s = self._sensing
        tip = self._tips.through(self._tip(state.tip))
        force = self._forces.through(self._force(state.tip.force))
        lost_tip, lost_force = (float(one.random()) for one in self._losses)
        if out is not None and lost_tip < s.tip_dropout:
            tip = out.tip
        if out is not None and lost_force < s.force_dropout:
            force = out.tip.force
        self._out = state._replace(tip=replace(tip, force=force))
        return self._out

    def send(self, command: ArmCommand) -> Applied:
        """Send a command to the arm."""
        return self.arm.send(command)

    def _tip(self, tip: TipState) -> TipState:
        s = self._sensing
        noise = s.tip_noise * self._tip_random.normal(size=3)
        return replace(tip, position=_perturbed(tip.position, s.tip_bias, noise))

    def _force(self, force: Vector3) -> Vector3:
        s = self._sensing
        noise = s.force_noise * self._force_random.normal(size=3)
        measured = _perturbed(force, s.force_bias, noise)
        if s.force_range is None:
            return measured
        x, y, z = (min(max(v, -s.force_range), s.force_range) for v in measured)
        return (x, y, z)


class SensedTruth:
    """True state of a run, before the sensors distort it."""

    facts: Mapping[str, Any] = {}

    def __init__(self, tracker: Camera, arms: Sequence[SensedArm]) -> None:
        """Wrap a tracker and arms."""
        self._tracker = tracker
        self._arms = arms

    def observe(self) -> TrueState:
        """True pose and tips at the last reading."""
        return TrueState(self._tracker.truth, tuple(arm.truth for arm in self._arms))


def sensed(cell: Cell, sensing: Sensing, seed: int, dt: float) -> Cell:
    """The ``cell`` observed through sensors with the faults of ``sensing``.

    Pose, position and force have separate noise streams. They are read at every tick of
    a run, used or not, so that a delay in ticks is a delay in time. ``dt`` [s] is the
    control period.
    """
    if sensing == Sensing():
        return cell
    pose, tips, forces = np.random.default_rng(seed).spawn(3)
    tracker = Camera(cell.tracker, sensing, pose, dt)
    arms = [SensedArm(arm, sensing, (tips, forces), dt) for arm in cell.arms]
    witness = cell.witness or SensedTruth(tracker, arms)
    return replace(cell, tracker=tracker, arms=arms, witness=witness)


def _perturbed(value: Vector3, bias: Vector3, noise: np.ndarray) -> Vector3:
    x, y, z = (v + b + float(n) for v, b, n in zip(value, bias, noise, strict=True))
    return (x, y, z)
