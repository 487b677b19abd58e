"""Logs as ROS messages: MCAP files, rosbag2 folders and rosbag1 files, by topics.

Stamps are taken from the headers. All poses are in one frame; forces are in that frame
or in the tip's.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError, PushPressSlideError
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.pairs import yaw_of
from pushpressslide.identification.streams import Stream, Streams, stream_of

TOPICS = {"object": "/object/pose", "tip": "/tip0/pose", "force": "/tip0/wrench"}
"""Default topics: those that ``pps export --mcap`` writes."""

Numbers = tuple[float, ...]


class _Sample(NamedTuple):
    time: float  # [s]
    frame: str
    values: Numbers


def _pose_numbers(pose: Any) -> Numbers:
    """Position, followed by the quaternion w, x, y, z."""
    p, q = pose.position, pose.orientation
    return (p.x, p.y, p.z, q.w, q.x, q.y, q.z)


def _transform_numbers(message: Any) -> Numbers:
    p, q = message.transform.translation, message.transform.rotation
    return (p.x, p.y, p.z, q.w, q.x, q.y, q.z)


def _force_numbers(force: Any) -> Numbers:
    return (force.x, force.y, force.z)


POSES: dict[str, Callable[[Any], Numbers]] = {
    "geometry_msgs/msg/PoseStamped": lambda m: _pose_numbers(m.pose),
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda m: _pose_numbers(m.pose.pose),
    "geometry_msgs/msg/TransformStamped": _transform_numbers,
    "nav_msgs/msg/Odometry": lambda m: _pose_numbers(m.pose.pose),
}
FORCES: dict[str, Callable[[Any], Numbers]] = {
    "geometry_msgs/msg/WrenchStamped": lambda m: _force_numbers(m.wrench.force),
    "geometry_msgs/msg/Vector3Stamped": lambda m: _force_numbers(m.vector),
}
KINDS = {"object": POSES, "tip": POSES, "force": FORCES}


def read_bag(path: Path, options: LogOptions) -> list[Streams]:
    """The recording in a bag, as the only element of a list.

    Raises PushPressSlideError for a file that is not a bag, a missing topic, a message
    type that is not supported, and poses in different frames. Raises
    MissingPackageError without rosbags.
    """
    topics = {**TOPICS, **options.topics}
    for name in options.topics:
        if name not in TOPICS:
            raise PushPressSlideError(f"--topic {name}: allowed: {', '.join(TOPICS)}")
    samples = _samples(path, topics)
    placed, tip, force = (_stream(path, topics[n], samples[n]) for n in TOPICS)
    frame = samples["object"][0].frame
    _check_frame(path, topics["tip"], samples["tip"][0].frame, frame)
    values = force.values
    if options.force_frame == "world":
        _check_frame(path, topics["force"], samples["force"][0].frame, frame)
    else:
        values = _turned(values, tip.values_at(force.times)[:, 3:])
    yaw = np.unwrap(yaw_of(placed.values[:, 3:]))
    return [
        Streams(
            str(path),
            Stream(placed.times, np.column_stack([placed.values[:, :2], yaw])),
            Stream(tip.times, tip.values[:, :3]),
            Stream(force.times, values[:, :2]),
            # forces in world axes stay as they are
            Stream(tip.times, np.zeros((len(tip.times), 1))),
        )
    ]


def _samples(path: Path, topics: dict[str, str]) -> dict[str, list[_Sample]]:
    """Samples of each topic in a bag."""
    try:
        highlevel = importlib.import_module("rosbags.highlevel")
        typesys = importlib.import_module("rosbags.typesys")
    except ModuleNotFoundError:
        raise MissingPackageError(
            f"{path}: rosbags is not installed: pip install 'pushpressslide[ros]'"
        ) from None
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    try:
        with highlevel.AnyReader([path], default_typestore=store) as reader:
            return {
                name: _of_topic(path, reader, name, topics[name]) for name in topics
            }
    except PushPressSlideError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:120]
        raise PushPressSlideError(
            f"{path}: is not a bag that can be read ({reason})"
        ) from None


def _of_topic(path: Path, reader: Any, name: str, topic: str) -> list[_Sample]:
    connections = [one for one in reader.connections if one.topic == topic]
    if not connections:
        known = sorted({one.topic for one in reader.connections})
        raise PushPressSlideError(
            f"{path}: has no topic {topic!r} for {name}; its topics: {', '.join(known)}; "
            f"--topic {name}=NAME names one"
        )
    kind = connections[0].msgtype
    numbers = KINDS[name].get(kind)
    if numbers is None:
        raise PushPressSlideError(
            f"{path}: topic {topic!r} has messages {kind}; allowed for {name}: "
            f"{', '.join(KINDS[name])}"
        )
    out = []
    for connection, logged, raw in reader.messages(connections=connections):
        message = reader.deserialize(raw, connection.msgtype)
        stamp = message.header.stamp
        nanoseconds = stamp.sec * 10**9 + stamp.nanosec or logged
        frame = message.header.frame_id
        out.append(_Sample(1e-9 * nanoseconds, frame, numbers(message)))
    return sorted(out, key=lambda sample: sample.time)


def _stream(path: Path, topic: str, samples: Sequence[_Sample]) -> Stream:
    """Stream of a topic. One sample is kept per stamp."""
    times = np.array([sample.time for sample in samples])
    values = np.array([sample.values for sample in samples])
    frames = {sample.frame for sample in samples}
    if len(frames) > 1:
        listed = ", ".join(sorted(frames))
        raise PushPressSlideError(f"{path}: topic {topic!r} is in frames {listed}")
    clock, first = np.unique(times, return_index=True)
    if not np.isfinite(values).all():
        raise PushPressSlideError(
            f"{path}: topic {topic!r} holds values that are not finite"
        )
    return stream_of(str(path), topic, clock, values[first])


def _check_frame(path: Path, topic: str, frame: str, expected: str) -> None:
    if frame != expected:
        remedy = "; --force-frame tip turns forces from the tip's axes"
        raise PushPressSlideError(
            f"{path}: topic {topic!r} is in frame {frame!r}; allowed: {expected!r}, as "
            f"the object's poses are{remedy if 'wrench' in topic or 'force' in topic else ''}"
        )


def _turned(forces: Array, quaternions: Array) -> Array:
    """Forces (n, 3), rotated by quaternions (n, 4) w, x, y, z."""
    unit = quaternions / np.linalg.norm(quaternions, axis=1)[:, None]
    w = unit[:, :1]
    axis = unit[:, 1:]
    across = np.cross(axis, forces)
    turned: Array = forces + 2.0 * (w * across + np.cross(axis, across))
    return turned
