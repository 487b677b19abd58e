"""Mean and standard error of values that arrive one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.identification.running_mean import RunningMean


def test_it_agrees_with_the_mean_of_all_values() -> None:
    values = np.random.default_rng(1).normal(3.0, 0.2, size=50)
    mean = RunningMean()
    for value in values.tolist():
        mean = mean.including(value)
    assert mean.samples == 50
    assert mean.mean == pytest.approx(float(values.mean()))
    assert mean.error == pytest.approx(float(values.std(ddof=1)) / math.sqrt(50))


def test_equal_values_have_no_error() -> None:
    mean = RunningMean().including(0.1).including(0.1).including(0.1)
    assert mean.error == pytest.approx(0.0, abs=1e-9)
