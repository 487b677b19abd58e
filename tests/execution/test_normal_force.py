"""Laws of the normal-force regulator (paper eq. 26)."""

import pytest

from pushpressslide.execution.normal_force import NormalForceRegulator


def settle(regulator, command, plant=lambda u: u, steps=2000, dt=0.002, start=1.0):
    """A plant that answers one sample later."""
    state = regulator.init()
    measured = start
    history = []
    for _ in range(steps):
        u, state = regulator.step(state, command, measured, dt)
        measured = plant(u)
        history.append(measured)
    return history


@pytest.mark.parametrize("gain", [0.8, 1.0, 1.2])
def test_the_wanted_force_is_reached_whatever_the_plant_gain(gain):
    assert settle(NormalForceRegulator(), 8.0, lambda u: gain * u)[-1] == pytest.approx(
        8.0, abs=1e-3
    )


def test_the_command_is_ramped_so_that_there_is_no_kick():
    history = settle(NormalForceRegulator(k_p=0.3, k_i=10.0, ramp=40.0), 8.0)
    assert max(history) < 8.8


@pytest.mark.parametrize(("k_i_dt", "stable"), [(1.3, True), (1.5, False)])
def test_the_stability_bound_behind_one_sample_of_delay(k_i_dt, stable):
    dt = 0.002
    k_p = 0.3
    regulator = NormalForceRegulator(
        k_p=k_p, k_i=k_i_dt / dt, f_max=1e9, ramp=1e9, contact_threshold=-1e12
    )
    history = settle(regulator, 800.0, steps=600, start=799.0)
    assert (abs(history[-1] - 800.0) < 1e-3) == stable


def test_the_output_stays_inside_the_clamp_and_does_not_wind_up():
    regulator = NormalForceRegulator(f_max=5.0)
    state = regulator.init()
    for _ in range(5000):
        u, state = regulator.step(state, 8.0, 5.0, 0.002)
        assert 0.0 <= u <= 5.0
    assert state.integral < 1.0


def test_losing_contact_resets_the_integral():
    regulator = NormalForceRegulator()
    state = regulator.init()
    for _ in range(500):
        _, state = regulator.step(state, 8.0, 4.0, 0.002)
    assert state.integral > 1.0
    _, state = regulator.step(state, 8.0, 0.0, 0.002)
    assert state.integral == 0.0


def test_a_tip_that_bounces_winds_nothing_up():
    """It feels less than half of what it presses with: it is about to land again."""
    regulator = NormalForceRegulator()
    _, state = regulator.step(regulator.init(), 0.0, 1.0, 0.004)
    for _ in range(100):
        u, state = regulator.step(state, 15.0, 0.8, 0.004)
    assert u == pytest.approx(15.0, abs=0.05)
    assert abs(state.integral) < 0.05
