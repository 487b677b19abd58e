"""Bags of ROS messages, and the files of the MIT set, are read like tables."""

import json
import math
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.core.errors import MissingPackageError
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.logs import read_logs

FRICTION = 0.34
RHO = 0.055
LATE = 0.02
EPOCH = 1_700_000_000  # [s] at which a bag begins
POSE = "geometry_msgs/msg/PoseStamped"
WRENCH = "geometry_msgs/msg/WrenchStamped"


@pytest.fixture(scope="module")
def task(box_task: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("task") / "box.yaml"
    path.write_text(box_task)
    return path


@pytest.fixture(scope="module")
def messages(ellipsoid_pushes) -> Callable[..., tuple[Any, list]]:
    """Return a function: a store of types, and messages (topic, kind, stamp, message);
    forces in the axes of a tool that points down and is turned.
    """
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    types = store.types

    def vector(values: Any) -> Any:
        return types["geometry_msgs/msg/Vector3"](*map(float, values))

    def header(seconds: float, frame: str) -> Any:
        sec, nano = divmod(round(seconds * 1e9) + EPOCH * 10**9, 10**9)
        time = types["builtin_interfaces/msg/Time"](sec, nano)
        return types["std_msgs/msg/Header"](time, frame)

    def pose(seconds: float, position: Any, rotation: Any) -> Any:
        w, x, y, z = map(float, rotation)
        point = types["geometry_msgs/msg/Point"](*map(float, position))
        turned = types["geometry_msgs/msg/Quaternion"](x, y, z, w)
        made = types["geometry_msgs/msg/Pose"](point, turned)
        return types[POSE](header(seconds, "world"), made)

    def wrench(seconds: float, force: Any, frame: str) -> Any:
        made = types["geometry_msgs/msg/Wrench"](vector(force), vector((0, 0, 0)))
        return types[WRENCH](header(seconds, frame), made)

    def make(names: tuple[str, str, str], frame: str = "world") -> tuple[Any, list]:
        pushes = ellipsoid_pushes
        out = []
        for t, (x, y, yaw) in zip(pushes.pose_times, pushes.poses, strict=True):
            half = 0.5 * yaw
            turn = (math.cos(half), 0.0, 0.0, math.sin(half))
            out.append((names[0], POSE, t, pose(t, (x, y, 0.0), turn)))
        # x forward, y and z turned round: a half turn about x, then 0.3 about z
        tool = (0.0, math.cos(0.15), math.sin(0.15), 0.0)
        c, s = math.cos(0.3), math.sin(0.3)
        R = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
        for t, tip, force in zip(pushes.times, pushes.tips, pushes.forces, strict=True):
            out.append((names[1], POSE, t, pose(t, tip, tool)))
            whole = np.array([*force, 0.0])
            given = whole if frame == "world" else R.T @ whole
            out.append((names[2], WRENCH, t, wrench(t, given, frame)))
        return store, sorted(out, key=lambda row: row[2])

    return make


def write_mcap(path: Path, store: Any, rows: list) -> None:
    writer_module = pytest.importorskip("mcap.writer")
    with path.open("wb") as file:
        writer = writer_module.Writer(file)
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        for topic, kind, seconds, message in rows:
            if topic not in channels:
                text, _ = store.generate_msgdef(kind, ros_version=2)
                schema = writer.register_schema(kind, "ros2msg", text.encode())
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            # written late by a transport of its own
            logged = round(1e9 * (EPOCH + seconds + 0.07))
            raw = bytes(store.serialize_cdr(message, kind))
            writer.add_message(channels[topic], logged, raw, logged)
        writer.finish()


def found(data: Path, task: Path, out: Path, *options: str) -> dict:
    args = ["identify", str(data), "--task", str(task), "--out", str(out)]
    result = CliRunner().invoke(app, [*args, "--splits", "1", "--json", *options])
    assert result.exit_code == 0, result.stderr
    (figures,) = json.loads(result.stdout)["sets"].values()
    return figures


def check_values(figures: dict) -> None:
    assert figures["friction"] == pytest.approx(FRICTION, rel=0.03)
    assert figures["rho"] == pytest.approx(RHO, rel=0.05)
    (clock,) = figures["clocks"]
    assert clock["offset"] == pytest.approx(-LATE, abs=0.003)


def test_an_mcap_file_of_the_topics_of_an_export(
    messages: Callable[..., Any], task: Path, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    write_mcap(path, *messages(("/object/pose", "/tip0/pose", "/tip0/wrench")))
    check_values(found(path, task, tmp_path / "out"))


def test_a_rosbag2_folder_with_topics_by_name_and_forces_in_the_tool(
    messages: Callable[..., Any], task: Path, tmp_path: Path
) -> None:
    bags = pytest.importorskip("rosbags.rosbag2")
    names = ("/mocap/box", "/ee", "/ft")
    store, rows = messages(names, "tool")
    with bags.Writer(tmp_path / "bag", version=9) as writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=store)
            for topic, kind in zip(names, (POSE, POSE, WRENCH), strict=True)
        }
        for topic, kind, seconds, message in rows:
            stamp = round(1e9 * (EPOCH + seconds))
            writer.write(connections[topic], stamp, store.serialize_cdr(message, kind))
    streams = zip(("object", "tip", "force"), names, strict=True)
    options = [
        word for name, topic in streams for word in ("--topic", f"{name}={topic}")
    ]
    where = ("--force-frame", "tip")
    check_values(found(tmp_path / "bag", task, tmp_path / "out", *options, *where))


def refused(path: Path, task: Path, *options: str) -> str:
    args = ["identify", str(path), "--task", str(task), "--out", str(path.parent / "o")]
    result = CliRunner().invoke(app, [*args, *options])
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    return line


def test_topics_and_frames_that_are_not_those_of_a_push_are_refused(
    messages: Callable[..., Any], task: Path, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    write_mcap(path, *messages(("/object/pose", "/tip0/pose", "/tip0/wrench"), "ft"))
    line = refused(path, task)
    assert "topic '/tip0/wrench' is in frame 'ft'; allowed: 'world'" in line
    assert "--force-frame tip" in line
    line = refused(path, task, "--topic", "object=/box")
    assert (
        "has no topic '/box' for object; its topics: /object/pose, /tip0/pose" in line
    )
    line = refused(path, task, "--topic", "object=/tip0/wrench")
    assert f"has messages {WRENCH}; allowed for object: {POSE}" in line
    assert "--topic mass: allowed" in refused(path, task, "--topic", "mass=/m")
    path.write_bytes(b"nothing")
    assert "is not a bag that can be read" in refused(path, task)


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [
        ("a.mcap", "rosbags.highlevel", "[ros]"),
        ("a.h5", "h5py", "[hdf5]"),
        ("a.parquet", "pyarrow.parquet", "pyarrow"),
    ],
)
def test_a_package_that_is_missing_is_named_with_its_command(
    name: str, module: str, extra: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    path = tmp_path / name
    path.write_bytes(b"")
    with pytest.raises(MissingPackageError, match=r"pip install .*") as refusal:
        read_logs([path], LogOptions())
    assert extra in str(refusal.value)


def test_a_parquet_file_is_read_as_a_csv_file_is(
    ellipsoid_pushes, task: Path, tmp_path: Path
) -> None:
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    pushes = ellipsoid_pushes
    n = len(pushes.pose_times)
    m = len(pushes.times)
    columns = {
        "object_time": np.append(pushes.pose_times, np.full(m - n, np.nan)),
        **{
            f"object_{axis}": np.append(pushes.poses[:, i], np.full(m - n, np.nan))
            for i, axis in enumerate(("x", "y", "yaw"))
        },
        "time": pushes.times,
        **{f"tip_{axis}": pushes.tips[:, i] for i, axis in enumerate("xyz")},
        **{f"tip_f{axis}": pushes.forces[:, i] for i, axis in enumerate("xy")},
        "comment": ["text"] * m,
    }
    parquet.write_table(arrow.table(columns), tmp_path / "a.parquet")
    check_values(found(tmp_path / "a.parquet", task, tmp_path / "out"))


@pytest.mark.parametrize("kind", ["h5", "json"])
def test_a_folder_of_pushes_of_the_mit_set_is_one_set(
    kind: str, ellipsoid_pushes, task: Path, tmp_path: Path
) -> None:
    pushes = ellipsoid_pushes
    size = np.hypot(*(pushes.forces - (0.3, -0.2)).T)
    # between two pushes the tip is free for over a second
    free = np.flatnonzero(size < 1.0)
    breaks = pushes.times[free][np.flatnonzero(np.diff(pushes.times[free]) > 1.0)]
    ends = [*(breaks - 0.4), pushes.times[-1]]
    for i, (first, last) in enumerate(pairwise(ends)):
        rows = (pushes.times >= first) & (pushes.times < last)
        own = (pushes.pose_times >= first) & (pushes.pose_times < last)
        zero = np.zeros(rows.sum())
        sets = {
            "object_pose": np.column_stack([pushes.pose_times[own], pushes.poses[own]]),
            "tip_pose": np.column_stack(
                [pushes.times[rows], pushes.tips[rows, :2], zero]
            ),
            "ft_wrench": np.column_stack(
                [pushes.times[rows], pushes.forces[rows], zero]
            ),
        }
        path = tmp_path / "set" / f"push{i}.{kind}"
        path.parent.mkdir(exist_ok=True)
        if kind == "json":
            path.write_text(json.dumps({k: v.tolist() for k, v in sets.items()}))
            continue
        with pytest.importorskip("h5py").File(path, "w") as file:
            for name, values in sets.items():
                file[name] = values
    options = ("--tip-height", "0.02", "--offset", str(-LATE))
    figures = found(tmp_path / "set", task, tmp_path / "out", *options)
    assert len(figures["logs"]) == len(ends) - 1 > 10
    assert figures["friction"] == pytest.approx(FRICTION, rel=0.03)
    assert figures["rho"] == pytest.approx(RHO, rel=0.05)
    assert {clock["half_width"] for clock in figures["clocks"]} == {0.0}


def test_a_json_file_of_three_samples_is_refused_by_its_count(
    task: Path, tmp_path: Path
) -> None:
    rows = [[0.1 * i, 0.3, 0.0, 0.0] for i in range(3)]
    names = ("object_pose", "tip_pose", "ft_wrench")
    path = tmp_path / "a.json"
    path.write_text(json.dumps(dict.fromkeys(names, rows)))
    assert "object_pose: 3 samples; at least 10" in refused(path, task)
    path.write_text("{}")
    assert "object_pose is missing" in refused(path, task)
    path.write_text("[")
    assert "is not a JSON file with object_pose" in refused(path, task)
