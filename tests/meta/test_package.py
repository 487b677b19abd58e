"""Rules about the package itself."""

import ast
import pydoc
import re
from dataclasses import fields
from functools import cache
from pathlib import Path

import pytest

import pushpressslide
from pushpressslide.core.task import Limits, Motion, Robot, Sensing, Support, Tolerance
from pushpressslide.modes import MODES

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "pushpressslide"
STUDIES = ROOT / "studies" / "src" / "pushpressslide_studies"
FILES = sorted([*SOURCE.rglob("*.py"), *STUDIES.rglob("*.py")])


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(text_of(path))


def imported(path: Path) -> set[str]:
    """Return the full names of all modules and names that a file imports."""
    names = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {
                f"{node.module}.{alias.name}" for alias in node.names
            }
    return names


def place_of(path: Path) -> Path:
    """Path of a file inside its package."""
    return path.relative_to(STUDIES if path.is_relative_to(STUDIES) else SOURCE)


every_file = pytest.mark.parametrize(
    "path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES]
)


@every_file
def test_a_file_keeps_the_rules(path: Path) -> None:
    place = place_of(path)
    names = imported(path)
    assert "pydrake.all" not in names
    assert "pydrake" not in names, "import concrete modules of pydrake"
    with_drake = place.parts[0] == "sim" or place.parts[:2] == ("view", "drake")
    assert with_drake or not any(name.startswith("pydrake") for name in names)
    assert "utils" not in path.stem
    assert not re.search(r"\b(TODO|FIXME|XXX)\b", text_of(path))
    assert ast.get_docstring(tree_of(path)), "say what the file is"


@every_file
def test_only_the_command_line_prints(path: Path) -> None:
    if place_of(path).parts[0] == "cli":
        return
    called = [
        node.func for node in ast.walk(tree_of(path)) if isinstance(node, ast.Call)
    ]
    assert not any(isinstance(func, ast.Name) and func.id == "print" for func in called)


@every_file
def test_no_default_is_mutable(path: Path) -> None:
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.FunctionDef | ast.Lambda):
            defaults = [
                *node.args.defaults,
                *(d for d in node.args.kw_defaults if d is not None),
            ]
            assert not any(
                isinstance(d, ast.List | ast.Dict | ast.Set) for d in defaults
            )


@every_file
def test_no_time_is_taken_by_a_clock_that_can_be_set(path: Path) -> None:
    names = imported(path)
    named = {
        node.attr for node in ast.walk(tree_of(path)) if isinstance(node, ast.Attribute)
    }
    assert "time.time" not in names
    if "time" in names:
        assert not named & {"time_ns", "localtime", "gmtime"}
        assert "time.time(" not in text_of(path)
    # a date in the name of a folder decides nothing: one that is taken gets a number
    dated = any(name.startswith("datetime") for name in names)
    assert not dated or path == SOURCE / "cli" / "folders.py"


def test_no_mode_knows_another() -> None:
    for path in (SOURCE / "modes").glob("*.py"):
        if path.stem in ("__init__", "base"):
            continue
        others = {f"pushpressslide.modes.{name}" for name in MODES if name != path.stem}
        assert not imported(path) & others


def test_every_file_of_a_mode_is_a_mode_of_its_name() -> None:
    assert {p.stem for p in (SOURCE / "modes").glob("*.py")} - {
        "__init__",
        "base",
    } == set(MODES)


def test_everything_that_is_offered_at_the_top_is_there() -> None:
    for name in pushpressslide.__all__:
        assert getattr(pushpressslide, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = pushpressslide.nothing


def test_the_help_of_the_package_begins_with_every_name_in_its_place() -> None:
    text = pushpressslide.__doc__ or ""
    overview = text.partition("From a file and back")[2]
    named = re.findall(r"[A-Za-z_]\w*", overview)
    missing = {*pushpressslide.__all__} - {"__version__"} - {*named}
    assert not missing
    manual = pydoc.plaintext.document(pushpressslide)
    first = manual.index("From a file and back")
    assert manual[:first].count("\n") < 20


def test_importing_pydrake_all_is_nowhere_in_tests_either() -> None:
    for folder in ("tests", "studies/tests"):
        for path in (ROOT / folder).rglob("*.py"):
            assert "pydrake.all" not in imported(path)


@pytest.mark.parametrize("section", [Motion, Limits, Sensing, Tolerance, Support])
def test_the_defaults_of_task_files_are_those_of_the_data(section: type) -> None:
    task = pushpressslide.load_task(
        "rear-push-rear",
        ["motion={}", "limits={}", "sensing={}", "tolerance={}", "support={}"],
    )
    loaded = getattr(task, section.__name__.lower())
    for field in fields(section):
        assert getattr(loaded, field.name) == getattr(section(), field.name), field.name


def test_the_defaults_of_a_robot_are_those_of_the_data() -> None:
    (robot,) = pushpressslide.load_task(
        "rear-push-rear", ["robots=[{model: panda}]"]
    ).robots
    assert robot == Robot("panda", (0.0, 0.0, 0.0))


KINDS = {"Box", "Prism", "Cylinder"}
MAY_ASK_FOR_THE_KIND = {
    "sim/surfaces.py": "Drake's geometry has a class a kind",
    "sim/scenes.py": "Drake's inertia and mesh sizes have a formula a kind",
    "paper/virtual_axle.py": "the paper's object is a box of another height",
    "geometry/inertia.py": "moments of inertia have a formula a kind",
    "mujoco_sim/shapes.py": "MuJoCo's geometry has a type a kind",
}


@every_file
def test_a_shape_is_asked_and_not_inspected(path: Path) -> None:
    place = place_of(path).as_posix()
    asked = [
        node
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "isinstance"
        and KINDS
        & {part.strip() for part in re.split(r"\W", ast.unparse(node.args[1]))}
    ]
    assert bool(asked) == (place in MAY_ASK_FOR_THE_KIND), (
        f"{place}: geometry/shapes.py"
    )


def test_the_package_says_that_it_is_typed() -> None:
    assert (SOURCE / "py.typed").is_file()
    assert (STUDIES / "py.typed").is_file()
