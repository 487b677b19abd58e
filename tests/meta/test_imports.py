"""Files import each other in one direction only, imports inside functions included."""

import ast
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = (ROOT / "src", ROOT / "studies" / "src")


class Imports(ast.NodeVisitor):
    """Collects every (module, name) that a file imports when it runs."""

    def __init__(self) -> None:
        self.pairs: set[tuple[str, str]] = set()

    def visit_If(self, node: ast.If) -> None:
        if ast.unparse(node.test).endswith("TYPE_CHECKING"):
            for statement in node.orelse:
                self.visit(statement)
            return
        self.generic_visit(node)

    def visit_Import(self, node: ast.Import) -> None:
        self.pairs |= {(alias.name, "") for alias in node.names}

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        assert node.level == 0, "imports are absolute"
        self.pairs |= {(node.module or "", alias.name) for alias in node.names}


def imports(text: str) -> set[tuple[str, str]]:
    """Return the (module, name) pairs that Python source imports."""
    visitor = Imports()
    visitor.visit(ast.parse(text))
    return visitor.pairs


def module_of(path: Path, source: Path) -> str:
    parts = path.relative_to(source).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def graph_of(*sources: Path) -> dict[str, set[str]]:
    """Return for each module below ``sources`` the modules there that it imports."""
    files = {
        module_of(path, source): path
        for source in sources
        for path in source.rglob("*.py")
    }
    graph: dict[str, set[str]] = {}
    for module, path in files.items():
        names = imports(path.read_text(encoding="utf-8"))
        targets = {
            f"{parent}.{name}" if f"{parent}.{name}" in files else parent
            for parent, name in names
        }
        graph[module] = targets & files.keys() - {module}
    return graph


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """Return one closed chain of imports; empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


@cache
def package_graph() -> dict[str, set[str]]:
    return graph_of(*SOURCES)


def test_no_file_imports_itself_through_others() -> None:
    assert cycle(package_graph()) == []


def test_the_graph_sees_the_package() -> None:
    graph = package_graph()
    assert "pushpressslide.report.series" in graph["pushpressslide.report.metrics"]
    assert "pushpressslide.jobs.run" in graph["pushpressslide.cli.commands"]


def test_the_core_does_not_import_the_studies() -> None:
    importers = {
        module.partition(".")[0]
        for module, targets in package_graph().items()
        if any(name.startswith("pushpressslide_studies") for name in targets)
    }
    assert importers == {"pushpressslide_studies"}


@pytest.mark.parametrize(
    "hidden",
    [
        "def f():\n    from p.a import f\n",
        "class C:\n    def m(self):\n        import p.a\n",
        "if True:\n    from p import a\n",
    ],
)
def test_a_circle_is_seen_wherever_the_import_hides(
    hidden: str, tmp_path: Path
) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "__init__.py").write_text("")
    (tmp_path / "p" / "a.py").write_text("from p.b import g\n")
    (tmp_path / "p" / "b.py").write_text(hidden)
    assert set(cycle(graph_of(tmp_path))) == {"p.a", "p.b"}


def test_imports_for_types_alone_close_no_circle(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("from b import g\n")
    (tmp_path / "b.py").write_text("if TYPE_CHECKING:\n    from a import f\n")
    assert cycle(graph_of(tmp_path)) == []
