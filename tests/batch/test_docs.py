"""The examples of the page on batches run."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "batches.md"


def test_the_examples_run(engine, capsys):
    text = PAGE.read_text(encoding="utf-8")
    assert "(2, 1000, 2, 2)" in text
    count = "1000"
    if engine == "python":  # row by row
        count = "10"
        text = text.replace("1000", count)
    names = {}
    for example in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(compile(example, PAGE.name, "exec"), names)
    assert f"(2, {count}, 2, 2)" in capsys.readouterr().out
