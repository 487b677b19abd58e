"""A run is exported for other programs, and read back by them."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pushpressslide as pps
from pushpressslide.cli import app
from pushpressslide.core.record_columns import named_columns
from pushpressslide.report.files import Run, load_run
from pushpressslide.report.mcap_export import write_mcap

TOPICS = {"/object/pose", "/object/reference", "/tip0/pose", "/tip0/wrench", "/tf"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("run") / "run"
    args = ["run", "rear-push-rear", "--engine", "planar", "--out", str(folder)]
    assert CliRunner().invoke(app, [*args, "--quiet"]).exit_code == 0
    return load_run(folder)


@pytest.fixture(scope="module")
def mcap(run: Run) -> Path:
    pytest.importorskip("mcap")
    pytest.importorskip("rosbags")
    export("--mcap", run)
    return run.folder / "run.mcap"


def export(option: str, run: Run) -> None:
    result = CliRunner().invoke(app, ["export", str(run.folder), option])
    assert result.exit_code == 0, result.stderr


def yaw_of(rotation: object) -> float:
    w, z = rotation.w, rotation.z
    return float(np.arctan2(2.0 * w * z, 1.0 - 2.0 * z * z))


def check_read_back(run: Run, read: dict[str, list[tuple[int, object]]]) -> None:
    """Stamps to 1 ns, values to 1e-12."""
    arrays = run.record.arrays
    assert set(read) == TOPICS
    stamps = 1e9 * arrays["time"]
    for rows in read.values():
        assert len(rows) == len(stamps)
        assert np.array([t for t, _ in rows]) == pytest.approx(stamps, abs=1.0)
    poses = [
        (m.pose.position.x, m.pose.position.y, yaw_of(m.pose.orientation))
        for _, m in read["/object/pose"]
    ]
    assert np.abs(np.array(poses) - arrays["object_pose"]).max() < 1e-12
    headers = [m.header.stamp for _, m in read["/object/pose"]]
    clock = np.array([h.sec * 10**9 + h.nanosec for h in headers])
    assert clock == pytest.approx(stamps, abs=1.0)
    forces = [
        (m.wrench.force.x, m.wrench.force.y, m.wrench.force.z)
        for _, m in read["/tip0/wrench"]
    ]
    assert (np.array(forces) == arrays["measured_force"][:, 0]).all()
    frame = read["/tf"][-1][1].transforms[0]
    assert (frame.header.frame_id, frame.child_frame_id) == ("world", "object")
    assert frame.transform.translation.x == arrays["object_pose"][-1, 0]


def test_rosbags_reads_an_mcap_file_back(run: Run, mcap: Path) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    read: dict[str, list] = {}
    with highlevel.AnyReader([mcap]) as reader:
        for connection, stamp, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            read.setdefault(connection.topic, []).append((stamp, message))
    check_read_back(run, read)


def test_mcap_ros2_reads_it_back_with_task_plan_and_result(
    run: Run, mcap: Path
) -> None:
    support = pytest.importorskip("mcap_ros2.decoder")
    reader_module = pytest.importorskip("mcap.reader")
    read: dict[str, list] = {}
    with mcap.open("rb") as file:
        reader = reader_module.make_reader(
            file, decoder_factories=[support.DecoderFactory()]
        )
        for _, channel, message, content in reader.iter_decoded_messages():
            read.setdefault(channel.topic, []).append((message.log_time, content))
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
    check_read_back(run, read)
    result = json.loads(metadata["result"]["json"])
    assert result["success"] is True
    assert "rear-push-rear" in metadata["task"]["yaml"]
    assert json.loads(metadata["plan"]["json"])["stages"]


def test_joints_and_bodies_have_topics_of_their_own(run: Run, tmp_path: Path) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    pytest.importorskip("mcap")
    ticks = len(run.record.arrays["time"])
    q = np.random.default_rng(0).normal(size=(ticks, 7))
    more = {
        "joint_position_0": q,
        "joint_velocity_0": 2.0 * q,
        "joint_torque_0": 3.0 * q,
        "body_post": q,
    }
    record = replace(run.record, arrays={**run.record.arrays, **more})
    path = write_mcap(replace(run, record=record), tmp_path / "a.mcap")
    read: dict[str, list] = {}
    with highlevel.AnyReader([path]) as reader:
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            read.setdefault(connection.topic, []).append(message)
    assert set(read) == TOPICS | {"/joint_states", "/post/pose"}
    state = read["/joint_states"][5]
    assert list(state.name) == [f"panda_joint{i}" for i in range(1, 8)]
    assert (state.position == q[5]).all()
    assert (state.effort == 3.0 * q[5]).all()
    pose = read["/post/pose"][5].pose
    assert (pose.orientation.w, pose.orientation.x, pose.position.z) == (
        q[5, 0],
        q[5, 1],
        q[5, 6],
    )
    assert [t.child_frame_id for t in read["/tf"][0].transforms] == ["object", "post"]


def test_an_mcap_file_is_smaller_than_twice_the_record(run: Run, mcap: Path) -> None:
    record = (run.folder / "record.npz").stat().st_size
    assert mcap.stat().st_size < 2 * record
    layout = json.loads((run.folder / "foxglove.json").read_text())
    text = json.dumps(layout)
    assert {topic for topic in ("/object/pose", "/tip0/wrench") if topic in text}
    assert layout["layout"]["first"] in layout["configById"]


def test_a_csv_file_has_the_columns_of_the_data_frame_to_the_bit(run: Run) -> None:
    export("--csv", run)
    lines = (run.folder / "run.csv").read_text().splitlines()
    names = lines[0].split(",")
    columns = named_columns(run.record.arrays)
    assert names == list(columns)
    assert {"object_x", "object_yaw", "tip0_fx", "reference_y", "phase"} < set(names)
    cells = dict(
        zip(
            names,
            zip(*(line.split(",") for line in lines[1:]), strict=True),
            strict=True,
        )
    )
    assert list(cells["phase"]) == columns["phase"]
    for name in ("time", "object_yaw", "tip0_fx", "tip0_command_fz"):
        read = np.array([float(cell or "nan") for cell in cells[name]])
        assert np.array_equal(read, columns[name], equal_nan=True)


@pytest.mark.parametrize("option", ["--csv", "--mcap"])
def test_identify_reads_an_export(option: str, run: Run, tmp_path: Path) -> None:
    if option == "--mcap":
        pytest.importorskip("mcap")
        pytest.importorskip("rosbags")
    export(option, run)
    data = run.folder / f"run.{option[2:]}"
    args = ["identify", str(data), "--task", "rear-push-rear", "--out", str(tmp_path)]
    result = CliRunner().invoke(app, [*args, "--splits", "1", "--json"])
    assert result.exit_code == 0, result.stderr
    (figures,) = json.loads(result.stdout)["sets"].values()
    friction = pps.load_task("rear-push-rear").support.friction
    assert figures["friction"] == pytest.approx(friction, rel=0.05)


def test_joints_of_an_arm_have_names(drake_free_columns: dict) -> None:
    names = list(named_columns(drake_free_columns))
    assert names == [
        "time",
        "arm1_joint1_torque",
        "arm1_joint2_torque",
        "arm1_torque_share",
        "body_post_qw",
        *(f"body_post_{part}" for part in ("qx", "qy", "qz", "x", "y", "z")),
        "tip0_contact_x",
        *(f"tip{arm}_contact_{axis}" for arm, axis in ((0, "y"), (0, "z"))),
        *(f"tip1_contact_{axis}" for axis in "xyz"),
        "tick_total",
    ]


@pytest.fixture
def drake_free_columns() -> dict:
    return {
        "time": np.arange(3.0),
        "joint_torque_1": np.zeros((3, 2)),
        "torque_share_1": np.zeros(3),
        "body_post": np.zeros((3, 7)),
        "contact_point": np.zeros((3, 2, 3)),
        "tick_total": np.zeros(3),
        "plan_path": np.zeros((200, 3)),
    }


@pytest.mark.parametrize(
    ("option", "module", "remedy"),
    [
        ("--mcap", "mcap.writer", "pip install 'pushpressslide[ros]'"),
        ("--rerun", "rerun", "pip install rerun-sdk"),
    ],
)
def test_a_package_that_is_missing_is_named(
    option: str, module: str, remedy: str, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    result = CliRunner().invoke(app, ["export", str(run.folder), option])
    assert result.exit_code == 2
    assert remedy in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_recording_for_rerun_is_written_where_it_is_installed(run: Run) -> None:
    pytest.importorskip("rerun")
    export("--rerun", run)
    assert (run.folder / "run.rrd").stat().st_size > 0


def test_an_export_needs_a_form_and_a_run(run: Run, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["export", str(run.folder)])
    assert (result.exit_code, "give --mcap, --csv or --rerun" in result.stderr) == (
        2,
        True,
    )
    result = CliRunner().invoke(app, ["export", str(tmp_path), "--csv"])
    assert "has no result.json" in result.stderr
