"""``pps identify``: its output, its files and its refusals."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from pushpressslide.cli import app

POSE = "{:.6f} {:.6f} 9 {:.9f} 0 0 {:.9f}"


def log(pushes: int) -> str:
    """Return a log of pushes through the centre of mass, which does not turn, in many
    directions.
    """
    lines = [str(pushes)]
    sensor = math.sqrt(0.5) * np.array([[1.0, 1.0], [1.0, -1.0]])
    for i in range(pushes):
        yaw = 0.4 * i
        c = math.cos(yaw)
        s = math.sin(yaw)
        along = np.array([math.cos(2.3 * i), math.sin(2.3 * i)])
        # the CoM is at (500, 100)
        corner = np.array([500.0 - 50.0 * (c - s), 100.0 - 50.0 * (s + c)])
        half = (math.cos(0.5 * yaw), math.sin(0.5 * yaw))
        lines += [
            POSE.format(*place, *half) for place in (corner, corner + 12.0 * along)
        ]
        times = [0.01 * k for k in range(60)]
        lines.append(str(len(times)))
        lines += [
            "{:.2f} {:.6f} {:.6f}".format(
                t, *(-sensor @ along * (4.4 if t > 0.1 else 0.0))
            )
            for t in times
        ]
        lines.append(str(len(times)))
        for t in times:
            tip = (
                np.array([500.0, 100.0])
                - 40.0 * along
                + 12.0 * max(0.0, t - 0.11) / 0.48 * along
            )
            lines.append(f"{t:.2f} " + POSE.format(*tip, 1.0, 0.0))
    return "\n".join(lines) + "\n"


def invoke(*args: str) -> Result:
    return CliRunner().invoke(app, ["identify", *args])


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pushes")
    for name in ("30_90_30_30_30_90", "patch"):
        (folder / name).mkdir()
        (folder / name / "log.txt").write_text(log(8))
    (folder / "patch" / "exp_pushaction8.txt").write_text("8\nPoint\n")
    return folder


def test_a_folder_of_sets_gives_a_table_a_result_a_page_and_a_plot_of_each(
    data: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    result = invoke(str(data), "--out", str(out), "--splits", "2")
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    sets = [line.split()[0] for line in lines if line.startswith(("30_90", "patch"))]
    said = ["30_90_30_30_30_90:", "patch:"]
    assert sets == ["30_90_30_30_30_90", "patch"] * 2 + said
    table = lines[: lines.index("Held-out errors of the direction, in degrees") + 5]
    assert all(len(line) <= 80 for line in table)
    assert lines[-1] == str(out / "report.html")
    assert {path.name for path in (out / "plots").iterdir()} == {
        "30_90_30_30_30_90.png",
        "patch.png",
    }
    page = (out / "report.html").read_text("utf-8")
    assert page.count("<img") == 2
    # heads do not wrap: 84 rem of a page hold 130 letters of 0.93 rem, and the name
    heads = [part.split("</thead>")[0] for part in page.split("<thead>")[1:]]
    letters = [len(re.sub("<[^>]*>", "", head)) for head in heads]
    assert len(heads) == 2
    assert max(letters) < 90
    assert "http" not in page
    stored = json.loads((out / "result.json").read_text("utf-8"))
    pins = stored["sets"]["30_90_30_30_30_90"]
    face = stored["sets"]["patch"]
    assert pins["friction"] == pytest.approx(4.4 / (1.5 * 9.81), rel=0.02)
    assert pins["rho_predicted"] == pytest.approx(0.0392, abs=1e-4)
    assert pins["rho_predicted_rigid_face"] is None
    assert (
        face["rho_predicted_rigid_face"]
        > face["rho_predicted"]
        == pytest.approx(0.0452, abs=1e-4)
    )
    assert face["pins"] is None
    assert all(score["mean"] < 0.02 for score in pins["errors"].values())
    assert stored["notes"] == ["exp_pushaction8.txt: not a log of pushes."]
    assert (stored["splits"], stored["fit_share"], stored["seed"]) == (2, 0.5, 0)


def test_one_log_is_enough_and_json_is_the_result_and_nothing_else(
    data: Path, tmp_path: Path
) -> None:
    options = (
        "--splits",
        "1",
        "--fit-share",
        "0.25",
        "--seed",
        "3",
        "--json",
        "--out",
        str(tmp_path),
    )
    result = invoke(str(data / "30_90_30_30_30_90" / "log.txt"), *options)
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout) == json.loads(
        (tmp_path / "result.json").read_text("utf-8")
    )
    assert list(json.loads(result.stdout)["sets"]) == ["30_90_30_30_30_90"]


def test_quiet_prints_nothing_and_an_older_result_is_kept_unless_forced(
    data: Path, tmp_path: Path
) -> None:
    call = (
        str(data / "30_90_30_30_30_90"),
        "--splits",
        "1",
        "--quiet",
        "--out",
        str(tmp_path),
    )
    result = invoke(*call)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    assert invoke(*call).exit_code == 2
    assert invoke(*call, "--force").exit_code == 0


def test_data_that_cannot_be_used_is_refused_in_one_line(
    refusal: Callable[..., str], tmp_path: Path
) -> None:
    out = ("--out", str(tmp_path / "out"))
    assert "there is no such file or folder" in refusal(
        "identify", str(tmp_path / "nowhere"), *out
    )
    assert "holds no log of pushes" in refusal("identify", str(tmp_path), *out)
    path = tmp_path / "log.txt"
    path.write_text(log(6).replace("0.20 ", "0.20 oops "))
    line = refusal("identify", str(path), *out)
    assert line.startswith(f"pps: {path}: line 25: '0.20 oops")
    assert "expected 3 numbers: time [s], fx, fy [N]" in line
    path.write_text(log(3))
    assert "3 of 3 pushes can be used; at least 4 are needed" in refusal(
        "identify", str(path), *out
    )
    assert "--splits" in refusal("identify", str(path), "--splits", "0")
    assert "--fit-share" in refusal("identify", str(path), "--fit-share", "1.5")
    assert not (tmp_path / "out").exists()
