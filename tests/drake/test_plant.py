"""What the simulator's own failure is, and what is an error of ours."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import EventStatus
from pydrake.systems.primitives import ConstantVectorSource, Integrator

from pushpressslide.core.control import Measurement
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.plant import DrakePlant


def plant_of(simulator: Simulator) -> DrakePlant:
    """Return a plant that has nothing but a simulator and its clock."""
    plant = DrakePlant.__new__(DrakePlant)
    plant._ticks = 0
    plant._period = 0.01
    plant._failure = None
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
