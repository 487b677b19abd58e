"""The report page holds the numbers, has no external resources, and is made from the
files alone.
"""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.core.task import Box, Obstacle, ToolUse
from pushpressslide.jobs.run import Output, write_pages
from pushpressslide.jobs.stages import Done
from pushpressslide.report import series
from pushpressslide.report.files import save_run
from pushpressslide.report.metrics import result
from pushpressslide.report.page import UNFOLDED, command_line, search_part, write_report
from pushpressslide.report.page_tables import comparison_table, segments_table
from pushpressslide.report.plane import path_figure, plan_figure
from pushpressslide.report.plots import comparison_plot, figures
from pushpressslide.report.stages import StageRun
from pushpressslide.report.style import png
from pushpressslide.view.planar.replay import write_replay
from pushpressslide.view.planar.video import write_pictures

NEEDS = Refusal("load", "needs 60 N & more, limits.normal_force is <40> N")
REFUSED = Choice("press_slide", refusal=NEEDS)
PASSED = Choice("press_slide", refusal=Refusal(SKIPPED, "<24> & more are blocked"))


def save(run, folder):
    choices = (run.choice, REFUSED, PASSED)
    saved(folder, run, choices)
    return folder


def saved(folder, run, choices=()):
    figures = result(run.task, run.plan, run.record)
    stage = StageRun.alone(replace(run.record, plan=run.plan), choices)
    save_run(folder, run.task, [stage], run.record, figures)
    return Done(run.task, (stage,), run.record, figures)


def off(run, dy):
    return run.with_arrays(
        object_pose=run.record.arrays["object_pose"] + (0.0, dy, 0.0)
    )


def test_the_page_of_a_run_holds_its_numbers_and_reasons(run, tmp_path):
    folder = save(off(run, 0.0123), tmp_path / "run")
    write_replay(run.plan, run.record, folder / "replay.html")
    page = write_report([folder])
    text = page.read_text()
    assert page == folder / "report.html"
    assert "12.30 mm" in text
    assert "Goal missed" in text
    assert "10.00 mm" in text
    assert "needs 60 N &amp; more, limits.normal_force is &lt;40&gt; N" in text
    assert [text.count(f">{of}</td>") for of in ("chosen", "refused", "skipped")] == [
        1,
        1,
        1,
    ]
    assert 'href="replay.html"' in text


def test_the_page_loads_nothing_from_elsewhere(run, tmp_path):
    text = write_report([save(run, tmp_path / "run")]).read_text()
    assert not re.search(r"https?://", text)
    assert all(
        re.match(r"data:image/(png|webp);base64,", source)
        for source in re.findall(r'src="([^"]*)"', text)
    )


def test_several_runs_are_compared_first(run, tmp_path):
    runs = [save(run, tmp_path / "with"), save(off(run, 0.002), tmp_path / "without")]
    page = write_report(runs)
    text = page.read_text()
    assert page == tmp_path / "report.html"
    assert (
        text.index("Side by side")
        < text.index(">with</h2>")
        < text.index(">without</h2>")
    )
    assert 'href="with/result.json"' in text


def test_the_page_can_be_written_anywhere(run, tmp_path):
    page = write_report([save(run, tmp_path / "run")], tmp_path / "pages" / "one.html")
    assert 'href="../run/result.json"' in page.read_text()


def test_a_report_of_nothing_is_refused(tmp_path):
    with pytest.raises(PushPressSlideError, match="no folder"):
        write_report([])
    with pytest.raises(PushPressSlideError, match=r"result\.json"):
        write_report([tmp_path])


def test_every_figure_is_made_where_the_record_has_the_data(run, arm_run):
    common = ["path", "errors", "tracking", "forces"]
    off_path = {
        "tracking_error": np.full_like(run.record.arrays["tracking_error"], 1.0)
    }
    run = run.with_arrays(**off_path)
    arm_run = arm_run.with_arrays(**off_path)
    assert list(figures(run.plan, run.record)) == [*common, "speeds"]
    assert list(figures(arm_run.plan, arm_run.record)) == [
        *common,
        "torques",
        "speeds",
    ]


def test_two_arms_and_presses_have_their_own_panels(run):
    first = run.plan.contacts[0]
    press = replace(
        first, arm=1, kind="top", point=(0.02, 0.0), normal=(0.0, 0.0), height=0.08
    )
    arrays = run.record.arrays
    doubled = {
        n: np.concatenate([arrays[n], arrays[n]], axis=1)
        for n in ("command_force", "measured_force", "tip_position", "tip_reference")
    }
    made = run.with_arrays(**doubled)
    task = replace(run.task, robots=run.task.robots * 2)
    plan = replace(run.with_contacts(first, press).plan, task=task)
    drawn = figures(plan, made.record)
    assert len(drawn["forces"].axes) == 4
    assert result(task, plan, made.record)["success"]


def test_a_press_alone_shows_its_axle_and_segments_are_listed(pressed, tmp_path):
    text = write_report([save(pressed, tmp_path / "run")]).read_text()
    assert "Tracking point, from the CoM" in text
    assert text.count("press on top") == 2
    assert "Right arm: hand" in text
    first, *rest = pressed.plan.segments
    turned = replace(first, goal=replace(first.goal, yaw=math.radians(300.0)))
    assert "-60.0°" in segments_table(pressed.with_segments(turned, *rest).plan)
    # two presses have no one axle
    assert "axle" not in figures(pressed.plan, pressed.record)
    alone = pressed.with_segments(pressed.plan.segments[0])
    plan = alone.with_contacts(pressed.plan.contacts[0]).plan
    one = pressed.with_arrays(stretch=np.zeros_like(pressed.record.arrays["stretch"]))
    assert "axle" in figures(plan, one.record)


def test_shear_of_a_press_is_drawn_with_its_load(pressed, presses):
    panels = figures(pressed.plan, pressed.record)["forces"].axes
    for (press, shear), (_, _, load, (x, y)) in zip(
        (panels[:2], panels[2:]), presses, strict=True
    ):
        lines = {line.get_label(): line.get_ydata() for line in press.get_lines()}
        assert np.nanmax(lines["measured"]) == pytest.approx(load)
        assert np.nanmax(lines["planned load"]) == pytest.approx(load)
        (drawn,) = (
            line for line in shear.get_lines() if line.get_label() == "measured"
        )
        assert np.nanmax(drawn.get_ydata()) == pytest.approx(np.hypot(x, y))


def test_a_second_attempt_goes_beyond_the_plan(pressed):
    plan = pressed.with_segments(pressed.plan.segments[0]).plan
    assert result(pressed.task, plan, pressed.record)["path_rms_error"] < 1e-6
    panel = figures(plan, pressed.record)["forces"].axes[0]
    (load,) = (
        line.get_ydata()
        for line in panel.get_lines()
        if line.get_label() == "planned load"
    )
    assert np.isfinite(load[pressed.move]).mean() == pytest.approx(0.5)


def test_the_same_figure_gives_the_same_bytes(run):
    made = [png(comparison_plot([("a", run.record)])) for _ in range(2)]
    assert made[0] == made[1]


def test_a_run_cut_short_still_has_a_page(run, tmp_path):
    arrays = {
        name: values if name.startswith("plan_") else values[:1]
        for name, values in run.record.arrays.items()
    }
    short = replace(
        run,
        record=replace(
            run.record, arrays=arrays, reason="interrupted", reason_text="stopped"
        ),
    )
    assert "interrupted" in write_report([save(short, tmp_path / "run")]).read_text()


def test_the_planar_replay_is_one_page_with_all_frames(run, tmp_path):
    page = write_replay(run.plan, run.record, tmp_path / "replay.html")
    text = page.read_text()
    assert "@DATA@" not in text
    assert "NaN" not in text
    assert not re.search(r"https?://", text)
    assert run.task.name in text


def test_a_folder_gets_its_replay_under_the_usual_name(run, tmp_path):
    assert write_replay(run.plan, run.record, tmp_path) == tmp_path / "replay.html"


def test_a_run_without_stored_choices_has_no_table_of_them(run, tmp_path):
    saved(tmp_path, run)
    assert "Why this mode" not in write_report([tmp_path]).read_text()
    command_line = save(run, tmp_path / "with")
    assert "Why this mode" in write_report([command_line]).read_text()


def test_a_long_choice_of_a_mode_is_folded(run, tmp_path):
    first = Choice("rear_push", time=1.0)
    many = [replace(first, mode=f"mode {i}") for i in range(UNFOLDED + 1)]
    for count in (UNFOLDED, UNFOLDED + 1):
        out = tmp_path / str(count)
        saved(out, run, many[:count])
        part = write_report([out]).read_text().partition("<details>")[2]
        folded = f"<summary>All {count} contacts" in part.partition("<h3>")[0]
        assert folded == (count > UNFOLDED)


BARE = {
    "engine": "drake",
    "modes": ["rear_push"],
    "success": True,
    "reason": {"code": "goal_reached", "text": ""},
}


def test_the_page_says_why_the_mode_was_taken(run, tmp_path):
    text = write_report([save(run, tmp_path)]).read_text()
    part = text.partition("Why this mode")[2].partition("<h3>")[0]
    assert "rear_push is taken: no other mode was found to do the task." in part
    assert "<td class=n>5.0 s</td>" in part
    # the one that was not excluded, and that one only
    reason, _, choices = part.partition("<details>")
    assert reason.count("press_<wbr>slide") == 1
    assert "skipped: &lt;24&gt; &amp; more are blocked" in reason
    assert choices.count("rear_<wbr>push") >= 1
    assert text.count("Why this mode") == 1


def test_late_ticks_are_explained_where_there_are_some(run, tmp_path):
    assert "they do not change the result" not in comparison_table(
        ["a"], [{**BARE, "late_ticks": 0}]
    )
    assert "they do not change the result" in comparison_table(
        ["a"], [{**BARE, "late_ticks": 3}]
    )


def test_a_page_says_which_tables_are_wider_than_its_window(run, tmp_path):
    text = write_report([save(run, tmp_path)]).read_text()
    assert 'classList.toggle("wide"' in text
    assert ".scroll.wide::before" in text
    assert '<div class="scroll"><img alt="plan"' in text


def broken(run, tick):
    """Return a run whose state is NaN from a tick on, as of a simulator that failed."""
    arrays = {name: run.record.arrays[name].copy() for name in series.STATE[:3]}
    for values in arrays.values():
        values[tick:] = np.nan
    return run.with_arrays(**arrays).with_record(reason="diverged", reason_text="")


@pytest.mark.parametrize("tick", [0, 1, 200, -1])
def test_a_record_with_nan_has_pages_that_say_so(run, tick, tmp_path):
    made = broken(run, tick)
    folder = tmp_path / "run"
    write_pages(Output(folder), saved(folder, made, [made.choice]))
    text = write_report([folder]).read_text()
    when = "from the start"
    if tick:
        last = made.record.arrays["time"][:tick][-1]
        when = f"after {last:.3f} s"
    assert f"The state is not a number {when}." in text
    assert "the last pose is not a number" in text
    assert (folder / "replay.html").is_file()


def test_a_whole_record_is_not_cut(run):
    assert series.finite_part(run.record) is run.record


def test_what_went_wrong_on_the_way_is_told(run, tmp_path):
    event = {
        "time": 3.25,
        "code": "contact_lost",
        "text": "tip 0 felt nothing",
        "recovered": True,
        "lacking": None,
    }
    last = {**event, "time": 9.0, "recovered": False, "lacking": "no way <on>"}
    record = replace(run.record, meta={**run.record.meta, "events": [event, last]})
    page = write_report([save(replace(run, record=record), tmp_path)])
    text = page.read_text("utf-8")
    assert "3.2 s: <code>contact_lost</code> tip 0 felt nothing" in text
    assert "replanned" in text
    assert "No other attempt: no way &lt;on&gt;." in text


def test_what_a_search_dropped_is_told():
    search = {
        "poses": 30,
        "judged": 12,
        "refused": [
            {"mode": "rear_push", "code": "reach", "count": 4, "text": "too far <away>"}
        ],
        "dropped": [
            {
                "modes": ["rear_push", "press_slide"],
                "time": 31.2,
                "why": "no joint path",
            }
        ],
    }
    text = search_part(search)
    assert "12 motions" in text
    assert "30 poses" in text
    for cell in (
        "rear_push, press_slide",
        "31.2 s",
        "4 motions",
        "too far &lt;away&gt;",
    ):
        assert cell in text
    assert search_part(None) == ""


def test_a_curve_that_is_zero_throughout_has_no_panel(run):
    assert "tracking" not in figures(run.plan, run.record)
    errors = np.zeros_like(run.record.arrays["tracking_error"])
    errors[:, 1] = 0.002
    sideways = run.with_arrays(tracking_error=errors).record
    (panel,) = figures(run.plan, sideways)["tracking"].axes
    assert panel.get_ylabel() == "left of the path [mm]"
    twist = run.record.arrays["object_twist"].copy()
    assert len(figures(run.plan, run.record)["speeds"].axes) == 2
    twist[:, 2] = 0.0
    straight = run.with_arrays(object_twist=twist).record
    assert len(figures(run.plan, straight)["speeds"].axes) == 1


def test_the_page_shows_the_scene_and_links_every_file_that_is_there(run, tmp_path):
    folder = save(run, tmp_path / "run")
    without = write_report([folder]).read_text()
    assert "run.webp" not in without
    assert "At the start." not in without
    paths = write_pictures(run.plan, run.record, folder)
    assert [path.name for path in paths] == ["start.webp", "contact.webp", "end.webp"]
    (folder / "run.webp").write_bytes(b"RIFF")
    text = write_report([folder]).read_text()
    for file in ("run.webp", "plan.json", "record.npz", "result.json", "task.yaml"):
        assert f'href="{file}"' in text
    assert text.count("data:image/webp;base64,") == 3
    words = [text.index(w) for w in ("At the start.", "Half-way", "At the end.")]
    assert words == sorted(words)


def test_the_page_gives_the_command_and_the_versions(run, tmp_path):
    folder = save(run, tmp_path / "run")
    text = write_report([folder]).read_text()
    assert "<code>pps run task.yaml --engine planar --seed 7</code>" in text
    assert f"numpy {np.__version__}" in text
    told = command_line({"command": "pps run a <b>", "versions": {"python": "3"}})
    assert "Made by <code>pps run a &lt;b&gt;</code>" in told
    assert "with python 3" in told


def test_times_of_a_tick_are_in_ms_beside_the_period(run, tmp_path):
    text = write_report([save(run, tmp_path / "run")]).read_text()
    total = text[text.index("All of a tick, median") :][:200]
    assert "0.030 ms" in total
    assert "period 4 ms" in total


def test_bodies_that_move_and_their_goals_are_in_view_and_not_drawn_as_lines(run):
    cube = Obstacle("cube", Box((0.08, 0.08, 0.08)), Pose2(0.5, 0.3), movable=True)
    tool = ToolUse("cube", Pose2(0.2, 0.9, 0.0), 1, 0.1)
    task = replace(run.task, obstacles=(cube,), tool=tool)
    plan = replace(run.plan, task=task)
    n = len(run.record.arrays["time"])
    places = np.tile([1.0, 0.0, 0.0, 0.0, 0.5, 0.3, 0.04], (n, 1))
    places[-1, 4:6] = (0.6, 1.0)
    record = run.with_arrays(body_cube=places).record
    for figure in (plan_figure(plan), path_figure(plan, record)):
        (ax,) = figure.axes
        assert ax.get_ylim()[1] > 0.94
        assert "goal of cube" in ax.get_legend_handles_labels()[1]
        lines = [line.get_label() for line in ax.get_lines()]
        assert not any("cube" in str(label) or "body" in str(label) for label in lines)
    assert ax.get_ylim()[1] > 1.04
    assert "moved body, end" in ax.get_legend_handles_labels()[1]
