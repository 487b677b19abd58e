"""Plans of shipped tasks shared by several files; each is made once."""

from collections.abc import Callable
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Plan


@cache
def plan_of(name: str) -> Plan:
    return pps.plan(pps.load_task(name))


@pytest.fixture(scope="session")
def shipped_plan() -> Callable[[str], Plan]:
    """Return a function: the plan of a shipped task as it is."""
    return plan_of
