"""Failures of the simulator, as opposed to errors in the package."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import EventStatus
from pydrake.systems.primitives import ConstantVectorSource, Integrator

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import TABLE
from pushpressslide.sim.cell import DrakePhysics, _Instant
from pushpressslide.sim.station import Station


def physics_of(simulator: Simulator) -> DrakePhysics:
    """Return physics that have nothing but a simulator and its clock."""
    physics = DrakePhysics.__new__(DrakePhysics)
    physics._ticks = 0
    physics._period = 0.01
    physics._failure = None
    physics._spare = None
    physics.station = SimpleNamespace(
        simulator=simulator, disturb=lambda *_: None, state_vector=lambda: np.zeros(7)
    )
    physics._body = 0
    physics.frame = TABLE
    physics.now = _Instant([0.0] * 7, Pose2())
    return physics


def simulator() -> Simulator:
    return Simulator(ConstantVectorSource([1.0]))


def test_an_error_of_the_simulator_is_a_run_that_diverged() -> None:
    unconnected = Simulator(Integrator(1))
    physics = physics_of(unconnected)
    physics.advance()
    assert physics._failure is not None
    assert "InputPort" in physics._failure


def test_an_error_of_ours_inside_the_simulation_is_raised() -> None:
    def mistaken(context: object) -> EventStatus:
        raise RuntimeError("a mistake of ours")

    watched = simulator()
    watched.set_monitor(mistaken)
    physics = physics_of(watched)
    with pytest.raises(RuntimeError, match="a mistake of ours"):
        physics.advance()
    assert physics._failure is None


def test_a_good_tick_is_no_failure() -> None:
    physics = physics_of(simulator())
    physics.advance()
    assert physics.time == 0.01
    assert physics._failure is None


def test_a_spare_station_takes_over_where_the_solver_gives_up() -> None:
    physics = physics_of(Simulator(Integrator(1)))  # fails, since it is not connected
    physics.station.context = physics.station.simulator.get_context()
    physics.facts = {}
    taken = []
    spare = SimpleNamespace(
        simulator=simulator(),
        take_over=taken.append,
        state_vector=lambda: np.zeros(7),
    )
    first = physics.station
    physics._spare = lambda: spare
    physics.advance()
    assert taken == [first]
    assert physics._failure is None
    assert physics.facts["convex_from"] == 0.0
    assert spare.simulator.get_context().get_time() == physics.time
    # there is no second one
    assert physics._spare is None


def test_a_station_goes_on_from_where_another_one_is() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    first = Station(plan, time_step=0.004)
    (robot,) = first.scene.robots
    first.plant.SetPositions(
        first.plant_context, robot.model_instance, robot.facts.home
    )
    first.simulator.Initialize()
    first.set_torque(0, np.linspace(-1.0, 1.0, 7))
    first.simulator.AdvanceTo(0.1)
    second = Station(plan, time_step=0.004, convex=True)
    second.take_over(first)
    assert second.context.get_time() == pytest.approx(0.1)
    np.testing.assert_array_equal(second.state_vector(), first.state_vector())
    for station in (first, second):
        station.simulator.AdvanceTo(0.14)
    # the arm falls alike
    np.testing.assert_allclose(
        second.state_vector(), first.state_vector(), rtol=0.0, atol=1e-3
    )
    assert np.abs(first.state_vector()).max() > 0.1
