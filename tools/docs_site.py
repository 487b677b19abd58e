"""Pages of the site that are made from other files, and links between them.

mkdocs calls the ``on_`` functions (mkdocs.yml, ``hooks``). The pages in docs/ and
studies/docs/ are read on a code host too, so they link to files of the repository; the
site has its own pages for those, and a link to one leads there. What is in studies/docs/
stands below studies/ on the site.
"""

from __future__ import annotations

import ast
import csv
import importlib
import os
import posixpath
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import yaml
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
IN_FULL = os.environ.get("SITE_IN_FULL") != "false"
"""Whether notebooks are run, and sources shown (mkdocs.yml)."""
PACKAGE = ROOT / "src" / "pushpressslide"
STUDIES = "studies/docs/"
READ = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "studies/README.md")
"""Pages of the repository outside docs/ and studies/docs/."""
ROOMS_NOT_SHOWN = ("cli", "sim", "tasks")
MOVED = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "LICENSE": "license.md",
    "CITATION.cff": "citation.md",
    "docs/task-fields.csv": "task-fields.md",
    "docs/troubleshooting.yaml": "troubleshooting.md",
    "examples": "examples/index.md",
    "studies/README.md": "studies/index.md",
    "studies/docs/data": "studies/data/index.md",
}
"""Files and folders of the repository, and their pages on the site."""

LINK = re.compile(r"\]\(([^)\s:]+?)(#[^)\s]*)?\)")


def program(path: Path) -> str:
    """Return a page that shows an example: its docstring, then all of it."""
    text = path.read_text(encoding="utf-8")
    title = path.stem[3:].replace("_", " ").capitalize().replace("python", "Python")
    about = ast.get_docstring(ast.parse(text)) or ""
    code = text.split('"""', 2)[2].strip()
    return f"# {path.stem[:2]} {title}\n\n{about}\n\n```python\n{code}\n```\n"


def notebook(path: Path) -> str:
    """Return a page that shows a notebook: its words, its code, and what that prints and
    draws when it is run.
    """
    cells = nbformat.read(path, as_version=4)
    if IN_FULL:
        nbclient.NotebookClient(cells, timeout=300, kernel_name="python3").execute()
    parts = []
    for cell in cells.cells:
        if cell.cell_type != "code":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        parts += filter(None, map(shown, cell.outputs))
    return "\n\n".join(parts) + f"\n\nThe notebook: `examples/{path.name}`.\n"


def shown(output: Any) -> str:
    """Return an output of a notebook as Markdown: a picture, or a text."""
    picture = output.get("data", {}).get("image/png")
    if picture is not None:
        source = f"data:image/png;base64,{picture.strip()}"
        return f'<img alt="What the code above draws" src="{source}">'
    text = output.get("text") or output.get("data", {}).get("text/plain", "")
    return f"```text\n{text.rstrip()}\n```" if text else ""


def title_of(text: str) -> str:
    """Return the heading of a page."""
    return text.partition("\n")[0].removeprefix("# ")


def examples() -> Iterator[tuple[str, str]]:
    """Yield name and text of the pages of the examples, their list last."""
    rows = []
    for path in sorted((ROOT / "examples").glob("[0-9]*")):
        if path.suffix not in (".py", ".ipynb"):
            continue
        text = program(path) if path.suffix == ".py" else notebook(path)
        name = f"{path.stem}.md"
        rows.append(f"- [{title_of(text)}]({name})")
        yield f"examples/{name}", text
    head = (
        "# Examples\n\nEach is a program or a notebook of its own, run by the tests.\n"
    )
    yield "examples/index.md", "\n".join([head, *rows, ""])


def data() -> tuple[str, str]:
    """Return name and text of the page that lists the files of studies/docs/data."""
    names = sorted(path.name for path in (ROOT / STUDIES / "data").iterdir())
    rows = [f"- [{name}]({name})" for name in names]
    head = "# Data of the tables\n\nRows as the commands wrote them, one JSON a line.\n"
    return "studies/data/index.md", "\n".join([head, *rows, ""])


def commands() -> tuple[str, str]:
    """Return name and text of the page of the command line, as typer writes it."""
    call = [sys.executable, "-m", "typer", "pushpressslide.cli", "utils", "docs"]
    text = subprocess.run(
        [*call, "--name", "pps", "--title", "Commands"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return "commands.md", text


def task_fields() -> tuple[str, str]:
    """Return name and text of the page of docs/task-fields.csv."""
    text = (ROOT / "docs" / "task-fields.csv").read_text(encoding="utf-8")
    titles, *rows = csv.reader(text.splitlines())
    lines = [titles, ["---"] * len(titles)]
    for name, words, default, meaning in rows:
        lines.append([f"`{name}`", words, f"`{default}`", meaning])
    table = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    about = (
        'Every field of a [task file](task-file.md). "or null": the field may also be'
    )
    about += " null, which is then its default.\n"
    return "task-fields.md", f"# Fields of a task file\n\n{about}\n{table}\n"


TROUBLESHOOTING = """# Troubleshooting

Every refusal is one line with the deciding number and its bound. The tables go by its
code, as `result.json` and a `Refusal` in Python have it.

## A package is missing

`engine drake: Drake is not installed` and the like name the extra that brings it:
`pip install 'pushpressslide[drake]'`. `reproduce`, `bench` and `gym-pusht` come with
`pip install pushpressslide-studies`. Without Drake `--engine planar` runs a task.

## A task file is refused at once

Exit status 2, and one line: file, field, value, what is allowed.

{files}

## Results cannot be written

Exit status 2.

{folders}

Ctrl-C, or a request to terminate, ends any command with status 130. What a run recorded
and the samples that a sweep finished are kept. The next command into the folder removes
what a killed process left half-written (`.NAME.PROCESS.part`).

## No mode can do the task

The line names the reason of one mode. `pps select TASK`, or `--verbose` of `pps run` and
`pps plan`, shows those of all; `--joints` also asks for the arms' joint paths. Begin with
the mode that ought to do it: `pps plan TASK --mode NAME`.

{refusals}

`pps run` may also refuse arms that come too near to each other, or an object that is
led beyond the support that is modelled: move the bases apart, or the goal nearer.

## A run does not reach its goal

Exit status 1. `reason` in `result.json` has the code, `events` what went wrong before;
[results](results.md#limits) has the limits. Look at that time in `replay.html`, and at
the contact forces in `report.html`.

{endings}

## A run takes long

Half of its time is Drake's physics, and a quarter of that goes into memory. With jemalloc
or mimalloc the same run, to the bit, is
[5 to 8 % faster](../studies/docs/benchmarks.md#memory):
`LD_PRELOAD=libjemalloc.so.2 pps run TASK`. `--engine planar` needs no arms and no contact
simulation. `planning_time` in `result.json` is the time of planning.
"""


def remedies(rows: list[dict[str, Any]]) -> str:
    """Return a table of codes, or of messages, with their remedies."""
    titles = list(rows[0])
    lines = [titles, ["---"] * len(titles)]
    for row in rows:
        values = dict(row)
        if "codes" in row:
            values["codes"] = ", ".join(f"`{code}`" for code in row["codes"])
        lines.append([values[title] for title in titles])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def troubleshooting() -> tuple[str, str]:
    """Return name and text of the page of docs/troubleshooting.yaml."""
    text = (ROOT / "docs" / "troubleshooting.yaml").read_text(encoding="utf-8")
    tables = yaml.safe_load(text)
    refusals = "\n\n".join(
        f"### {title}\n\n{remedies(rows)}" for title, rows in tables["refusals"].items()
    )
    page = TROUBLESHOOTING.format(
        refusals=refusals,
        endings=remedies(tables["endings"]),
        files=remedies(tables["files"]),
        folders=remedies(tables["folders"]),
    )
    return "troubleshooting.md", page


def modules(room: Path) -> Iterator[str]:
    """Yield the full names of the modules of a room that have words of their own."""
    for path in sorted(room.rglob("*.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        if not any(part.startswith("_") for part in parts):
            yield ".".join(parts)


def api() -> Iterator[tuple[str, str]]:
    """Yield name and text of the pages of the Python API: a room each, their list."""
    top = importlib.import_module("pushpressslide")
    rows = ["# Python API", "", "## Names of `pushpressslide`", ""]
    homes = {**vars(top)["_HOMES"], "report": "report.page.write_report"}
    for name, home in sorted(homes.items()):
        about = (getattr(top, name).__doc__ or "").partition("\n\n")[0]
        line = " ".join(about.split())
        rows.append(f"- [`{name}`][pushpressslide.{home}]: {line}")
    rows += ["", "## Rooms", ""]
    for room in sorted(path for path in PACKAGE.iterdir() if path.is_dir()):
        names = list(modules(room))
        if room.name in ROOMS_NOT_SHOWN or not names:
            continue
        about = ast.get_docstring(ast.parse((room / "__init__.py").read_text("utf-8")))
        line = " ".join((about or "").partition("\n\n")[0].split())
        rows.append(f"- [`{room.name}`]({room.name}.md): {line}")
        blocks = [f"::: {name}\n" for name in names]
        yield (
            f"api/{room.name}.md",
            "\n".join([f"# {room.name}\n", about or "", "", *blocks]),
        )
    yield "api/index.md", "\n".join([*rows, ""])


LISTS = ("examples/index.md", "api/index.md")
"""Pages that list others of their folder."""


def made() -> Iterator[tuple[str, str]]:
    """Yield name and text of every page that is not in docs/."""
    for name in READ:
        yield MOVED[name], (ROOT / name).read_text(encoding="utf-8")
    for name, title in (("LICENSE", "Licence"), ("CITATION.cff", "To cite")):
        text = (ROOT / name).read_text(encoding="utf-8")
        yield MOVED[name], f"# {title}\n\n```text\n{text}```\n"
    yield from examples()
    yield from api()
    yield data()
    yield commands()
    yield task_fields()
    yield troubleshooting()


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the studies' pages and those that are made, and list those of a folder below
    its head.
    """
    for path in sorted((ROOT / STUDIES).rglob("*.*")):
        name = f"studies/{path.relative_to(ROOT / STUDIES).as_posix()}"
        files.append(File.generated(config, name, abs_src_path=str(path)))
    folders: dict[str, list[str]] = {}
    for name, text in made():
        files.append(File.generated(config, name, content=text))
        folders.setdefault(posixpath.dirname(name), []).append(name)
    for section in config.nav or ():
        for entry in next(iter(section.values())):
            for title, page in entry.items() if isinstance(entry, dict) else ():
                if page in LISTS:
                    below = sorted({*folders[posixpath.dirname(page)]} - {page})
                    entry[title] = [page, *below]
    return files


def home_of(page: str) -> str:
    """Return the path in the repository of a page of the site."""
    if page.startswith("examples/"):
        return page
    if page.startswith("studies/"):
        return page.replace("studies/", STUDIES, 1)
    return f"docs/{page}"


def place_on_the_site(target: str, page: str) -> str:
    """Return where a link ``target`` of the file behind ``page`` leads on the site.

    Both are paths; ``page`` is that of the site.
    """
    homes = {MOVED[name]: name for name in READ}
    home = homes.get(page) or home_of(page)
    full = posixpath.normpath(posixpath.join(posixpath.dirname(home), target))
    there = MOVED.get(full, full)
    if there.startswith("examples/"):
        there = re.sub(r"\.(py|ipynb)$", ".md", there)
    there = re.sub(r"^(studies/)?docs/", r"\1", there)
    return posixpath.relpath(there, posixpath.dirname(page) or ".")


def on_page_markdown(
    markdown: str, *, page: Page, config: MkDocsConfig, files: Files
) -> str:
    """Lead the links of a page to the pages of the site."""
    name = page.file.src_uri
    if name.startswith(("api/", "studies/data/")) or name == "commands.md":
        return markdown

    def moved(match: re.Match[str]) -> str:
        target, anchor = match.group(1), match.group(2) or ""
        return f"]({place_on_the_site(target, name)}{anchor})"

    return LINK.sub(moved, markdown)
