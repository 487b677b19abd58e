"""The record of a run as an MCAP file of ROS 2 messages.

Poses are PoseStamped, forces WrenchStamped, joints JointState and frames TFMessage;
task, plan and result are metadata. On a table all quantities are in the world frame. On
other supports, planar poses and forces are in the frame ``support``, and 3-D quantities
in the world frame.
"""

from __future__ import annotations

import importlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.scene import ARM_NAMES
from pushpressslide.core.whole_file import whole, write_whole
from pushpressslide.report.files import Run
from pushpressslide.report.json_text import plain
from pushpressslide.report.plan_files import stages_to_dict
from pushpressslide.robots.joint_names import joint_names
from pushpressslide.taskfile.load import dump_task

CHUNK = 1 << 22  # [bytes]; large ones compress better
WORLD = "world"
SUPPORT = "support"


@dataclass(frozen=True)
class Message:
    """A message of one tick."""

    topic: str
    kind: str  # ROS type
    content: Any


def write_mcap(run: Run, path: Path) -> Path:
    """Write the MCAP file of a run to ``path``, and return it.

    Raises MissingPackageError if mcap or rosbags is not installed.
    """
    try:
        writers = importlib.import_module("mcap.writer")
        typesys = importlib.import_module("rosbags.typesys")
    except ModuleNotFoundError as error:
        raise MissingPackageError(
            f"--mcap: {error.name} is not installed: pip install 'pushpressslide[ros]'"
        ) from None
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    with whole(path) as temporary, temporary.open("wb") as file:
        writer = writers.Writer(file, chunk_size=CHUNK)
        writer.start(profile="ros2", library="pushpressslide")
        channels: dict[str, int] = {}
        stamps = nanoseconds(run.record.arrays["time"])
        messages = Messages(run, store)
        for tick, stamp in enumerate(stamps):
            for message in messages.of_tick(tick, stamp):
                if message.topic not in channels:
                    channels[message.topic] = _channel(writer, store, message)
                raw = store.serialize_cdr(message.content, message.kind)
                channel = channels[message.topic]
                writer.add_message(channel, stamp, bytes(raw), stamp)
        for name, content in _metadata(run).items():
            writer.add_metadata(name, content)
        writer.finish()
    return path


def nanoseconds(times: Array) -> list[int]:
    """Stamps [ns] of ``times`` (n,) [s]."""
    return [round(1e9 * time) for time in times.tolist()]


def _channel(writer: Any, store: Any, message: Message) -> int:
    """Number of a new channel for a message's topic."""
    definition, _ = store.generate_msgdef(message.kind, ros_version=2)
    schema = writer.register_schema(message.kind, "ros2msg", definition.encode())
    channel: int = writer.register_channel(message.topic, "cdr", schema)
    return channel


def _metadata(run: Run) -> dict[str, dict[str, str]]:
    """Task, plan and result as text."""
    stages = stages_to_dict(run.task, run.stages)
    return {
        "task": {"yaml": dump_task(run.task)},
        "plan": {"json": json.dumps(plain(stages))},
        "result": {"json": json.dumps(plain(dict(run.result)))},
    }


@dataclass(frozen=True, eq=False)
class Messages:
    """The messages of a run, tick by tick."""

    run: Run
    store: Any  # type store of rosbags

    def of_tick(self, tick: int, stamp: int) -> Iterator[Message]:
        """Messages of one tick at ``stamp`` [ns]."""
        arrays = self.run.record.arrays
        time = self._type("builtin_interfaces/msg/Time")(*divmod(stamp, 10**9))
        plane = self._header(time, self._plane)
        pose = arrays["object_pose"][tick]
        yield self._pose("/object/pose", plane, *_planar(pose))
        reference = arrays["reference_pose"][tick]
        if np.isfinite(reference).all():
            yield self._pose("/object/reference", plane, *_planar(reference))
        for arm, position in enumerate(arrays["tip_position"][tick]):
            yield self._pose(f"/tip{arm}/pose", plane, position, (1.0, 0.0, 0.0, 0.0))
            force = arrays["measured_force"][tick, arm]
            yield self._wrench(f"/tip{arm}/wrench", plane, force)
        for name in self._bodies:
            values = arrays[name][tick]
            topic = f"/{name.removeprefix('body_')}/pose"
            header = self._header(time, WORLD)
            yield self._pose(topic, header, values[4:], values[:4])
        for arm, names in enumerate(self._joints):
            yield self._joint_state(arm, names, self._header(time, ""), tick)
        yield self._frames(time, tick)

    @cached_property
    def _plane(self) -> str:
        """Frame of planar poses and of forces."""
        return WORLD if self.run.task.support.kind == "table" else SUPPORT

    @cached_property
    def _bodies(self) -> list[str]:
        """Names of each movable body's arrays."""
        return [name for name in self.run.record.arrays if name.startswith("body_")]

    @cached_property
    def _joints(self) -> list[list[str]]:
        """Joint names of each arm in the record."""
        names = joint_names(self.run.task.robots)
        arrays = self.run.record.arrays
        return [each for i, each in enumerate(names) if f"joint_position_{i}" in arrays]

    def _type(self, name: str) -> Any:
        return self.store.types[name]

    def _header(self, time: Any, frame: str) -> Any:
        return self._type("std_msgs/msg/Header")(time, frame)

    def _vector(self, values: Any) -> Any:
        return self._type("geometry_msgs/msg/Vector3")(*map(float, values))

    def _quaternion(self, rotation: Any) -> Any:
        """Quaternion message from w, x, y, z."""
        w, x, y, z = map(float, rotation)
        return self._type("geometry_msgs/msg/Quaternion")(x, y, z, w)

    def _pose(self, topic: str, header: Any, position: Any, rotation: Any) -> Message:
        point = self._type("geometry_msgs/msg/Point")(*map(float, position))
        turned = self._quaternion(rotation)
        pose = self._type("geometry_msgs/msg/Pose")(point, turned)
        kind = "geometry_msgs/msg/PoseStamped"
        return Message(topic, kind, self._type(kind)(header, pose))

    def _wrench(self, topic: str, header: Any, force: Any) -> Message:
        wrench = self._type("geometry_msgs/msg/Wrench")(
            self._vector(force), self._vector((0.0, 0.0, 0.0))
        )
        kind = "geometry_msgs/msg/WrenchStamped"
        return Message(topic, kind, self._type(kind)(header, wrench))

    def _joint_state(
        self, arm: int, names: list[str], header: Any, tick: int
    ) -> Message:
        arrays = self.run.record.arrays
        none = np.zeros(0)
        effort = arrays.get(f"joint_torque_{arm}")
        kind = "sensor_msgs/msg/JointState"
        content = self._type(kind)(
            header,
            names,
            arrays[f"joint_position_{arm}"][tick],
            arrays[f"joint_velocity_{arm}"][tick],
            none if effort is None else effort[tick],
        )
        of_arm = f"/{ARM_NAMES[arm]}" if len(self.run.task.robots) > 1 else ""
        return Message(f"{of_arm}/joint_states", kind, content)

    def _frames(self, time: Any, tick: int) -> Message:
        """Frames of the object and of movable bodies."""
        arrays = self.run.record.arrays
        poses = {"object": (self._plane, *_planar(arrays["object_pose"][tick]))}
        for name in self._bodies:
            values = arrays[name][tick]
            poses[name.removeprefix("body_")] = (WORLD, values[4:], values[:4])
        transforms = []
        for child, (parent, position, rotation) in poses.items():
            moved = self._type("geometry_msgs/msg/Transform")(
                self._vector(position), self._quaternion(rotation)
            )
            header = self._header(time, parent)
            make = self._type("geometry_msgs/msg/TransformStamped")
            transforms.append(make(header, child, moved))
        kind = "tf2_msgs/msg/TFMessage"
        return Message("/tf", kind, self._type(kind)(transforms))


def _planar(pose: Array) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Position and quaternion w, x, y, z of a planar pose x, y [m], yaw [rad]."""
    x, y, yaw = map(float, pose)
    return (x, y, 0.0), (math.cos(0.5 * yaw), 0.0, 0.0, math.sin(0.5 * yaw))


def write_layout(path: Path) -> Path:
    """Write a layout for Foxglove to ``path``, and return it."""
    layout = resources.files("pushpressslide.report").joinpath("foxglove.json")
    return write_whole(path, layout.read_text("utf-8"))
