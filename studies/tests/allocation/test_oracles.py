"""The allocators against independent solvers: DAQP, Clarabel, SciPy's NNLS."""

import pytest

from pushpressslide_studies.bench import agreement

few_and_many = pytest.mark.parametrize(
    "cases", [400, pytest.param(10_000, marks=pytest.mark.long)]
)


@few_and_many
@pytest.mark.parametrize("split", ["least_friction", "least_force"])
def test_pushes_agree_with_daqp(cases, split):
    found = agreement.pushes(cases, 0, split)
    assert found["flag_differs"] == 0
    assert found["near_boundary"] <= 1e-3 * cases
    assert 0.4 * cases < found["feasible"] < 0.8 * cases
    assert found["wrench"] < 1e-9
    assert found["cone"] < 1e-9
    assert found["shear"] < 1e-6
    assert found["forces"] < 1e-6
    assert found["moved_further"] < 1e-9


@few_and_many
def test_presses_agree_with_clarabel(cases):
    found = agreement.presses(cases, 0)
    assert found["unsolved"] == 0
    assert found["flag_differs"] == 0
    assert found["near_boundary"] <= 1e-3 * cases
    assert 0.2 * cases < found["feasible"] < 0.8 * cases
    assert found["wrench"] < 1e-9
    assert found["disc"] < 1e-9
    assert found["shear"] < 1e-6
    for figure in ("scale", "press_in_ratio", "least_press"):
        assert found[figure] < 1e-6
