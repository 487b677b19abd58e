"""Contact pairs of a MuJoCo model. Nothing touches but what is paired here.

MuJoCo's friction rows are dampers with a time constant. A row that is quick compared
with the run loads a foot the more, the faster it slips; a row that is slow compared
with the acceleration of its foot points beside the slip. Both errors vanish together
if the feet are soft (a small impedance) and their friction rows slow. A high
``impratio`` keeps a body at rest from creeping.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import mujoco

IMPEDANCE = 0.001
"""Impedance of a foot."""
FRICTION_TIME = 10.0
"""Time constant [s] of a foot's friction row."""
IMPRATIO = 1e5
"""Impedance of friction over that of the normal force."""
STEPS = 3.0
"""Time constant of a base on its feet, in steps of the simulation."""
TOUCH_STEPS = 4.0
"""The same of other contacts."""
TIP_STIFFNESS = 2e4
"""Stiffness [N/m] of a rubber tip: it gives way by 1 mm under 20 N, as in Drake."""
TIP_DAMPING = 300.0
"""Damping [N s/m] of a tip, below critical for the 10 kg of an arm at its tip."""
TIP_IMPEDANCE = 0.02
"""Impedance of a tip's contact: small, so that stiffness and damping are its own."""
STABLE_SPRING = 0.1
"""Largest stiffness of a tip, as a share of a mass over the step squared."""
STABLE_DAMPER = 0.3
"""Largest damping, as a share of a mass over the step."""
TOLERANCE = 1e-14
"""Of the solver. With the usual 1e-8 lightly loaded feet creep."""
LINE_TOLERANCE = 1e-4
"""Of the solver's line search."""


def set_solver(spec: Any, time_step: float, gravity: tuple[float, ...]) -> None:
    """Set contact cone, solver and step [s] of a specification."""
    spec.compiler.degree = False
    option = spec.option
    option.timestep = time_step
    option.gravity = list(gravity)
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.impratio = IMPRATIO
    option.tolerance = TOLERANCE
    option.ls_tolerance = LINE_TOLERANCE
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    several = getattr(mujoco.mjtEnableBit, "mjENBL_MULTICCD", None)
    if several is not None:  # later versions have it on
        option.enableflags |= several


@dataclass(frozen=True)
class Contacts:
    """Adds pairs of geoms to a specification of a ``time_step`` [s]."""

    spec: Any
    time_step: float

    def stand(self, support: str, foot: str, share: float, friction: float) -> str:
        """Pair a foot, which carries a ``share`` of its base, with the support. Returns
        the name of the pair.
        """
        time = STEPS * self.time_step
        pair = self._pair(support, foot, (friction, friction, 0.0))
        pair.solref = [-share / time**2, -2.0 * share / time]
        pair.solreffriction = [FRICTION_TIME, 1.0]
        pair.solimp = [IMPEDANCE, IMPEDANCE, 1e-3, 0.5, 2.0]
        return f"{support}:{foot}"

    def touch(
        self,
        ones: Iterable[str],
        others: Iterable[str],
        friction: float,
        torsion: float = 0.0,
    ) -> None:
        """Pair each geom of ``ones`` with each of ``others``. ``torsion`` [m] is the
        lever of the friction about the normal.
        """
        others = tuple(others)
        for one in ones:
            for other in others:
                pair = self._pair(one, other, (friction, friction, friction * torsion))
                pair.solref = [TOUCH_STEPS * self.time_step, 1.0]

    def soften(self, model: Any, ones: Iterable[str], others: Iterable[str]) -> None:
        """Give pairs in a compiled model the stiffness and damping of rubber tips."""
        others = tuple(others)
        step = self.time_step
        weight = model.body_invweight0[:, 0]
        for one in ones:
            for other in others:
                number = model.pair(f"{one}:{other}").id
                geoms = (model.pair_geom1[number], model.pair_geom2[number])
                lightness = float(sum(weight[model.geom_bodyid[g]] for g in geoms))
                mass = 1.0 / lightness
                stiffness = min(TIP_STIFFNESS, STABLE_SPRING * mass / step**2)
                damping = min(TIP_DAMPING, STABLE_DAMPER * mass / step)
                # what a direct reference of MuJoCo is, per unit of stiffness
                unit = (1.0 - TIP_IMPEDANCE) * lightness
                model.pair_solref[number] = (-stiffness * unit, -damping * unit)
                model.pair_solreffriction[number] = (10.0 * step / TIP_IMPEDANCE, 1.0)
                model.pair_solimp[number, :2] = TIP_IMPEDANCE

    def _pair(self, one: str, other: str, frictions: tuple[float, ...]) -> Any:
        turning = frictions[2] > 0.0
        return self.spec.add_pair(
            name=f"{one}:{other}",
            geomname1=one,
            geomname2=other,
            condim=4 if turning else 3,
            friction=[*frictions, 0.0, 0.0],
        )


def sink(gravity: float, time_step: float) -> float:
    """Depth [m] to which a base sinks under its own weight, by ``gravity`` [m/s^2]
    along the support's normal.
    """
    return gravity * (STEPS * time_step) ** 2
