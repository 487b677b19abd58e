"""The documents are true: links, functions, tests, commands, fields, examples."""

import re
import tomllib
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

import pushpressslide
from pushpressslide.cli import app
from pushpressslide.cli.installed import PACKAGES
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Motion
from pushpressslide.modes import MODES
from pushpressslide.taskfile.load import task_from_data

ROOT = Path(__file__).parents[2]
STUDIES = ROOT / "studies"
DOCS = sorted([*(ROOT / "docs").glob("*.md"), *(STUDIES / "docs").glob("*.md")])
HEADS = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "studies/README.md")
PAGES = [
    *(ROOT / name for name in HEADS),
    *DOCS,
    ROOT / "docs" / "troubleshooting.yaml",
]
README = (ROOT / "README.md").read_text(encoding="utf-8")
every_page = pytest.mark.parametrize(
    "page", PAGES, ids=[str(p.relative_to(ROOT)) for p in PAGES]
)


@every_page
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if not target.startswith(("http://", "https://", "#")):
            assert (page.parent / target.split("#")[0]).exists(), target


@every_page
def test_no_page_names_a_place_on_somebodys_machine(page: Path) -> None:
    assert not re.search(
        r"(/home/|/work/|/Users/|/tmp/)", page.read_text(encoding="utf-8")
    )


def test_every_page_of_docs_is_linked_from_another() -> None:
    words = {page: page.read_text(encoding="utf-8") for page in PAGES}
    for page in DOCS:
        assert any(
            f"{page.name})" in text for other, text in words.items() if other != page
        ), page.name


def commands() -> set[str]:
    return set(typer.main.get_command(app).commands) | {*PACKAGES}


def test_every_command_of_the_readme_exists_and_every_command_is_there() -> None:
    named = set(re.findall(r"\bpps ([a-z][a-z-]*)", README))
    assert named == commands()


@every_page
def test_every_command_of_the_documents_exists(page: Path) -> None:
    assert (
        set(
            re.findall(
                r"(?:`|/|    )pps ([a-z][a-z-]*)", page.read_text(encoding="utf-8")
            )
        )
        <= commands()
    )


def test_every_target_of_make_in_the_documents_exists() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for page in PAGES:
        for target in re.findall(
            r"(?:`|    )make ([a-z-]+)", page.read_text(encoding="utf-8")
        ):
            assert re.search(rf"^{target}:", makefile, re.MULTILINE), (
                f"{page.name}: make {target}"
            )


def test_every_field_of_a_motion_is_documented() -> None:
    table = (ROOT / "docs" / "task-fields.csv").read_text(encoding="utf-8")
    for field in fields(Motion):
        assert f"\nmotion.{field.name}," in table


@every_page
def test_every_field_of_a_motion_that_is_named_exists(page: Path) -> None:
    names = {field.name for field in fields(Motion)}
    assert (
        set(re.findall(r"`motion\.([a-z_]+)", page.read_text(encoding="utf-8")))
        <= names
    )


def test_the_readmes_task_loads() -> None:
    example = README.split("```yaml\n")[1].split("```")[0]
    assert task_from_data(yaml.safe_load(example), "README").name == "my-push"


def test_the_readmes_python_runs() -> None:
    exec(compile(README.split("```python\n")[1].split("```")[0], "README", "exec"), {})


def test_every_mode_is_in_the_page_on_choosing_one() -> None:
    page = (ROOT / "docs" / "modes.md").read_text(encoding="utf-8")
    for name in MODES:
        assert f"| `{name}` |" in page


def test_the_mechanics_keep_their_section_numbers() -> None:
    page = (ROOT / "docs" / "mechanics.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\d+)\.", page, re.MULTILINE) == [str(i) for i in range(13)]


@pytest.mark.parametrize(
    "path",
    sorted([*(ROOT / "src").rglob("*.py"), *STUDIES.rglob("*.py")]),
    ids=lambda p: p.stem,
)
def test_documents_that_the_code_cites_exist(path: Path) -> None:
    cited = r"\b((?:studies/)?docs/[a-z-]+\.md)"
    for name in re.findall(cited, path.read_text(encoding="utf-8")):
        assert (ROOT / name).exists(), name


def test_the_example_of_adding_a_mode_reaches_its_goal(monkeypatch) -> None:
    page = (ROOT / "docs" / "python-api.md").read_text(encoding="utf-8")
    page = page.split("\n## Adding a mode\n")[1]
    names: dict[str, Any] = {"__name__": "center_push"}
    example = page.split("```python\n")[1].split("```")[0]
    exec(compile(example, "adding a mode", "exec"), names)
    mode = names["MODE"]
    monkeypatch.setitem(MODES, mode.name, mode)
    task = replace(
        pushpressslide.load_task("rear-push-rear"),
        modes=(mode.name,),
        start=Pose2(0.36, 0.1, 0.0),
        goal=Pose2(0.68, 0.105, 0.0),
    )
    best, *others = pushpressslide.select(task)
    assert best.feasible
    assert {choice.refusal.code for choice in others} == {"detour"}
    record = pushpressslide.run(pushpressslide.plan(task, best), engine="planar")
    assert record.reason == "goal_reached"


def test_the_paper_is_named_with_its_authors() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    (paper,) = citation["references"]
    assert paper["title"] in " ".join(README.split())
    for author in paper["authors"]:
        assert f"{author['given-names']} {author['family-names']}" in README


def test_the_citation_agrees_with_the_project() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    named = project["project"]
    assert citation["title"] == named["name"]
    assert citation["version"] == named["version"]
    assert citation["license"] == named["license"]
    assert citation["authors"] == named["authors"]
