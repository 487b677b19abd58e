"""Runs on Drake shared by several files; each is made once."""

from collections.abc import Callable
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.jobs.run import simulate


@cache
def run_of(name: str) -> tuple[Plan, Record]:
    plan, record, _ = simulate(pps.load_task(name), engine="drake")
    return plan, record


@pytest.fixture(scope="session")
def shipped_run() -> Callable[[str], tuple[Plan, Record]]:
    """Return a function: plan and record of a shipped task, run as it is."""
    return run_of
