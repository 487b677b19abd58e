"""The programs of the how-to pages work, with the results stated there."""

import re
import time
from pathlib import Path

import pytest
import yaml

import pushpressslide as pps
from pushpressslide.taskfile.load import task_from_data

DOCS = Path(__file__).parents[2] / "docs"


def page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def block(heading: str, language: str) -> str:
    """Return the first block of a language below a heading of your-setup.md."""
    section = page("your-setup.md").split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return section.split(f"```{language}\n")[1].split("```")[0]


def test_the_object_of_the_page_is_pressed_and_not_pushed_in_its_notch() -> None:
    task = task_from_data(yaml.safe_load(block("Your object", "yaml")), "my-l")
    choices = pps.select(task)
    assert choices[0].mode == "press_slide"
    assert choices[0].feasible
    against = [str(choice) for choice in choices]
    for words in (
        "the centre of mass is not in front of the face",
        "turns by 383 deg",
        "(-0.054, 0.031)",
    ):
        assert any(words in line for line in against), words


def test_the_arm_of_the_page_is_one_that_a_task_can_have(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(block("Your robot", "python"), "own-robot", "exec"), {})
    robot = yaml.safe_load(block("Your robot", "yaml"))["robots"][0]
    robot["model"] = str(tmp_path / robot["model"])
    task = pps.load_task("rear-push-rear", [f"robots={[robot]}"])
    assert pps.select(task)[0].feasible
    with pytest.raises(pps.TaskError, match="iiwa_link_7, iiwa_flange"):
        pps.load_task(
            "rear-push-rear", [f"robots={[robot | {'tip': {'link': 'nothing'}}]}"]
        )


def test_three_pushes_lead_round_the_post_and_one_does_not() -> None:
    only = ["modes=[rear_push]"]
    plan = pps.plan(pps.load_task("post", only))
    assert [segment.mode for segment in plan.segments] == ["rear_push"] * 3
    assert len(plan.placements) == 1
    with pytest.raises(pps.InfeasibleTaskError) as refused:
        pps.plan(pps.load_task("post", [*only, "limits.legs=1"]))
    words = re.search(r'"(face 1: [^"]*)"', " ".join(page("sequences.md").split()))
    assert words
    assert words.group(1) in str(refused.value)


def test_what_may_move_is_pushed_where_no_way_leads_past() -> None:
    sets = re.findall(r"--set '?([^\s']+)'?", page("sequences.md").split("<!-- -->")[1])
    assert len(sets) == 5
    plan = pps.plan(pps.load_task("post", sets))
    assert [segment.mode for segment in plan.segments] == ["rear_push"]


def test_the_loop_at_the_pace_of_a_clock_reaches_the_goal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(time, "sleep", lambda seconds: None)
    exec(compile(block("On hardware", "python"), "hardware", "exec"), {})
    assert capsys.readouterr().out.startswith("goal_reached at most ")


@pytest.mark.long
@pytest.mark.parametrize(
    ("sets", "figures"),
    re.findall(
        r"^\| (nothing|`[a-z_]+[.=].*?`) \| (\S+ / \S+ \| \S+) \|$",
        page("uncertainty.md"),
        re.MULTILINE,
    ),
)
def test_the_table_of_beliefs_is_current(sets: str, figures: str) -> None:
    told = [] if sets == "nothing" else [sets.strip("`")]
    run = pps.run(pps.load_task("rear-push-rear", told), engine="planar", seed=1)
    got = run.figures
    degrees = 57.29577951308232 * got["final_yaw_error"]
    place = f"{1e3 * got['final_position_error']:.1f} / {degrees:.2f}"
    assert f"{place} | {1e3 * got['path_rms_error']:.1f}" == figures
