"""The command and the package start fast, and nothing heavy is imported before it is used."""

import statistics
import subprocess
import sys
import time

import pytest

HEAVY = ("numpy", "scipy", "matplotlib", "shapely", "pydrake", "yaml")


def seconds(*args: str) -> float:
    """Return the median wall time of five fresh interpreters [s]."""
    times = []
    for _ in range(5):
        start = time.perf_counter()
        subprocess.run([sys.executable, *args], check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def loaded_after(code: str) -> set[str]:
    report = f"{code}\nimport sys; print(*sys.modules, sep='\\n')"
    out = subprocess.run([sys.executable, "-c", report], check=True, capture_output=True, text=True).stdout
    return {name.partition(".")[0] for name in out.splitlines()}


@pytest.mark.parametrize("code", ["import pushpressslide", "import pushpressslide.cli"])
def test_importing_loads_nothing_heavy(code: str) -> None:
    assert not loaded_after(code) & set(HEAVY)


def test_loading_a_task_does_not_load_the_physics_engine() -> None:
    code = "import pushpressslide as p; p.load_task('rear-push-rear')"
    assert not loaded_after(code) & {"pydrake", "matplotlib"}


def test_help_answers_within_three_tenths_of_a_second() -> None:
    assert (
        seconds("-c", "import sys; sys.argv = ['pps', '--help']; from pushpressslide.cli import main; main()")
        < 0.3
    )


def test_importing_the_package_takes_less_than_fifteen_hundredths_of_a_second() -> None:
    assert seconds("-c", "import pushpressslide") < 0.15
