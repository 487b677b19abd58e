"""Settings of the whole suite."""

from importlib.util import find_spec

import pytest
from hypothesis import settings

WITH_DRAKE = ("drake", "report/test_replay.py")
"""Files that import Drake at their top; without it they are left out."""

collect_ignore = list(WITH_DRAKE) if find_spec("pydrake") is None else []


@pytest.fixture(scope="session")
def task_of_mode() -> dict[str, str]:
    """Return a shipped task for each mode."""
    return {
        "rear_push": "rear-push-rear",
        "press_slide": "press-slide",
        "parallel_push": "parallel-push",
        "orthogonal_push": "orthogonal-push",
        "bimanual_press_slide": "bimanual-slide",
        "press_and_push": "pivot",
    }


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what is left out."""
    if collect_ignore:
        left_out = ", ".join(collect_ignore)
        terminalreporter.write_line(f"Drake is not installed; left out: {left_out}")


# No test asserts wall time: a deadline of an example would be one, red on a busy
# machine. The examples are the same every time, so that a change is red for what it
# changed; ``pytest --hypothesis-profile=search`` draws others.
settings.register_profile(
    "pushpressslide", deadline=None, print_blob=True, derandomize=True
)
settings.register_profile(
    "search", deadline=None, print_blob=True, derandomize=False, max_examples=500
)
settings.load_profile("pushpressslide")
