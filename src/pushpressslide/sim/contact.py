"""Contact model and solver of every plant of this package whose bodies touch."""

from __future__ import annotations

from pydrake.multibody.plant import (
    ContactModel,
    DiscreteContactApproximation,
    MultibodyPlant,
)


def solve_contacts(plant: MultibodyPlant, *, convex: bool = False) -> None:
    """Enable contact in a plant before it is finalized: hydroelastic, but point contact
    between rigid tips and rigid obstacles. Coulomb friction is solved by Drake's TAMSI
    solver (Castro and others, 2020).

    Friction uses the load at the end of the step. It is exact above the stiction
    tolerance of 0.1 mm/s; sticking contacts creep at a fraction of that. If bodies jam
    it may not converge. The ``convex`` approximation ``lagged`` always converges, to
    the same poses in twice the time, as it creates an object for each contact polygon.
    ``similar`` and ``sap`` change the normal force of sliding contacts.
    """
    plant.set_contact_model(ContactModel.kHydroelasticWithFallback)
    solver = DiscreteContactApproximation.kTamsi
    if convex:
        solver = DiscreteContactApproximation.kLagged
    plant.set_discrete_contact_approximation(solver)
