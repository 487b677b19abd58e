"""Figures of the search for the twist at which support and tips balance: of
``planar.sliding`` for one body, of ``batch.sliding`` for many.
"""

from pushpressslide.kernels.support_friction import CREEP as CREEP

BALANCE = 1e-9  # of mu N: force left over at which a tick is solved
# of mu N: force left over from which Newton's slope is tried twice
CLOSE = 0.1
# of the force left over at balance: what a second step with one slope may leave
SURE = 0.01
STEPS = 25  # of Newton's method
HALVINGS = 40  # of one step that goes too far
# of the friction over the speed, added to its slope: it has none along the motion
SOFTENING = 1e-6
# [m/s] of which the drag is mu N, when balance is looked for by letting the object go
DRAG_SPEED = 0.01
TRIALS = 60
PASSED = 1e-3  # [m] behind a face: a tip there came round its end, not through it
