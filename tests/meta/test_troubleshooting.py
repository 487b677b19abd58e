"""Every refusal and every bad ending of a run has its remedy in the documents."""

import ast
import re
from pathlib import Path
from typing import get_args

from pushpressslide.core.record import ReasonCode
from pushpressslide.core.refusal import SKIPPED

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
REFUSED, ENDED = PAGE.split("## A run does not reach its goal")


def codes_of(text: str) -> set[str]:
    """Return the codes in the first cells of the tables of a page."""
    cells = re.findall(r"^\| (`[a-z_]+`(?:, `[a-z_]+`)*) \|", text, re.MULTILINE)
    return {code for cell in cells for code in re.findall(r"[a-z_]+", cell)}


def refused() -> set[str]:
    """Return the codes that the package makes refusals with."""
    codes = {SKIPPED}
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                place = {"Refusal": 0, "refusal_of": 1}.get(ast.unparse(node.func))
                code = None if place is None or not node.args else node.args[place]
                if isinstance(code, ast.Constant):
                    codes.add(code.value)
    return codes


def test_every_refusal_has_its_remedy() -> None:
    assert codes_of(REFUSED) == refused()


def test_every_ending_but_success_has_its_remedy() -> None:
    assert codes_of(ENDED) == set(get_args(ReasonCode)) - {"goal_reached"}
