"""A flat finger, and whether the object stays with it on a bend."""

import pushpressslide as pps
from pushpressslide.core.wrench import Twist

body = pps.Object(pps.Box((0.2, 0.3, 0.1)), 1.0, (0.0, 0.0))
finger = pps.FlatFinger((-0.1, 0.06), (-0.1, -0.06), friction=0.5)
for turn in (0.0, 0.1, 0.5):
    push = pps.push_sticks(body, 0.3, finger, Twist(0.05, 0.0, turn), height=0.03)
    print(
        f"{turn:.1f} rad/s: sticks {push.sticks}, uses {push.friction_utilisation:.2f}"
    )

assert pps.push_sticks(body, 0.3, finger, Twist(0.05, 0.0, 0.0), height=0.03).sticks
