"""Every refusal and every bad ending of a run has its remedy in the documents."""

import ast
from collections import Counter
from pathlib import Path
from typing import Any, get_args

import yaml

from pushpressslide.core.record import ReasonCode
from pushpressslide.core.refusal import SKIPPED

ROOT = Path(__file__).parents[2]
TABLES = yaml.safe_load(
    (ROOT / "docs" / "troubleshooting.yaml").read_text(encoding="utf-8")
)
REFUSED = [row for rows in TABLES["refusals"].values() for row in rows]
ENDED = TABLES["endings"]


def codes_of(rows: list[dict[str, Any]]) -> set[str]:
    """Return the codes of some rows, each of which stands there once."""
    codes = Counter(code for row in rows for code in row["codes"])
    assert set(codes.values()) == {1}
    assert all(row["remedy"] for row in rows)
    return set(codes)


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
