"""The documents build as a site without broken links or network resources."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOADED = re.compile(
    r"<(?:script|link|img|source|iframe)\b[^>]*?(?:src|href)=\"?([^\" >]+)"
)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("material", reason="mkdocs-material is not installed")
    pytest.importorskip("mkdocstrings_handlers.python", reason="mkdocstrings-python")
    out = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(out)],
        cwd=ROOT,
        # sources have no links, and take longer than all pages; the notebooks are run
        # in test_notebooks.py
        env={**os.environ, "NO_COLOR": "1", "SITE_IN_FULL": "false"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return out


def test_every_page_of_the_documents_is_on_the_site(site: Path) -> None:
    for page in (ROOT / "docs").glob("*.md"):
        assert (site / f"{page.stem}.html").is_file(), page.name
    for page in (ROOT / "studies" / "docs").glob("*.md"):
        assert (site / "studies" / f"{page.stem}.html").is_file(), page.name


def test_every_example_is_on_the_site(site: Path) -> None:
    for path in (ROOT / "examples").glob("[0-9]*"):
        assert (site / "examples" / f"{path.stem}.html").is_file(), path.name


def test_no_page_loads_anything_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert pages
    for page in pages:
        loaded = LOADED.findall(page.read_text(encoding="utf-8"))
        assert loaded, page.name
        assert not [name for name in loaded if name.startswith(("http", "//"))], (
            page.name
        )


def test_every_formula_of_the_mechanics_is_marked_as_one(site: Path) -> None:
    text = (site / "mechanics.html").read_text(encoding="utf-8")
    assert text.count('class="arithmatex"') > 100
    assert "$" not in re.sub(r"<(script|style|code)\b.*?</\1>", "", text, flags=re.S)
