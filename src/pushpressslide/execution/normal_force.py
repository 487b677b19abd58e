"""Proportional-integral regulation of a normal force.

Paper, eq. 25; docs/mechanics.md, section 10.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NormalForceState:
    """State of the regulator."""

    integral: float = 0.0  # [N] of K_i times the error's integral
    ramped: float = 0.0  # [N] the command as ramped so far


@dataclass(frozen=True, slots=True)
class NormalForceRegulator:
    """PI regulator with a ramped command, a clamp, conditional integration, and a reset
    on loss of contact.

    While a tip bounces, only the feed-forward command presses it. With one sample of
    delay the loop is stable iff |k_p| < 1 and 0 < k_i dt < 2 (1 - k_p); the integral is
    updated before the output.
    """

    k_p: float = 0.3
    k_i: float = 10.0  # [1/s]
    f_max: float = 40.0  # [N]
    ramp: float = 60.0  # [N/s]
    contact_threshold: float = 0.2  # [N] below it there is no contact
    # share of the command below which a contact is being made or lost
    firm: float = 0.5
    # share of the command above which a joint that stuck has broken loose, and ratio of
    # the rates at which the integral falls then and rises
    excess: float = 1.05
    unwinding: float = 5.0

    def init(self) -> NormalForceState:
        """Initial state, without force."""
        return NormalForceState()

    def step(
        self, state: NormalForceState, command: float, measured: float, dt: float
    ) -> tuple[float, NormalForceState]:
        """Normal force [N] to apply, in [0, f_max], and the next state."""
        step = self.ramp * dt
        ramped = min(max(command, state.ramped - step), state.ramped + step)
        if measured < self.contact_threshold:
            return min(max(ramped, 0.0), self.f_max), NormalForceState(0.0, ramped)
        if measured < self.firm * ramped:  # a tip that bounces: no error to wind up by
            integral = state.integral
            output = min(max(ramped + integral, 0.0), self.f_max)
            return output, NormalForceState(integral, ramped)
        error = ramped - measured
        rate = self.k_i
        if state.integral > 0.0 and measured > self.excess * ramped:
            rate *= self.unwinding
        integral = state.integral + rate * error * dt
        raw = ramped + self.k_p * error + integral
        output = min(max(raw, 0.0), self.f_max)
        if raw != output and (raw - output) * error > 0.0:
            # the clamp is active and the error would push further into it
            integral = state.integral
        return output, NormalForceState(integral, ramped)
