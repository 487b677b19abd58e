"""An L from its outline: where its centre of mass is, how it turns, and a push of it."""

import pushpressslide as pps
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_fit

outline = ((0.0, 0.0), (0.2, 0.0), (0.2, 0.06), (0.06, 0.06), (0.06, 0.2), (0.0, 0.2))
shape = pps.Prism(outline, height=0.08)
body = pps.Object(shape, mass=0.9)  # without center_of_mass: of even density
x, y = body.center_of_mass
rho = rho_fit(support_pressure(shape, center_of_mass=body.center_of_mass))
print(f"centre of mass at ({1e3 * x:.1f}, {1e3 * y:.1f}) mm, rho {1e3 * rho:.1f} mm")

task = pps.Task(
    name="l-shape",
    object=body,
    start=pps.Pose2(0.40, 0.10, 0.0),
    goal=pps.Pose2(0.62, -0.05, -0.4),
    robots=(pps.Robot("panda"),),
    modes=("rear_push",),
)
record = pps.run(pps.plan(task), engine="planar")
assert record.success
