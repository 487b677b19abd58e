"""Words that the glossary calls gone stay out of names, messages and pages."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GLOSSARY = ROOT / "docs" / "mechanics.md"
SOURCES = sorted(
    file for room in ("src", "studies/src") for file in (ROOT / room).rglob("*.py")
)
PAGES = [
    *(ROOT / "docs").glob("*.md"),
    *(ROOT / "docs").glob("*.yaml"),
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
]
# public names and fields of files, which stay
KEPT = {
    ("batch/dubins.py", "starts"),
    ("control/run_loop.py", "begin"),  # RunOptions.begin
    ("core/knock.py", "moved"),  # of the task file
    ("control/knocker.py", "moved"),  # of result.json
}


def gone() -> tuple[list[str], set[str]]:
    """The glossary's phrases and names in code."""
    text = GLOSSARY.read_text(encoding="utf-8")
    block = (
        text.split("### Words that are gone")[1].split("```text\n")[1].split("```")[0]
    )
    phrases, names = block.strip().split("\n\n")
    first = [re.split(r"  +", line)[0] for line in phrases.splitlines()[1:]]
    second = [re.split(r"  +", line)[0] for line in names.splitlines()[1:]]
    return first, {name for line in second for name in line.split(", ")}


def names_of(tree: ast.AST) -> Iterator[str]:
    """Names of functions, classes, fields and parameters."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        if isinstance(node, ast.ClassDef):
            for part in node.body:
                if isinstance(part, ast.AnnAssign) and isinstance(
                    part.target, ast.Name
                ):
                    yield part.target.id
        elif isinstance(node, ast.arg):
            yield node.arg


@pytest.mark.parametrize(
    "file", SOURCES, ids=[str(f.relative_to(ROOT)) for f in SOURCES]
)
def test_no_name_or_text_of_the_code_is_a_word_that_is_gone(file: Path) -> None:
    phrases, names = gone()
    tree = ast.parse(file.read_text(encoding="utf-8"))
    place = "/".join(file.parts[-2:])
    used = {name for name in names_of(tree) if name.strip("_").lower() in names}
    assert not {name for name in used if (place, name) not in KEPT}
    texts = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    assert not [text for text in texts if said(text, phrases)]


@pytest.mark.parametrize("page", PAGES, ids=[str(p.relative_to(ROOT)) for p in PAGES])
def test_no_page_has_a_phrase_that_is_gone(page: Path) -> None:
    phrases, _ = gone()
    text = page.read_text(encoding="utf-8")
    if page == GLOSSARY:
        text = text.split("### Words that are gone")[0]
    assert not said(text, phrases)


def said(text: str, phrases: list[str]) -> list[str]:
    """The phrases in a text; names in backticks or quotes, as of arrays, may stay."""
    plain = re.sub(r"``[^`]*``|`[^`]*`", "", " ".join(text.split()))
    return [
        phrase
        for phrase in phrases
        if re.search(rf"(?<![\w_])(?:{phrase}(?:e?s)?)(?![\w_])", plain, re.IGNORECASE)
        and " " in plain
    ]
