"""Commands about task files."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.taskfile.load import load_task, shipped_tasks
from pushpressslide.taskfile.schema import SCHEMA
from pushpressslide.taskfile.starter import starter

Refusal = Callable[..., str]


def called(*words: str) -> str:
    result = CliRunner().invoke(app, list(words))
    assert result.exit_code == 0, result.stderr
    return result.stdout


def test_a_new_file_is_a_task_with_every_field_in_it(tmp_path: Path) -> None:
    file = tmp_path / "my box.yaml"
    assert called("new", str(file)).strip() == str(file)
    task = load_task(file)
    assert task.name == "my-box"
    text = file.read_text(encoding="utf-8")
    for key in SCHEMA.fields or {}:
        assert f"{key}:" in text, key
    assert max(map(len, starter("box", "box.yaml").splitlines())) < 100


def test_what_is_commented_out_are_the_defaults(tmp_path: Path) -> None:
    file = tmp_path / "box.yaml"
    text = starter("box", "box.yaml")
    file.write_text(text, encoding="utf-8")
    plain = load_task(file)
    head, mark, rest = text.partition('# What follows with a "# "')
    lines = []
    for line in rest.splitlines()[1:]:
        if "## " in line:
            continue
        lines.append(line.removeprefix("# "))
    whole = head + "\n".join(lines)
    assert mark
    data = yaml.safe_load(whole)
    del data["tool"]  # of a tool alone
    file.write_text(yaml.safe_dump(data), encoding="utf-8")
    assert load_task(file) == plain


def test_a_file_that_is_there_is_kept(tmp_path: Path, refusal: Refusal) -> None:
    file = tmp_path / "box.yaml"
    file.write_text("mine", encoding="utf-8")
    assert "--force" in refusal("new", str(file))
    assert file.read_text(encoding="utf-8") == "mine"
    called("new", str(file), "--force")
    assert load_task(file).name == "box"
    assert "no folder" in refusal("new", str(tmp_path / "none" / "box.yaml"))


def test_a_name_that_is_no_name_is_mended(tmp_path: Path) -> None:
    file = tmp_path / "3 boxes.yaml"
    called("new", str(file))
    assert load_task(file).name == "task-3-boxes"


@pytest.mark.parametrize("name", ["post", "swap"])
def test_a_shipped_task_is_shown_as_it_is_written_or_in_full(
    name: str, tmp_path: Path, refusal: Refusal
) -> None:
    assert called("show", name) == shipped_tasks()[name].read_text(encoding="utf-8")
    file = tmp_path / "full.yaml"
    file.write_text(called("show", name, "--full"), encoding="utf-8")
    assert load_task(file) == load_task(name)
    assert "no such task" in refusal("show", "nothing-like-it")


def test_the_schema_is_printed() -> None:
    found = json.loads(called("schema"))
    assert set(SCHEMA.fields or {}) <= set(found["properties"])


def test_help_has_a_short_name() -> None:
    assert called("-h") == called("--help")
