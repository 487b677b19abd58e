"""Push a box beside its centre: does the contact stick, and about which point it turns."""

from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import rectangle_pressure
from pushpressslide.mechanics.rho import rho_fit

weight = 9.81  # [N]
rho = rho_fit(rectangle_pressure(0.2, 0.12, weight, (0.0, 0.0), 4))
surface = EllipsoidLimitSurface(0.3 * weight, rho)
for across in (0.0, 0.02, 0.04):
    out = push_outcome(surface, (-0.1, across), (1.0, 0.0), 0.5, (0.05, 0.0))
    v = out.twist
    print(f"{1e3 * across:3.0f} mm aside: {out.kind}, turns at {v.w:+.3f} rad/s")

center = push_outcome(surface, (-0.1, 0.0), (1.0, 0.0), 0.5, (0.05, 0.0))
assert abs(center.twist.w) < 1e-12
