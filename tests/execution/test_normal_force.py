"""Laws of the normal-force regulator (paper eq. 26)."""

import pytest

from pushpressslide.execution.normal_force import (
    NormalForceRegulator,
    NormalForceState,
)


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


DT = 0.004


def test_a_step_of_the_command_is_ramped_up_and_down() -> None:
    regulator = NormalForceRegulator(k_p=0.0, k_i=0.0, ramp=50.0)
    state = regulator.init()
    for begin, end in ((0.0, 10.0), (10.0, 2.0)):
        ticks = round(abs(end - begin) / (50.0 * DT))
        for i in range(1, ticks + 3):
            u, state = regulator.step(state, end, 30.0, DT)
            along = min(i / ticks, 1.0)
            assert u == pytest.approx(begin + along * (end - begin))


def test_a_tip_that_feels_nothing_is_pressed_by_the_command_alone() -> None:
    """Inside the clamp."""
    regulator = NormalForceRegulator(k_p=0.5, ramp=1e9, f_max=10.0)
    u, state = regulator.step(NormalForceState(3.0, 0.0), 6.0, 0.19, DT)
    assert (u, state) == (6.0, NormalForceState(0.0, 6.0))
    assert regulator.step(NormalForceState(), 60.0, 0.0, DT)[0] == 10.0
    assert regulator.step(NormalForceState(), -60.0, 0.0, DT)[0] == 0.0


@pytest.mark.parametrize(
    ("measured", "lost"), [(0.19, True), (0.2, False), (0.21, False)]
)
def test_contact_is_lost_below_the_threshold(measured: float, lost: bool) -> None:
    regulator = NormalForceRegulator(ramp=1e9)
    _, state = regulator.step(NormalForceState(1.0, 0.3), 0.3, measured, DT)
    assert (state.integral == 0.0) == lost


@pytest.mark.parametrize(("share", "bounces"), [(0.49, True), (0.5, False)])
def test_a_contact_that_is_not_firm_keeps_its_integral(
    share: float, bounces: bool
) -> None:
    regulator = NormalForceRegulator(ramp=1e9, f_max=30.0)
    u, state = regulator.step(NormalForceState(2.0, 20.0), 20.0, share * 20.0, DT)
    assert (state.integral == 2.0) == bounces
    if bounces:
        assert u == pytest.approx(22.0)
        # inside the clamp
        low = regulator.step(NormalForceState(-90.0, 20.0), 20.0, 1.0, DT)
        high = regulator.step(NormalForceState(90.0, 20.0), 20.0, 1.0, DT)
        assert (low[0], high[0]) == (0.0, 30.0)


def test_an_error_is_answered_in_proportion_and_by_its_integral() -> None:
    regulator = NormalForceRegulator(k_p=0.3, k_i=10.0, ramp=1e9)
    u, state = regulator.step(NormalForceState(1.0, 8.0), 8.0, 6.0, DT)
    integral = 1.0 + 10.0 * 2.0 * DT
    assert state == NormalForceState(pytest.approx(integral), 8.0)
    assert u == pytest.approx(8.0 + 0.3 * 2.0 + integral)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_at_the_clamp_the_integral_only_goes_back(side: float) -> None:
    """Where the error would push further it stays; where it leads back it follows."""
    regulator = NormalForceRegulator(k_p=0.3, k_i=10.0, ramp=1e9, f_max=10.0)
    integral = 90.0 * side
    measured = 5.0 - side
    u, state = regulator.step(NormalForceState(integral, 5.0), 5.0, measured, DT)
    assert u == (10.0 if side > 0.0 else 0.0)
    assert state.integral == integral
    measured = 5.0 + 0.2 * side
    u, state = regulator.step(NormalForceState(integral, 5.0), 5.0, measured, DT)
    assert u == (10.0 if side > 0.0 else 0.0)
    assert state.integral == pytest.approx(integral - side * 0.2 * 10.0 * DT)


def test_an_integral_that_a_stuck_joint_wound_up_falls_quickly() -> None:
    """Only where the force is above its command, and the integral still pushes."""
    regulator = NormalForceRegulator(k_p=0.3, k_i=10.0, ramp=1e9)

    def changed(integral: float, measured: float) -> float:
        before = NormalForceState(integral, 20.0)
        _, state = regulator.step(before, 20.0, measured, DT)
        return state.integral - integral

    assert changed(8.0, 23.0) == pytest.approx(5.0 * -3.0 * 10.0 * DT)
    assert changed(8.0, 20.9) == pytest.approx(-0.9 * 10.0 * DT)
    assert changed(-8.0, 23.0) == pytest.approx(-3.0 * 10.0 * DT)


def test_at_the_clamp_without_an_error_nothing_changes() -> None:
    regulator = NormalForceRegulator(ramp=1e9, f_max=10.0)
    u, state = regulator.step(NormalForceState(90.0, 5.0), 5.0, 5.0, DT)
    assert (u, state) == (10.0, NormalForceState(90.0, 5.0))
