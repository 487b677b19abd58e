"""How contacts are solved, in every plant of this package whose bodies touch."""

from __future__ import annotations

from pydrake.multibody.plant import (
    ContactModel,
    DiscreteContactApproximation,
    MultibodyPlant,
)


def solve_contacts(plant: MultibodyPlant, *, convex: bool = False) -> None:
    """Let bodies of a plant touch, before it is finalized: hydroelastically, but rigid
    tips and rigid obstacles in points; with Coulomb's friction, by Drake's TAMSI solver
    (Castro and others, 2020).

    Its friction takes the load of the end of the step. It is exact above the stiction
    tolerance of 0.1 mm/s; contacts that stick creep by a share of that. Where bodies
    jam it may not converge. The ``convex`` approximation ``lagged`` always does, and
    comes to the same poses in twice the time: it makes an object of each contact
    polygon. ``similar`` and ``sap`` change the normal force of what slides.
    """
    plant.set_contact_model(ContactModel.kHydroelasticWithFallback)
    solver = DiscreteContactApproximation.kTamsi
    if convex:
        solver = DiscreteContactApproximation.kLagged
    plant.set_discrete_contact_approximation(solver)
