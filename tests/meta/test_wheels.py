"""Contents of the wheels: the core without the studies, and the studies beside it."""

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from pushpressslide.cli.installed import GROUP, PACKAGES, STUDIES

ROOT = Path(__file__).parents[2]
FOLDERS = {"pushpressslide": ROOT, STUDIES: ROOT / "studies"}


def project(name: str) -> dict:
    text = (FOLDERS[name] / "pyproject.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["project"]


@pytest.mark.parametrize("name", FOLDERS)
def test_a_wheel_holds_its_own_package_and_nothing_else(
    name: str, tmp_path: Path
) -> None:
    pytest.importorskip("hatch_fancy_pypi_readme", reason="it is not installed")
    build = (sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", tmp_path)
    subprocess.run(build, check=True, cwd=FOLDERS[name], capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    package = name.replace("-", "_")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    tops = {name.partition("/")[0] for name in names}
    assert tops == {package, f"{package}-{project(name)['version']}.dist-info"}
    assert f"{package}/py.typed" in names
    assert not [name for name in names if name.startswith("pushpressslide/studies/")]


def test_both_packages_have_the_same_version() -> None:
    core = project("pushpressslide")
    studies = project(STUDIES)
    assert studies["name"] == STUDIES
    assert studies["version"] == core["version"]
    assert f"pushpressslide=={core['version']}" in studies["dependencies"]
    for same in ("license", "requires-python", "authors"):
        assert studies[same] == core[same]
    licence = (ROOT / "LICENSE").read_bytes()
    assert (ROOT / "studies" / "LICENSE").read_bytes() == licence


def test_the_core_knows_the_commands_that_the_studies_bring() -> None:
    assert set(project(STUDIES)["entry-points"][GROUP]) == set(PACKAGES)


def test_the_development_environment_has_what_the_studies_need() -> None:
    developed = project("pushpressslide")["optional-dependencies"]["dev"]
    core = project("pushpressslide")["dependencies"]
    needed = project(STUDIES)["dependencies"]
    own = f"pushpressslide=={project(STUDIES)['version']}"
    assert {*needed} - {own} <= {*core} | {*developed}
