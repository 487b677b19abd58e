"""What the simulator's own failure is, and what is an error of ours."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import EventStatus
from pydrake.systems.primitives import ConstantVectorSource, Integrator

import pushpressslide as pps
from pushpressslide.core.control import Measurement
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.plant import DrakePlant
from pushpressslide.sim.station import Station


def plant_of(simulator: Simulator) -> DrakePlant:
    """Return a plant that has nothing but a simulator and its clock."""
    plant = DrakePlant.__new__(DrakePlant)
    plant._ticks = 0
    plant._period = 0.01
    plant._failure = None
    plant._spare = None
    plant._station = SimpleNamespace(simulator=simulator, disturb=lambda *_: None)
    plant._x = np.zeros(0)
    plant._truth = Measurement(0.0, Pose2(), ())
    return plant


def simulator() -> Simulator:
    return Simulator(ConstantVectorSource([1.0]))


def test_an_error_of_the_simulator_is_a_run_that_diverged() -> None:
    unconnected = Simulator(Integrator(1))
    plant = plant_of(unconnected)
    plant.advance()
    assert plant._failure is not None
    assert "InputPort" in plant._failure


def test_an_error_of_ours_inside_the_simulation_is_raised() -> None:
    def mistaken(context: object) -> EventStatus:
        raise RuntimeError("a mistake of ours")

    watched = simulator()
    watched.set_monitor(mistaken)
    plant = plant_of(watched)
    with pytest.raises(RuntimeError, match="a mistake of ours"):
        plant.advance()
    assert plant._failure is None


def test_a_good_tick_is_no_failure() -> None:
    plant = plant_of(simulator())
    plant.advance()
    assert plant.time == 0.01
    assert plant._failure is None


def test_a_spare_station_takes_over_where_the_solver_gives_up() -> None:
    plant = plant_of(Simulator(Integrator(1)))  # fails, since it is not connected
    plant._station.context = plant._station.simulator.get_context()
    plant._facts = {}
    taken = []
    spare = SimpleNamespace(simulator=simulator(), take_over=taken.append)
    first = plant._station
    plant._spare = lambda: spare
    plant.advance()
    assert taken == [first]
    assert plant._failure is None
    assert plant._facts["convex_from"] == 0.0
    assert spare.simulator.get_context().get_time() == plant.time
    # there is no second one
    assert plant._spare is None


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
