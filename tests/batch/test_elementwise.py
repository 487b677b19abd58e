"""One formula on tables, columns and single numbers: however the numbers
lie in memory, a compiled loop and NumPy give what the formula gives row by row.
"""

from typing import NamedTuple

import numpy as np
import pytest

from pushpressslide.batch.elementwise import Table, run
from pushpressslide.core.formulas import Column, where


class Point(NamedTuple):
    x: Column
    y: Column


class Rates(NamedTuple):
    low: Column
    high: Column
    slope: Column


def placed(point, rates):
    """Return a number, and the status of the row."""
    held = point.x > rates.low
    return rates.slope * point.x + point.y, where(held, 0, 3), point.y


def columns(lie, n):
    """Return three columns that lie in memory so."""
    rng = np.random.default_rng(n)
    if lie == "with gaps":
        return rng.normal(size=(n, 3)).T
    if lie == "repeated":
        return [np.broadcast_to(value, n) for value in rng.normal(size=3)]
    if lie == "numbers":
        return [np.asarray(value) for value in rng.normal(size=3)]
    if lie == "mixed":
        numbers, pieces = rng.normal(size=3), rng.normal(size=(3, n))
        return [np.asarray(numbers[0]), pieces[1], np.broadcast_to(numbers[2], n)]
    return rng.normal(size=(3, n))


@pytest.mark.parametrize("n", [0, 1, 2, 63, 64, 65, 1000])
@pytest.mark.parametrize(
    "lie", ["in one piece", "with gaps", "repeated", "numbers", "mixed"]
)
def test_a_formula_is_run_on_each_row(engine, lie, n):
    points = np.random.default_rng(1).normal(size=(n, 2))
    rates = Rates(*columns(lie, n))
    out = np.full((2, n), np.nan)
    statuses = np.empty(n, dtype=np.int8)
    run(placed, (Table(Point, points), rates), (out[0], statuses, out[1]))
    low, _, slope = (np.broadcast_to(column, n) for column in rates)
    np.testing.assert_allclose(out[0], slope * points[:, 0] + points[:, 1], rtol=1e-14)
    np.testing.assert_array_equal(statuses, np.where(points[:, 0] > low, 0, 3))
    np.testing.assert_array_equal(out[1], points[:, 1])


def test_columns_of_one_array_are_filled_one_after_the_other(engine):
    points = np.random.default_rng(2).normal(size=(200, 2))
    rates = Rates(*columns("in one piece", 200))
    out = np.empty((3, 200))
    run(placed, (Table(Point, points), rates), (out,))
    assert set(out[1]) == {0.0, 3.0}
