"""Printed text fits 80 columns and names the written files. Pages open only if there is
a screen.
"""

import webbrowser
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from pushpressslide.cli import app, shell
from pushpressslide.cli.text import print_text

Refusal = Callable[..., str]
SLIPPERY = ("any-mode", "--set", "contact.friction=0.05", "--set", "limits.legs=1")


def invoke(*args: str) -> Result:
    return CliRunner().invoke(app, list(args), env={"COLUMNS": "80"})


@pytest.mark.parametrize("command", ["run", "plan"])
def test_a_refusal_is_one_short_line_that_names_one_reason(
    command: str, refusal: Refusal, tmp_path: Path
) -> None:
    line = refusal(command, *SLIPPERY, "--out", str(tmp_path))
    assert line == (
        "pps: any-mode: no mode can do this task; bimanual_press_slide: contact "
        "friction 0.05 must exceed the support's, 0.3: no press drags; raise "
        "contact.friction to 0.08: then orthogonal_push can (--verbose shows all)"
    )


@pytest.mark.parametrize("command", ["run", "plan"])
def test_verbose_shows_the_reasons_of_every_mode_as_a_table(
    command: str, tmp_path: Path
) -> None:
    result = invoke(command, *SLIPPERY, "--verbose", "--out", str(tmp_path))
    assert result.exit_code == 2
    assert result.stdout == ""
    *table, line = result.stderr.splitlines()
    assert "no mode can do this task" in line
    assert "--verbose" not in line
    assert table[0].split()[:2] == ["mode", "verdict"]
    assert all(len(row.rstrip()) <= 80 for row in table)
    named = {row.split()[0] for row in table[1:] if not row.startswith(" ")}
    assert named == {
        "bimanual_press_slide",
        "orthogonal_push",
        "parallel_push",
        "press_and_push",
        "press_slide",
        "rear_push",
    }


def test_a_shipped_task_goes_by_its_file_s_name(refusal: Refusal) -> None:
    line = refusal("run", "rear-push-rear", "--set", "goal.x=2")
    assert line.startswith("pps: rear-push-rear.yaml: goal: ")


@pytest.mark.parametrize("task", ["rear-push-rear", "swap"])
@pytest.mark.parametrize("command", ["select", "plan"])
def test_what_was_written_is_named_last(
    command: str, task: str, tmp_path: Path
) -> None:
    written = Path(invoke(command, task, "--out", str(tmp_path)).stdout.split()[-1])
    assert written.is_file()
    assert written.parent == tmp_path


@pytest.mark.parametrize(
    ("platform", "screen", "opened"),
    [("linux", "", False), ("linux", ":0", True), ("darwin", "", True)],
)
def test_a_page_is_opened_only_where_there_is_a_screen(
    platform: str, screen: str, opened: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pages: list[str] = []
    monkeypatch.setattr(webbrowser, "open", pages.append)
    monkeypatch.setattr(shell.sys, "platform", platform)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", screen)
    shell.show_page("http://localhost:7000")
    assert pages == ["http://localhost:7000"] * opened


@pytest.mark.parametrize("error", [False, True])
@pytest.mark.parametrize("terminal", [False, True])
def test_a_text_is_one_line_in_a_file_and_whole_words_on_a_terminal(
    terminal: bool,
    error: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = "pps: nope: no such task; known: press-slide-forklift, press-slide-pivot"
    monkeypatch.setenv("COLUMNS", "40")
    stream = shell.sys.stderr if error else shell.sys.stdout
    monkeypatch.setattr(stream, "isatty", lambda: terminal)
    print_text(text, indent=4, error=error)
    out, err = capsys.readouterr()
    lines = (err if error else out).splitlines()
    assert " ".join(line.strip() for line in lines) == text
    assert (len(lines) > 1) is terminal
    assert all(line.startswith("    ") for line in lines[1:])
    assert not terminal or max(map(len, lines)) <= 40


def test_a_wrong_choice_of_an_option_names_the_choices(refusal: Refusal) -> None:
    line = refusal("run", "rear-push-rear", "--engine", "foo")
    assert line == (
        "pps: Invalid value for '--engine': 'foo' is not one of 'drake', 'mujoco', 'planar'."
    )


def test_a_hint_is_given_only_where_a_name_is_near(refusal: Refusal) -> None:
    assert "did you mean" not in refusal("run", "nope")
    assert "did you mean 'press-slide'" in refusal("run", "pres-slide")
