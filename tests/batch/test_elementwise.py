"""One formula on tables, columns and single numbers, with stages: however the numbers
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


def doubled(point, rates):
    held = point.y > rates.high
    return 2.0 * point.x, where(held, 1, 4), rates.low


def negated(point, rates):
    return -point.x, 2, rates.high


STAGES = ((3, doubled), (4, negated))


def row_by_row(points, rates):
    out = []
    for point, rate in zip(points, rates, strict=True):
        answer = placed(Point(*point), Rates(*rate))
        for status, formula in STAGES:
            if answer[1] == status:
                answer = formula(Point(*point), Rates(*rate))
        out.append(answer)
    return np.array(out, dtype=float).reshape(-1, 3)


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
def test_stages_take_the_rows_that_are_left(engine, lie, n):
    points = np.random.default_rng(1).normal(size=(n, 2))
    rates = Rates(*columns(lie, n))
    out = np.full((2, n), np.nan)
    statuses = np.empty(n, dtype=np.int8)
    run(
        placed,
        (Table(Point, points), rates),
        (out[0], statuses, out[1]),
        STAGES,
        status=1,
    )
    rows = np.stack([np.broadcast_to(c, n) for c in rates], axis=1)
    right = row_by_row(points, rows)
    assert set(statuses) <= {0, 1, 2}
    np.testing.assert_allclose(out[0], right[:, 0], rtol=1e-15)
    np.testing.assert_array_equal(statuses, right[:, 1])
    np.testing.assert_allclose(out[1], right[:, 2], rtol=1e-15)


def test_without_stages_a_status_is_a_number_like_others(engine):
    points = np.random.default_rng(2).normal(size=(200, 2))
    rates = Rates(*columns("in one piece", 200))
    out = np.empty((3, 200))
    run(placed, (Table(Point, points), rates), (out,))
    assert set(out[1]) == {0.0, 3.0}
