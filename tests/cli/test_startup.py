"""Nothing heavy is imported before it is used; how long a start takes is for the
benchmarks.
"""

import subprocess
import sys

import pytest

HEAVY = ("numpy", "scipy", "matplotlib", "shapely", "pydrake", "yaml")


def loaded_after(code: str) -> set[str]:
    report = f"{code}\nimport sys; print(*sys.modules, sep='\\n')"
    out = subprocess.run(
        [sys.executable, "-c", report], check=True, capture_output=True, text=True
    ).stdout
    return {name.partition(".")[0] for name in out.splitlines()}


HELP = """
import sys
from pushpressslide.cli import main
sys.argv = ["pps", "--help"]
try:
    main()
except SystemExit as stop:
    assert stop.code in (None, 0)
"""


@pytest.mark.parametrize(
    "code", ["import pushpressslide", "import pushpressslide.cli", HELP]
)
def test_importing_loads_nothing_heavy(code: str) -> None:
    assert not loaded_after(code) & set(HEAVY)


def test_loading_a_task_does_not_load_the_physics_engine() -> None:
    code = "import pushpressslide as p; p.load_task('rear-push-rear')"
    assert not loaded_after(code) & {"pydrake", "matplotlib"}
