"""Build a task without a file, check it as a file is checked, and write it down."""

import math
from dataclasses import replace

import pushpressslide as pps

task = pps.Task(
    name="my-box",
    object=pps.Object(
        pps.Box((0.18, 0.12, 0.10)), mass=0.8, center_of_mass=(0.01, 0.0)
    ),
    start=pps.Pose2(0.40, 0.15, 0.0),  # x, y [m] and yaw [rad] of the shape's frame
    goal=pps.Pose2(0.60, -0.10, math.radians(-30.0)),
    robots=(pps.Robot("panda", base=(0.0, 0.0, 0.0)),),
    support=pps.Support(friction=0.35),
    contact_friction=0.6,
)
pps.check_task(task)
text = pps.dump_task(task)
print(text)

try:
    pps.check_task(replace(task, object=replace(task.object, mass=2000.0)))
except pps.TaskError as error:
    print(error)  # one line: the field, the value, what is allowed
else:
    raise AssertionError("a mass of two tonnes was taken")
