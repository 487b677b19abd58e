"""Feet in MuJoCo have the friction of a flat base; its plain shapes do not."""

from dataclasses import replace

import pytest

from pushpressslide_studies.bench.footprints import (
    FOOTPRINTS,
    Errors,
    measured,
    planar_errors,
)

BARS = {"force": 0.01, "spin": 0.02, "pivots": 0.03, "pushes": 0.02}
"""Largest error allowed in each column."""


def misses(errors: Errors) -> set[str]:
    """The columns in which a simulator is beyond its bar."""
    return {name for name, bar in BARS.items() if abs(getattr(errors, name)) > bar}


def errors_of(footprint: str, base: str, *speeds: float) -> list[Errors]:
    """Errors of MuJoCo at speeds [m/s]."""
    pytest.importorskip("pydrake")
    pytest.importorskip("mujoco")
    from pushpressslide_studies.sim.footprint_rigs import MujocoRig

    rig = MujocoRig(FOOTPRINTS[footprint], base)
    return list(measured(rig, footprint, base, speeds))


@pytest.mark.long
@pytest.mark.parametrize("footprint", ["square", "L"])
def test_feet_have_the_friction_of_the_base(footprint: str) -> None:
    for errors in errors_of(footprint, "feet", 0.01, 0.05):
        assert not misses(errors), errors


def test_a_plain_box_resists_turning_too_much() -> None:
    (errors,) = errors_of("square", "box", 0.05)
    assert {"spin", "pivots", "pushes"} <= misses(errors), errors
    assert errors.spin > 0.1


@pytest.mark.parametrize("footprint", FOOTPRINTS)
def test_the_planar_engine_agrees_with_the_integral(footprint: str) -> None:
    errors = planar_errors(footprint)
    assert not misses(errors), errors
    assert misses(replace(errors, spin=-0.03)) == {"spin"}
