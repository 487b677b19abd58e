"""The reader of push logs: accepted formats, and errors that name the fault and its
location.
"""

from pathlib import Path

import numpy as np
import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.recordings import find_recordings, read_recording

POSE = "628.003 22.9975 8.50358 0.374422 0.000783242 -0.000246543 0.927258"
FORCES = [
    "1439922972.717158610 0.022515 -0.082939",
    "1439922972.727 -1.5e-01 2",
    "1439922972.737 -3 +4.5",
]
PROBE = [
    "1439922972.7 598.7 84.3 23.6 0.495 0 0.001 -0.869",
    "1439922972.8 441 142.1 23.8 1 0 0 0",
]
PUSH = [POSE, POSE, "3", *FORCES, "2", *PROBE]


def log(lines: list[str], end: str = "\n") -> str:
    return "\n".join(lines) + end


@pytest.fixture
def read(tmp_path: Path):
    def call(text: str | bytes):
        path = tmp_path / "log.txt"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_recording(path)

    return call


def test_a_log_is_read_in_metres(read) -> None:
    recording = read(log(["2", *PUSH, *PUSH]))
    assert (recording.announced, len(recording.pushes)) == (2, 2)
    push = recording.pushes[1]
    assert push.before[:3] == pytest.approx([0.628003, 0.0229975, 0.00850358])
    assert push.after[3:] == pytest.approx(
        [0.374422, 0.000783242, -0.000246543, 0.927258]
    )
    assert push.forces[1] == pytest.approx([1439922972.727, -0.15, 2.0])
    assert push.probe[0, 1:] == pytest.approx(
        [0.5987, 0.0843, 0.0236, 0.495, 0.0, 0.001, -0.869]
    )
    assert push.probe.shape == (2, 8)


@pytest.mark.parametrize(
    "text",
    [
        log(["1", *PUSH], end=""),
        log(["1", *PUSH, "", "  ", ""]),
        log(["", "1", "", *PUSH]),
        log(["1", *PUSH]).replace("\n", "\r\n"),
        log(["1", *PUSH]).replace(" ", "\t  "),
        "\ufeff" + log(["1", *PUSH]),
    ],
    ids=[
        "no final newline",
        "blank lines at the end",
        "blank lines within",
        "CR LF",
        "tabs",
        "byte order mark",
    ],
)
def test_white_space_does_not_matter(read, text: str) -> None:
    (push,) = read(text).pushes
    assert (push.forces[-1] == [1439922972.737, -3.0, 4.5]).all()


def test_a_session_that_was_broken_off_between_pushes_keeps_the_whole_ones(
    read,
) -> None:
    recording = read(log(["50", *PUSH, *PUSH]))
    assert (recording.announced, len(recording.pushes)) == (50, 2)


def test_a_push_may_lack_samples(read) -> None:
    (push,) = read(log(["1", POSE, POSE, "0", "0"])).pushes
    assert (push.forces.shape, push.probe.shape) == ((0, 3), (0, 8))


def changed(at: int, line: str) -> str:
    lines = ["1", *PUSH]
    lines[at] = line
    return log(lines)


WRONG = {
    "empty": ("", "is empty"),
    "white space": (" \n\n", "is empty"),
    "no number of pushes": (
        changed(0, "fifty"),
        "line 1: 'fifty' is not allowed; expected the number of pushes",
    ),
    "negative count": (changed(0, "-1"), "line 1: '-1' is not allowed"),
    "word in a pose": (
        changed(1, "TwoPointRotation"),
        "line 2: 'TwoPointRotation' is not allowed; expected 7 numbers",
    ),
    "short pose": (
        changed(2, "1 2 3"),
        "line 3: '1 2 3' is not allowed; expected 7 numbers: x y z [mm]",
    ),
    "no unit quaternion": (
        changed(2, "1 2 3 0 0 0 0"),
        "line 3: '1 2 3 0 0 0 0' is not allowed; expected 7",
    ),
    "count that is none": (
        changed(3, "3.5"),
        "line 4: '3.5' is not allowed; expected the number of force samples",
    ),
    "short force": (
        changed(5, "1439922972.7 0.1"),
        "line 6: '1439922972.7 0.1' is not allowed; expected 3 numbers",
    ),
    "NaN": (
        changed(6, "1.0 nan 2.0"),
        "line 7: '1.0 nan 2.0' is not allowed; expected 3 numbers",
    ),
    "count too small": (
        changed(3, "2"),
        "line 7: '1439922972.737 -3 +4.5' is not allowed; expected the number of probe",
    ),
    "count too large": (
        changed(3, "4"),
        "line 8: '2' is not allowed; expected 3 numbers",
    ),
    "count far too large": (
        changed(3, "999999"),
        "line 10: the file ends within a push; expected 999993 more lines",
    ),
    "absurd count": (
        changed(3, "9" * 40),
        "is not allowed; expected the number of force samples",
    ),
    "word in the probe": (
        changed(9, "a b c d e f g h"),
        "line 10: 'a b c d e f g h' is not allowed; expected 8 numbers",
    ),
    "cut within a push": (
        log(["2", *PUSH, *PUSH[:5]]),
        "line 15: the file ends within a push",
    ),
    "cut between the poses": (
        log(["2", *PUSH, POSE]),
        "line 11: the file ends within a push; expected 1 more lines of 7",
    ),
    "cut before the probe": (
        log(["1", *PUSH[:6]]),
        "expected the number of probe samples",
    ),
    "binary": (b"\xff\xfe\x00\x01", "is not text"),
}


@pytest.mark.parametrize("case", WRONG, ids=lambda case: case.replace(" ", "-"))
def test_what_is_wrong_is_said_in_one_line_with_its_place(
    read, tmp_path: Path, case: str
) -> None:
    text, expected = WRONG[case]
    with pytest.raises(PushPressSlideError) as raised:
        read(text)
    message = str(raised.value)
    assert message.startswith(f"{tmp_path / 'log.txt'}: ")
    assert expected in message
    assert "\n" not in message
    assert len(message) < 300 + len(str(tmp_path))


def test_a_folder_gives_its_logs_at_any_depth_and_names_what_is_none(
    tmp_path: Path,
) -> None:
    for name in (
        "a/exp_sensor5.txt",
        "a/exp_pushaction5.txt",
        "b/c/exp.txt",
        "b/notes.txt",
        "b/exp.txt~",
        "README.md",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(
            "remarks\n" if "notes" in name else log(["1", *PUSH])
        )
    logs, others = find_recordings(tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in logs] == [
        "a/exp_sensor5.txt",
        "b/c/exp.txt",
    ]
    assert [path.name for path in others] == ["exp_pushaction5.txt", "notes.txt"]
    assert find_recordings(tmp_path / "b" / "notes.txt") == (
        [tmp_path / "b" / "notes.txt"],
        [],
    )


def test_a_place_without_logs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PushPressSlideError, match="no such file or folder"):
        find_recordings(tmp_path / "nowhere")
    (tmp_path / "notes.txt").write_text("remarks\n")
    with pytest.raises(PushPressSlideError, match="holds no log of pushes"):
        find_recordings(tmp_path)


def test_a_written_log_is_read_back(read, sample_pairs, write_log) -> None:
    from pushpressslide.mechanics.pressure import disc_pressure

    pairs = sample_pairs(disc_pressure(0.06, 10.0), 0.3, 5)
    recording = read(write_log(pairs))
    assert len(recording.pushes) == 5
    assert all(np.isfinite(push.forces).all() for push in recording.pushes)


def test_a_session_that_was_broken_off_before_its_first_push_holds_none(read) -> None:
    recording = read("5\n")
    assert (recording.announced, recording.pushes) == (5, ())
