"""Friction that is believed wrong, and sensors with noise: the controller sees no truth."""

from dataclasses import replace

import pushpressslide as pps

task = pps.load_task(
    "rear-push-rear",
    (
        "belief.support_friction=0.2",  # it is 0.3
        "sensing.position_noise=0.0005",
        "sensing.yaw_noise_deg=0.2",
        "sensing.force_noise=0.2",
        "sensing.delay=0.02",
    ),
)
record = pps.run(task, engine="planar", seed=1)
print(record, record.figures["final_position_error"])
assert record.success

exact = replace(task, sensing=pps.Sensing())
print(pps.run(exact, engine="planar").figures["final_position_error"])
