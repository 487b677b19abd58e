"""The page on learning is true: its programs run, its ids are registered."""

import re
from pathlib import Path

import pytest

from pushpressslide.learning.registration import ENVIRONMENTS

PAGE = (Path(__file__).parents[2] / "docs" / "learning.md").read_text(encoding="utf-8")
PROGRAMS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_every_environment_is_in_the_page() -> None:
    for name, arguments in ENVIRONMENTS.items():
        assert f"| `{name}` | `{arguments['task']}` |" in PAGE


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_runs(program, capsys) -> None:
    pytest.importorskip("gymnasium", reason="gymnasium is not installed")
    exec(compile(program, "learning", "exec"), {})
    assert capsys.readouterr().out
