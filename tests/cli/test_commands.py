"""Output, files and exit statuses of the commands."""

import json
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from pushpressslide.cli import app, folders
from pushpressslide.core.errors import InfeasibleTaskError, SimulationError
from pushpressslide.jobs.interrupt import Interrupted
from pushpressslide.jobs.run import Monitor, Output
from pushpressslide.modes import MODES


def result_of(
    success: bool | None = True, code: str = "goal_reached"
) -> dict[str, Any]:
    return {
        "schema": 1,
        "events": [],
        "task": "rear-push-rear",
        "engine": "drake",
        "modes": ["rear_push"],
        "success": success,
        "verified": code == "goal_reached",
        "reason": {"code": code, "text": f"it ended with {code}"},
        "final_position_error": 0.00123,
        "final_yaw_error": 0.01,
        "max_normal_force": None,
    }


def invoke(*args: str) -> Result:
    return CliRunner().invoke(app, list(args))


@pytest.fixture
def run_with(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Return a function: ``pps run`` with run_task replaced by one that answers or
    raises what is given.
    """

    def call(answer: Any, *args: str) -> Result:
        def run_task(
            task: Any, *, out: Output, monitor: Monitor, **options: Any
        ) -> dict[str, Any]:
            # type: ignore[attr-defined]
            call.seen = {"task": task, "out": out.folder, **options}
            assert monitor.progress is not None
            monitor.progress(1.0, 2.0)
            if isinstance(answer, BaseException):
                raise answer
            out.folder.mkdir(parents=True, exist_ok=True)
            (out.folder / "report.html").write_text("")
            return dict(answer)

        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr("pushpressslide.jobs.run.run_task", run_task)
        return invoke("run", "rear-push-rear", *args)

    return call


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        (result_of(), 0),
        (result_of(False, "goal_missed"), 1),
        (result_of(False, "goal_reached"), 1),
        (result_of(True, "not_verified"), 1),
        (result_of(None, "goal_reached"), 0),
        (result_of(None, "not_verified"), 1),
        (Interrupted("interrupted; record and result so far are in here"), 130),
        (KeyboardInterrupt(), 130),
        (InfeasibleTaskError("no mode can do it"), 2),
        (SimulationError("the engine could not go on"), 3),
        (ZeroDivisionError("division by zero"), 3),
    ],
)
def test_the_exit_status_says_how_the_run_ended(
    run_with: Any, answer: Any, status: int
) -> None:
    result = run_with(answer)
    assert result.exit_code == status
    assert len(result.stderr.splitlines()) == (status > 1)
    assert "Traceback" not in result.stderr


def test_an_internal_error_shows_its_traceback_on_demand(
    run_with: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "PPS_TRACEBACK" in run_with(ZeroDivisionError("division by zero")).stderr
    monkeypatch.setenv("PPS_TRACEBACK", "1")
    assert "Traceback" in run_with(ZeroDivisionError("division by zero")).stderr


@pytest.mark.parametrize(
    ("answer", "code"),
    [
        (result_of(), "goal_reached"),
        (result_of(False, "goal_missed"), "goal_missed"),
        (ZeroDivisionError("oh"), "internal_error"),
    ],
)
def test_json_is_the_result_and_nothing_else(
    run_with: Any, answer: Any, code: str
) -> None:
    printed = json.loads(run_with(answer, "--json").stdout)
    assert printed["reason"]["code"] == code
    if isinstance(answer, dict):
        assert printed == answer


def test_quiet_prints_nothing(run_with: Any) -> None:
    result = run_with(result_of(), "--quiet")
    assert (result.stdout, result.stderr) == ("", "")


def test_the_table_has_units_and_the_report_as_its_last_line(run_with: Any) -> None:
    result = run_with(result_of(), "--out", "here")
    assert "1.23" in result.stdout
    assert "mm" in result.stdout
    assert result.stdout.splitlines()[-1] == "here/report.html"


def test_a_run_says_why_its_mode_was_taken_before_its_figures(tmp_path: Path) -> None:
    out = str(tmp_path / "run")
    result = invoke("run", "any-mode", "--engine", "planar", "--out", out)
    assert result.exit_code == 0
    why, figures, _ = result.stdout.partition("goal reached")
    assert figures
    sentence = " ".join(why.split())
    assert "bimanual_press_slide is taken: of 5 modes that can do the task" in sentence
    for mode in MODES:
        assert mode in why
    assert "refused: the goal is turned about" in sentence


def test_a_missed_goal_says_why(run_with: Any) -> None:
    assert (
        "it ended with goal_missed" in run_with(result_of(False, "goal_missed")).stdout
    )


def test_the_options_reach_the_run(run_with: Any) -> None:
    run_with(
        result_of(),
        "--engine",
        "planar",
        "--mode",
        "rear_push",
        "--seed",
        "7",
        "--out",
        "here",
        "--set",
        "motion.speed=0.03",
        "--set",
        "robots.0.base.yaw_deg=10",
        "--anyway",
    )
    seen = run_with.seen
    assert seen["task"].motion.speed == 0.03
    assert seen["task"].modes == ("rear_push",)
    assert seen["task"].robots[0].base_yaw > 0.17
    assert (seen["engine"], seen["seed"]) == ("planar", 7)
    assert seen["out"] == Path("here")
    assert seen["force"] is True


def test_results_go_to_a_new_folder_below_runs(run_with: Any) -> None:
    run_with(result_of())
    first = run_with.seen["out"]
    run_with(result_of())
    assert first.parent == Path("runs")
    assert first.name.startswith("rear-push-rear-2")
    assert run_with.seen["out"] != first


def test_two_commands_in_one_second_get_two_folders(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Clock:
        @staticmethod
        def now() -> datetime:
            return datetime(2026, 1, 2, 3, 4, 5)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(folders, "datetime", Clock)
    with ThreadPoolExecutor(8) as pool:
        made = list(
            pool.map(lambda _: folders.results_folder(None, "run", False), range(8))
        )
    assert len(set(made)) == 8
    assert Path("runs/run-20260102-030405") in made
    assert all(folder.is_dir() for folder in made)
    folders.leave_folders()
    assert not any(folder.exists() for folder in made)


def test_a_command_that_fails_leaves_no_folder(run_with: Any, tmp_path: Path) -> None:
    run_with(InfeasibleTaskError("no mode can do it"))
    assert list((tmp_path / "runs").iterdir()) == []


@pytest.mark.parametrize("command", ["select", "plan"])
def test_a_choice_without_joint_paths_says_so(command: str, tmp_path: Path) -> None:
    shown = invoke(command, "rear-push-rear", "--out", str(tmp_path)).stdout
    assert "whether the arm's joints can follow" in " ".join(shown.split())


def test_tasks_are_listed_one_a_line_with_a_description() -> None:
    lines = invoke("tasks").stdout.splitlines()
    assert [line.split()[0] for line in lines] == sorted(
        json.loads(invoke("tasks", "--json").stdout)
    )
    assert all(len(line.split()) > 3 for line in lines)


def test_every_mode_of_the_library_is_in_the_table() -> None:
    from pushpressslide.modes import MODES

    table = invoke("modes").stdout
    assert all(name in table for name in MODES)
    assert [
        row["mode"] for row in json.loads(invoke("modes", "--json").stdout)
    ] == list(MODES)


def test_select_ranks_and_leaves_a_file(tmp_path: Path) -> None:
    result = invoke("select", "rear-push-rear", "--json", "--out", str(tmp_path))
    rows = json.loads(result.stdout)
    assert result.exit_code == 0
    assert rows[0]["feasible"]
    assert json.loads((tmp_path / "select.json").read_text())["choices"] == rows
    assert (
        "rear_push"
        in invoke("select", "rear-push-rear", "--out", str(tmp_path), "--force").stdout
    )


def test_select_leaves_no_folder_unasked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for task in ("rear-push-rear", "three-objects"):
        assert invoke("select", task).exit_code == 0
    assert list(tmp_path.iterdir()) == []


AT_GOAL = ("--set", "goal={x: 0.38, y: 0.22, yaw_deg: 0}")


@pytest.mark.parametrize("command", ["select", "plan", "run"])
def test_an_object_at_its_goal_is_a_success(command: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("rear-push-rear", *AT_GOAL, "--out", str(out))
    result = invoke(command, *words)
    assert result.exit_code == 0, result.stderr
    if command == "run":
        assert json.loads((out / "result.json").read_text())["success"]
        assert "at its goal already" in (out / "report.html").read_text()
        assert invoke("report", str(out)).exit_code == 0


def test_bodies_at_their_goals_are_a_success(tmp_path: Path) -> None:
    goals = "goals=[{body: object, x: 0.38, y: 0.22, yaw_deg: 0}]"
    words = ("--set", "goal=null", "--set", goals, "--engine", "planar")
    result = invoke("run", "rear-push-rear", *words, "--out", str(tmp_path))
    assert result.exit_code == 0, result.stderr


def test_a_slip_is_warned_about_in_one_line() -> None:
    result = invoke("select", "rear-push-rear", "--set", "object.mass=800")
    (line,) = [line for line in result.stderr.splitlines() if "warning" in line]
    assert line.startswith("pps: warning: rear-push-rear.yaml: object.mass: 800 kg in")


def test_select_ranks_one_mode_alone_if_asked(tmp_path: Path) -> None:
    words = ("select", "any-mode", "--mode", "rear_push", "--json")
    rows = json.loads(invoke(*words, "--out", str(tmp_path)).stdout)
    assert rows[0]["feasible"]
    assert {row["mode"] for row in rows} == {"rear_push"}


def test_select_looks_at_joint_paths_if_asked(tmp_path: Path) -> None:
    task = ("rear-push-rear", "--set", "limits.legs=1", "--json", "--joints")
    result = invoke("select", *task, "--out", str(tmp_path))
    rows = json.loads(result.stdout)
    assert rows[0]["feasible"]
    assert json.loads((tmp_path / "select.json").read_text())["joint_paths"]
    # the Panda's wrist would be in the table: a plan exists, and no joint path
    low = ("--set", "robots=[{model: panda, base: {x: 0, y: 0, z: -0.3}}]", "--force")
    result = invoke("select", *task, *low, "--out", str(tmp_path))
    refused = [row for row in json.loads(result.stdout) if not row["feasible"]]
    assert len(refused) == len(json.loads(result.stdout))


def test_joint_paths_of_legs_depend_on_those_before(tmp_path: Path) -> None:
    result = invoke("select", "swap", "--joints", "--out", str(tmp_path))
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert "--joints: allowed for a task of one motion" in result.stderr


@pytest.mark.parametrize("command", ["select", "plan"])
def test_a_task_that_no_mode_can_do_exits_two_with_the_reason(
    command: str, tmp_path: Path
) -> None:
    # Hardly any friction at the tip: the tightest turn is metres wide, and the way
    # longer than the time.
    sets = ["--set", "motion.face=1", "--set", "goal={x: 0.42, y: 0.22, yaw_deg: 90}"]
    result = invoke(
        command,
        "rear-push-rear",
        *sets,
        "--set",
        "contact.friction=0.01",
        "--out",
        str(tmp_path),
    )
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert "no mode can do this task" in result.stderr


def test_plan_writes_its_files_and_prints_json(tmp_path: Path) -> None:
    result = invoke("plan", "rear-push-left", "--json", "--out", str(tmp_path))
    assert result.exit_code == 0
    assert json.loads(result.stdout)["stages"][0]["segments"][0]["mode"] == "rear_push"
    assert {"plan.json", "plan.png"} <= {path.name for path in tmp_path.iterdir()}


def test_odds_are_those_of_the_tier_and_need_stated_errors(tmp_path: Path) -> None:
    words = ("plan", "press-slide", "--odds", "--json", "--out", str(tmp_path))
    exact = invoke(*words)
    assert "mass_error and center_error are 0" in exact.stderr
    assert exact.exit_code == 0
    at_tier = invoke(*words, "--force", "--set", "truth=tier3")
    assert at_tier.stderr == ""
    shares = [
        json.loads(result.stdout)["stages"][0]["odds"]["share"]
        for result in (exact, at_tier)
    ]
    assert shares[0] in (0.0, 1.0)
    assert 0.0 < shares[1] < 1.0


@pytest.mark.parametrize(
    "words",
    [
        "modes",
        "tasks",
        "select",
        "plan",
        "run",
        "report",
        "sweep",
        "identify",
    ],
)
def test_every_command_of_the_contract_has_help(words: str) -> None:
    result = invoke(words, "--help")
    assert result.exit_code == 0
    assert "Usage" in result.stdout
    assert words in invoke().stdout
