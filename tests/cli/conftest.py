"""Checks of a refusal by the command, shared by all tests of it."""

from collections.abc import Callable

import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app


@pytest.fixture(scope="session")
def refusal() -> Callable[..., str]:
    """Return a function that runs ``pps`` in this process and returns the one line that
    it refused with.
    """

    def run(*args: str) -> str:
        result = CliRunner().invoke(app, list(args))
        assert result.exit_code == 2, (result.stdout, result.stderr)
        assert result.stdout == ""
        lines = result.stderr.splitlines()
        assert len(lines) == 1, result.stderr
        assert "Traceback" not in result.stderr
        assert len(lines[0]) < 700
        return lines[0]

    return run
