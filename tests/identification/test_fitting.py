"""Errors of directions left out of a fit, from the fit alone."""

import numpy as np
import pytest

from pushpressslide.identification.fitting import fitted


def test_for_a_linear_model_they_are_those_of_a_fit_to_the_others() -> None:
    generator = np.random.default_rng(0)
    n = 12
    matrix = generator.normal(size=(n, 3, 4))
    measured = generator.normal(size=(n, 3))
    found = fitted(lambda c: matrix @ c, measured, np.zeros(4), 0.7)
    for i, chord in enumerate(found.left_out()):
        others = np.delete(np.arange(n), i)
        again = fitted(
            lambda c, rows=others: matrix[rows] @ c, measured[others], np.zeros(4), 0.7
        )
        missed = np.linalg.norm(matrix[i] @ again.parameters - measured[i])
        assert chord == pytest.approx(missed, rel=1e-4)
