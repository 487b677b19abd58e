"""Random bodies, supports and contacts, the same for every test."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from pushpressslide.core.task import Box
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.planar.contact import Contact, SideContact, TipLaw, TopContact
from pushpressslide.planar.support_friction import SupportFriction

TIP_RADIUS = 0.02
WEIGHT = 10.0  # [N]


@dataclass(frozen=True)
class Case:
    """One tick's problem, about the centre of pressure."""

    samples: PressureSamples
    friction: SupportFriction
    support_mu: float
    limit: float
    contacts: tuple[Contact, ...]


def pressed_at(rng: np.random.Generator, length: float, width: float) -> Contact:
    """A tip somewhere on the top of a box whose centre is the origin."""
    angle = rng.uniform(0.0, 2.0 * math.pi)
    size = 10.0 ** rng.uniform(-0.5, 1.5)
    force = tuple((size * rng.normal(size=2)).tolist())
    law = TipLaw((math.cos(angle), math.sin(angle)), force, dampings(rng))
    point = (rng.uniform(-0.5, 0.5) * length, rng.uniform(-0.5, 0.5) * width)
    return TopContact(point, law, rng.uniform(0.1, 1.2) * rng.uniform(0.1, 20.0))


def pushed_at(rng: np.random.Generator, length: float, width: float) -> Contact:
    """A tip somewhere at a side of that box, touching it or about to."""
    side = int(rng.integers(4))
    normal = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[side]
    along = rng.uniform(-0.5, 0.5)
    point = (
        (-0.5 * length * normal[0], along * width)
        if side % 2 == 0
        else (along * length, -0.5 * width * normal[1])
    )
    center = (point[0] - TIP_RADIUS * normal[0], point[1] - TIP_RADIUS * normal[1])
    size = 10.0 ** rng.uniform(-0.5, 1.5)
    law = TipLaw(normal, (size * abs(rng.normal()), size * rng.normal()), dampings(rng))
    approach = 0.0 if rng.random() < 0.7 else rng.uniform(0.0, 0.05)
    return SideContact(point, center, law, rng.uniform(0.1, 1.2), approach)


def dampings(rng: np.random.Generator) -> tuple[float, float]:
    """Equal along both axes, more often than not."""
    first, second = rng.uniform(50.0, 1500.0, size=2).tolist()
    return (first, first if rng.random() < 0.6 else second)


def drawn_case(seed: int, count: int | None = None, presses: float = 0.5) -> Case:
    """A box with one to three contacts (or ``count``), each on top with probability
    ``presses``.
    """
    rng = np.random.default_rng(seed)
    length, width = rng.uniform(0.08, 0.4, size=2).tolist()
    cop = (rng.uniform(-0.3, 0.3) * length, rng.uniform(-0.3, 0.3) * width)
    mu = rng.uniform(0.1, 0.8)
    made = []
    for _ in range(int(rng.integers(1, 4)) if count is None else count):
        make = pressed_at if rng.random() < presses else pushed_at
        made.append(from_cop(make(rng, length, width), cop))
    load = WEIGHT + sum(c.limit for c in made if isinstance(c, TopContact))
    samples = support_pressure(Box((length, width, 0.1)), load, (0.0, 0.0), cop, 3)
    return Case(samples, SupportFriction(samples), mu, mu * load, tuple(made))


def from_cop(contact: Contact, cop: tuple[float, float]) -> Contact:
    """The same contact with its places taken from the centre of pressure."""
    point = (contact.point[0] - cop[0], contact.point[1] - cop[1])
    if isinstance(contact, TopContact):
        return TopContact(point, contact.law, contact.limit)
    center = (contact.center[0] - cop[0], contact.center[1] - cop[1])
    return SideContact(point, center, contact.law, contact.friction, contact.approach)


@pytest.fixture(scope="session")
def draw():
    return drawn_case
