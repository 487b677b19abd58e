"""Cells of scripted plants: one object with the time, object, arms and truth of a cell."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pushpressslide.control.cell import (
    Applied,
    ArmState,
    Cell,
    Driverless,
    Interface,
    TrueState,
)
from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.control import ArmCommand, Measurement, Vector3
from pushpressslide.core.plan import JointPath

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class PlantRow:
    """Fields that a plant adds to the record of one tick."""

    # of G's origin along x and y [m/s], and the yaw rate [rad/s]
    object_twist: Vector3
    tip_forces: tuple[Vector3, ...]  # [N] of each tip ON the object during the tick
    # makes this tick's rows of the arrays of core.record.Record that not every plant has
    extras: Callable[[], Mapping[str, Any]] = dict


def cell_of(plant: Any, arms: int) -> Cell:
    """Cell of a plant with a number of ``arms``."""
    whole = _Whole(plant, arms)
    tips = [_PlantArm(whole, i) for i in range(arms)]
    return Cell(plant.name, whole, tips, whole, plant, whole)


class _Whole:
    """Clock, tracker and witness of a plant, which is measured once a tick."""

    simulated = True

    def __init__(self, plant: Any, arms: int) -> None:
        self.plant = plant
        self.commands: list[ArmCommand] = [None] * arms
        self.readings: tuple[ArmReading, ...] = ()  # of this tick
        self._measured: Measurement | None = None  # the same
        self._passed: Measurement | None = None  # in the tick before

    @property
    def time(self) -> float:
        return self.plant.time

    @property
    def facts(self) -> Mapping[str, Any]:
        return self.plant.meta

    def measurement(self) -> Measurement:
        """Measurement of the plant at this time."""
        measured = self._measured
        if measured is None or measured.time != self.plant.time:
            measured = self.plant.measure()
            self._measured = measured
            self.readings = self.plant.readings()
        return measured

    def read(self) -> StampedPose | None:
        measured = self.measurement()
        return StampedPose(measured.time, measured.object_pose)

    def advance(self) -> None:
        self.plant.advance()
        self._passed = self._measured
        self._measured = None

    def failure(self) -> str | None:
        return self.plant.diverged()

    def observe(self) -> TrueState:
        assert self._passed is not None
        row = self.plant.row()
        truth = self._passed
        forces = row.tip_forces
        return TrueState(
            truth.object_pose, truth.tips, row.object_twist, forces, row.extras
        )


class _PlantArm(Driverless):
    """One arm of a plant whose arms take their commands together."""

    def __init__(self, whole: _Whole, index: int) -> None:
        self._whole = whole
        self._index = index
        has_joints = bool(whole.plant.joint_paths)
        self.interface: Interface = "torque" if has_joints else "tip"

    @property
    def limits(self) -> ArmLimits | None:
        return _one(self._whole.plant.arm_limits, self._index)

    @property
    def path(self) -> JointPath | None:
        return _one(self._whole.plant.joint_paths, self._index)

    def read(self) -> ArmState:
        measured = self._whole.measurement()
        tip = measured.tips[self._index]
        joints = _one(self._whole.readings, self._index)
        return ArmState(measured.time, tip, joints)

    def send(self, command: ArmCommand) -> Applied:
        commands = self._whole.commands
        commands[self._index] = command
        if self._index == len(commands) - 1:
            self._whole.plant.apply(tuple(commands))
        return Applied()


def _one(every: Sequence[T], index: int) -> T | None:
    """Value of one arm. None if no arm has any."""
    return every[index] if every else None
