"""Contact model and solver of every plant in this package whose bodies touch."""

from __future__ import annotations

from pydrake.multibody.plant import (
    ContactModel,
    DiscreteContactApproximation,
    MultibodyPlant,
)


def solve_contacts(plant: MultibodyPlant, *, convex: bool = False) -> None:
    """Enable contact in a plant before it is finalized.

    Contact is hydroelastic, except for point contact between rigid tips and rigid
    obstacles. Drake's TAMSI solver (Castro and others, 2020) computes Coulomb friction
    from the load at the end of the step. Friction is exact above the stiction tolerance
    of 0.1 mm/s; sticking contacts creep at a fraction of this speed. If bodies jam, the
    solver may not converge. With ``convex``, Drake's convex approximation ``lagged`` is
    used. It always converges, to the same poses, but takes twice the time, because it
    creates an object for each contact polygon. The approximations ``similar`` and
    ``sap`` would change the normal force of sliding contacts.
    """
    plant.set_contact_model(ContactModel.kHydroelasticWithFallback)
    solver = DiscreteContactApproximation.kTamsi
    if convex:
        solver = DiscreteContactApproximation.kLagged
    plant.set_discrete_contact_approximation(solver)
