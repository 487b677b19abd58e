"""A command may take its options as one dataclass; the command line does not show it."""

import sys
from dataclasses import dataclass, fields
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from pushpressslide.cli import app, commands, identify, sweep
from pushpressslide.cli.app import command


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("run", commands.RunOptions),
        ("sweep", sweep.SweepOptions),
        ("identify", identify.IdentifyOptions),
    ],
)
def test_the_parameters_of_a_command_are_the_fields_in_their_order(
    name: str, options: type
) -> None:
    parameters = typer.main.get_command(app).commands[name].params
    assert [p.name for p in parameters] == [f.name for f in fields(options)]


@dataclass(frozen=True)
class Options:
    """Options of the command below."""

    name: str
    times: Annotated[int, typer.Option("--times", min=1, help="How often.")] = 2


def test_values_and_defaults_arrive_and_the_status_returns(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    alone = typer.Typer()
    monkeypatch.setattr(sys.modules[command.__module__], "app", alone)
    seen = []

    @command
    def greet(options: Options) -> int:
        """Greet."""
        seen.append(options)
        return 7

    call = typer.main.get_command(alone)
    assert call.main(["you"], standalone_mode=False) == 7
    assert call.main(["you", "--times", "3"], standalone_mode=False) == 7
    assert seen == [Options("you"), Options("you", 3)]
    assert greet(Options("me")) == 7
    assert "Greet." in CliRunner().invoke(alone, ["--help"]).stdout
    assert CliRunner().invoke(alone, ["you", "--times", "0"]).exit_code == 2
