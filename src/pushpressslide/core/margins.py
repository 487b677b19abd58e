"""Table of all physical margins: distances to limits in planning and control, and
thresholds below which a quantity counts as zero or as met.

A margin that concerns the physics of the object is dimensionless. It is an angle, a
fraction of the friction, a length divided by the radius of the object
(``ObjectModel.radius``) or of the tip, or a time divided by a length over a speed.
Margins that depend on the arm and its sensors have units and are in ``ArmMargins``: an
arm is no quicker with a small object. Quasi-static motions therefore scale. If every
length is multiplied by k, the forces by any factor and the speeds, including those of
the arm, by sqrt(k), the plan is the same (tests/modes/test_scaling.py).

Numbers that only set the resolution of a computation are defined where they are used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

# --- positions of contacts

INSET = 0.6
"""Smallest distance of a contact from the edges of its face or of the top, in tip
radii. A tip that rolls or creeps by half of this distance is still on the face.
"""
CREEP = 0.15
"""Largest creep of a pushing tip along a side before the tip is put back, in tip radii.
"""
CREPT_TURN = 0.25
"""Largest turn [rad] of the side's normal within ``CREEP``: half of a usual friction
angle. With a larger turn, as on the fillet of a corner, the force of a push would leave
its friction cone.
"""
LEAST_LEVER = 0.25
"""Smallest lever of a push about a pinned point, in radii of the object. With a shorter
lever, the error of the contact's position dominates.
"""
SIDE_LEAN = 0.35
"""Largest tangent of the lean of a pushed side, as a share of the tip's friction. It
costs at most a tenth of the friction available in the plane.
"""
ROD_RADIUS = 0.008
"""Radius [m] of the steel rod between flange and tip."""
ROD_SHARE = 0.4
"""Largest radius of a rod, as a share of its tip's radius. The rod of a small tip must
stay clear of the touched object.
"""
SURE_LEVER = 4.0
"""Smallest lever of a press that steers, as a multiple of the uncertainty of the centre
of mass. The heading is then wrong by at most a quarter of a radian, which the
controller corrects during the motion.
"""
PATCH = 0.16
"""Lever arm of the friction under a press, in tip radii: two thirds of the patch's
radius. This friction makes the object turn with the tool. If it has a larger moment
about the centre of pressure than the drag, no force steers the object like a vehicle.
"""
HELD_TURN = 8.0
"""Largest moment of the patch's friction, as a multiple of the drag's moment, if the
object turns with the tool. Of 31 random objects of 50 to 160 g, those with a ratio of
up to 9.5 came within 1.7 mm and 1 degree of their goals. The two with a larger ratio
missed by 5 and 9.5 mm.
"""
LEVER_SHARE = 0.5
"""Smallest lever of a contact, as a share of the longest one about a pinned point."""
OVER_EDGE = 0.3
"""Largest height of a pushing tip's centre above the object's upper edge, in tip radii.
The force then leans down by the arcsine of this share: 17 degrees.
"""
OVER_EDGE_FRICTION = 0.7
"""Upper bound of ``OVER_EDGE``, as a share of the tip's friction. The force of a smooth
tip then stays inside its friction cone.
"""
WIDTHS = (1.0, 0.8, 0.6, 0.4, 0.25)
"""Tried half distances between two contacts on a face, as shares of the free width."""

# --- tipping: in half widths of the base

TIPPING_MARGIN = 0.15
"""Smallest distance [half widths] of the centre of pressure from the base's edge,
inside the base. It covers the uncertainty of the pressure, and the shift due to a drag
that is higher by a tenth.
"""
PUSH_TIPPING_MARGIN = 0.05
"""Margin of a contact's height below the tipping height of a pushed object, as a share
of the tipping height. Pushes at this height reach their goals as reliably as lower
pushes: the axle follows from the pressure during the push.
"""
PUSH_STANDS = 0.8
"""Largest height of a contact with the tool upright, as a share of the tipping height
that follows from Coulomb's law. A contact closer to the tipping height tips the object
when it turns. Tools that lean back touch the object lower.
"""
SAFE_MARGIN = 0.5
"""Distance [half widths] of the centre of pressure inside the base's edge at which an
object may be driven at full speed. Closer to the edge the object is driven more slowly,
because the pressure, and with it the virtual axle, changes quickly there.
"""
EDGE_MARGIN = 0.3
"""Smallest distance [half widths] of the centre of pressure inside the edge of a table.
It is twice the margin to the base's own edge, since an object may be off its path.
"""
LEAN = 0.15
"""Largest shift [half widths] of the centre of pressure by a weight component in the
plane.
"""

# --- friction: in shares

FRICTION_USES = (0.7, 0.8, 0.9, 0.96)
"""Shares of a contact's friction that a motion may use, the best first. The rest is for
the servo, and covers a friction that is lower than believed.
"""
PIN_USES = (0.5, 0.6, *FRICTION_USES)
"""``FRICTION_USES`` of a press that holds a point in place, whose slip cannot be
undone.
"""
CORRECTION_USE = 0.9
"""Share of the friction that corrections within a cone may use."""
PREFERRED_USE = 0.8
"""Share of the friction that is used if several sets of forces realise the wrench."""
CONE_USE = 0.93
"""Measured friction utilisation above which the steering is reduced."""
HARDER = 1.3
"""Factor on the press if the friction turns out lower than planned. It applies to two
presses if the drag's lever uses up more friction, and to a single press if it has
crept.
"""
SPARE_LOAD = 0.02
"""Extra share of the load on the lighter of two presses, beyond the minimum for a turn
on the spot.
"""
SQUEEZE = 1.6
"""Largest push of one of two contacts, as a multiple of the drag. A larger push mostly
acts against the other contact.
"""
GIVEN = 1e-3
"""Smallest share of a wanted wrench that the contacts are assumed to provide. It only
avoids a division by zero.
"""

# --- cones and steering: in angles and shares

CONE_MARGIN = math.radians(6.0)
"""Smallest angle [rad] of a planned twist inside its motion cone. It covers the error
of the limit surface, and leaves room for corrections.
"""
BENT_MARGIN = math.radians(12.0)
"""``CONE_MARGIN`` of each twist of a path of several twists, if there is such a path.
The shortest path runs along the cone's edge, where no correction outwards is possible.
"""
REPLAN_MARGIN = math.radians(2.0)
"""``CONE_MARGIN`` of a replan, from a measured pose and measured contacts."""
AMPLE_MARGIN = math.radians(30.0)
"""Angle [rad] inside the cone above which a placement with less force is preferred."""
STEERING_RESERVE = 0.12
"""Share of a rear push's cone that is kept free at either edge for the servo and for
model errors.
"""
STEERING_SHARE = 0.85
"""Share of a pushed car's largest curvature that steering may command."""
PLANNED_STEERING = 0.6
"""Share of a pressed vehicle's steering that planned turns use."""
CORRECTING = math.radians(14.0)
"""Smallest angle [rad] by which the force can be turned to either side on a run-in, so
that errors decay.
"""
AXLE_SLIP = math.radians(6.0)
"""Largest slip angle [rad] of a virtual axle. With a larger angle, the object does not
move like a unicycle.
"""
FIRM = 0.5
"""Smallest turn of a pressed contact's direction of motion, as a share of the force's
turn.
"""
PUSHED_SPEED = 0.8
"""Speed of a pushed vehicle, as a share of the planned speed. The end far from the
contact swings out, and is faster.
"""
SWING = 1.2
"""Largest speed of a pressed contact, as a multiple of the axle's speed. Tighter turns
are driven more slowly.
"""
CONTACT_PACE = math.hypot(1.0, SWING)
"""Largest speed of a contact, along and across the heading combined, as a multiple of
``motion.speed``.
"""
PACE = (0.6, 5.0)
"""Smallest and largest speed of a pressed contact in a usable turn, as multiples of the
axle's speed.
"""
FARTHEST_AXLE = 3.0
"""Largest distance of a virtual axle from the centre of pressure, in radii of the
object. The position of a farther axle is too sensitive to the pressure.
"""
STRAIGHTEST = 0.006
"""Curvature times the object's radius below which a turn counts as straight. Over a
path of ten radii the error is 0.3 radii, which the run-in corrects.
"""
CORRECTED = 0.02
"""Lateral error at which the full steering of a turn is used, in radii of the object.
"""
MISSED = 0.1
"""Error at the start of a run-in, in radii of the object, above which other turns are
tried. A run-in reduces it to a tenth at best.
"""
LOOK_AHEAD = 0.35
"""Look-ahead of a pressed vehicle, in lengths of the vehicle, if the arm allows it. A
longer look-ahead corrects less; a shorter one swings the contact more.
"""
ROLLED = 0.25
"""Largest distance that a press may roll, as a share of its distance from the CoM. The
heading axis of the press then turns no more than steering can correct.
"""
CREPT = 0.2
"""Creep of a single press, as a share of its distance from the CoM, above which it is
placed again. A tip creeps in the direction of its force. If it creeps towards the CoM,
it reaches a point at which the drag tips the object.
"""

# --- paths

LOOP_RATIO = 1.6
"""Ratio of a path's length to the direct path above which the path is taken to contain
a loop. ``LOOP_SLACK`` is added.
"""
LOOP_SLACK = 0.25
"""Addition to the length given by ``LOOP_RATIO``, in radii of the object."""
LOOP_FOR_RUN_IN = 1.25
"""Largest length of a path with a longer run-in, as a multiple of the shortest path
with a loop. Without a run-in after the last turn, the error of that turn remains.
"""
LONGEST_LOOP = 2.5
"""Largest extra length of a path with a loop, in radii of the object, for a vehicle
that the task names.
"""
DETOUR = (1.1, 0.05)
"""Largest length of a replanned path: a multiple of the remaining path, plus a multiple
of the object's radius.
"""
TOUCH_DETOUR = (1.2, 0.25)
"""``DETOUR`` after a touch, with object and contact as measured."""
RUN_INS = (3.0, 2.0)
"""Lengths of the straight run-in after the turns of a manoeuvre, in look-aheads."""
RUN_INS_UNSURE = (6.0, 4.5)
"""``RUN_INS`` if the centre of mass is uncertain. It is identified during the motion,
and the heading is then corrected.
"""
VEHICLE_RUN_INS = (5.0, 3.0, 1.5)
"""``RUN_INS`` after the path of a single vehicle. The longest that fits is taken."""
LEAST_RUN_IN = 0.75
"""Smallest run-in of a replan, as a share of the shortest planned run-in."""
BACK_UPS = (0.0, 2.5, 5.0, 7.5)
"""Lengths by which a vehicle first backs up straight if the goal is too near, in
look-aheads.
"""
CAR_LOOK_AHEAD = 2.0
"""Look-ahead of a pushed car, as a multiple of the shortest path over which the arm
corrects.
"""
CAR_RUN_IN_UNSURE = 1.0
"""Shortest run-in of a rear push if the centre of mass is uncertain, as a share of
``motion.run_in``.
"""
CAR_RUN_INS = (1.0, 0.5, 0.25)
"""Run-ins of a pushed car that are tried, as shares of ``motion.run_in``."""
RUN_INS_ONWARD = (1.0, 0.5, 0.25, 0.125)
"""Run-ins of a rear push's replan that are tried, as shares of the planned one. The
remaining part of the old run-in alone would leave no space for new turns.
"""
NUDGE = 1.0
"""Longest section of a short push, in radii of the object."""
NUDGE_SPEED = 0.3
"""Speed of a short push, as a share of ``motion.speed``: it is over before late pictures
show where it leads.
"""
NUDGE_STEERING = 0.6
"""Share of the friction cone that a short push uses: the tip may have less friction than
believed.
"""
NUDGE_BESIDE = 0.8
"""Largest distance of a short push from the line through the centre of mass, in depths
of the face.
"""
NUDGED = 0.2
"""Final error that a short push may have, as a share of the goal's tolerances."""
NUDGED_WITHIN = 0.85
"""The same where a smaller one is out of reach."""
SLID_SHARE = 0.7
"""Friction of a tip that has slid, as a share of the believed friction."""
LIMITED_SHARE = 0.85
"""Force that a plan may have after a force limit, as a share of that allowed before."""
REST_TO_REST = 1.2
"""Extra time that stopping before and after a turn costs, as a multiple of speed over
acceleration.
"""
NARROW = 1.3
"""Time that a turn with little steering reserve must save to be preferred, as a
multiple of the object's radius over the speed.
"""
LONGEST = 0.75
"""Largest share of ``limits.time`` for a manoeuvre. The rest is for another attempt."""

# --- contact and speed

TOUCH_SHARE = 0.4
"""Force of a touch before the motion, as a share of the force that would move the
object.
"""
LOSS_SHARE = 0.6
"""Share of its planned load below which a press counts as lost."""
KEPT_SHARE = 0.5
"""Share of the detection threshold above which an established contact counts as kept.
"""
LEAST_SHARE = 0.2
"""Share of its planned force below which a push counts as lost."""
HELD_SHARE = 0.1
"""Smallest force of each of two pushing tips, as a share of their sum. A tip with a
smaller force is advanced: it would leave its face as soon as the object turns a little
more than planned.
"""
FELT_SIGMAS = 4.0
"""Force above which a contact is detected, in standard deviations of the mean that is
compared.
"""
PLANNED_NOISE = 2.0
"""Normal force kept free in plans, in standard deviations of a measured force."""
PRESS_SIGMAS = 8.0
"""Smallest press, in standard deviations of a measured force."""
FELT_SAMPLES = 25
"""Largest number of measurements in that mean: 0.1 s at 250 Hz."""
SEEN_TIME = 1.0
"""Time [s] of whose pictures the mean tells whether an object has moved."""
LOSS_SIGMAS = 6.0
"""Distance between the mean forces of a kept contact and a lost contact, in standard
deviations. It allows one false loss in 10^9 measurements.
"""
FLOOR_SPEED = 0.12
"""Smallest speed before the goal is reached, as a share of ``motion.speed``."""

RESISTED = 2.0
"""Resultant of two pushes above which another body pushes back, in units of the
largest friction that may hold the object by the stated errors.
"""
STALL = 0.05
"""Mean speed below which an object counts as standing still, as a share of
``motion.speed``.
"""

POSTURE_SPEED = 0.4
"""Speed of a change of posture in contact, as a share of a joint's velocity limit."""
DRAG = (0.5, 2.5)
"""Bounds of the measured drag, as multiples of the believed one."""
SURE_DRAG = 0.05
"""Relative deviation of the measured drag below which the believed friction is kept.
The mean of a steering force varies by this much.
"""

# --- goals: in shares of the task's tolerances

RETRY_ABOVE = 0.97
"""Share of the goal's tolerances above which the final errors trigger a retry."""
RETRY_ABOVE_SEATED = 0.3
"""``RETRY_ABOVE`` for a goal in an opening. The fall into the opening pushes the object
off its path.
"""
LATEST_TORQUE = 0.016
"""Longest delay [s] of an arm that takes torques: the dampers that keep its joints inside
their limits outlast the springs there by 1/60 s.
"""
BLIND_PICTURES = 3.0
"""Number of missing pictures of the object after which the arms wait."""
BLIND = 0.3
"""Least time [s] without a picture after which they do, beyond a picture's usual age."""
RESTING_PUSH = 0.2
"""Force with which tips stay at an object that is to rest, as a share of the force that
moves it.
"""
PACED = 0.15
"""Standard deviation of a pose, in shares of the goal's tolerances, above which an object
is led more slowly.
"""
PACED_AHEAD = 0.45
"""The same farther than ``slow_way`` from the goal."""
SLOWEST = 0.4
"""Smallest share of the planned speed for that reason."""
SURE = 0.2
"""Standard deviation of a pose, in shares of the goal's tolerances, with which the
object need not be looked at any longer.
"""
DOUBT = 2.0
"""Standard deviations by which an error has to stay within the goal's tolerances."""
EARLY_DOUBT = 3.0
"""The same while more pictures may tell: of many looks, one deceives sooner."""
TOOL_ASIDE = 0.2
"""Largest distance of a tool from the line of its straight push, as a share of
``tolerance.position``.
"""
ASKEW = math.radians(2.0)
"""Largest angle [rad] between a tool's face and the direction of its straight push."""
SQUARE = math.radians(20.0)
"""Largest angle [rad] between the sides of a tool's body and the tool's face."""


@dataclass(frozen=True, slots=True)
class ArmMargins:
    """Margins that depend on arms, tools and sensors, but not on the object."""

    response: float = field(default=0.8, metadata={"unit": "s"})
    """Time in which the servo brings an object's motion to its reference. If a law
    corrects errors within a shorter path, its forces come too late.
    """
    longest_look_ahead: float = field(default=0.1, metadata={"unit": "m"})
    """Longest look-ahead. With a longer look-ahead, the run-in would not fit the arm's
    reach.
    """
    quick: float = field(default=0.3, metadata={"unit": "s"})
    """``response`` of an object held from above."""
    turn_rate: float = field(default=0.8, metadata={"unit": "1/s"})
    """Largest turn rate of a pushed object. At a higher rate the tip slips when the
    steering jumps.
    """
    fastest_turn: float = field(default=1.0, metadata={"unit": "1/s"})
    """Largest turn rate that corrections may ask of an object: more than planned, less
    than a wrist can follow.
    """
    steering_time: float = field(default=0.4, metadata={"unit": "s"})
    """Time in which the steering of a push changes from one arc to the next. A tip that
    moves sideways abruptly slides along the face of a light object and hammers it.
    """
    regrasp: float = field(default=10.0, metadata={"unit": "s"})
    """Time that a placement takes without its motion: transfer, touch and release."""
    felt_force: float = field(default=0.05, metadata={"unit": "N"})
    """Contact force that a sensor without noise detects with certainty."""
    first_look: float = field(default=1.0, metadata={"unit": "s"})
    """Time before a touch in which noisy poses and forces are averaged."""
    longest_look: float = field(default=5.0, metadata={"unit": "s"})
    """Longest look at an object that has arrived, or has missed its goal."""
    longest_last_look: float = field(default=20.0, metadata={"unit": "s"})
    """Longest last look at one that seems to be at its goal, but may not be."""
    least_friction: float = field(default=0.5, metadata={"unit": "N"})
    """Smallest support friction of an object pushed by two tips. Below it a single tip
    can push the object away from the other tip.
    """
    least_press: float = field(default=3.0, metadata={"unit": "N"})
    """Smallest press. A lighter contact bounces, and is not detected with certainty."""
    firm_lever: float = field(default=0.004, metadata={"unit": "m"})
    """Smallest distance between a press that steers and the centre of pressure. At this
    distance, a creep of 1 mm turns the heading by a quarter of a radian.
    """
    table_gap: float = field(default=0.006, metadata={"unit": "m"})
    """Smallest gap between a pushing tip and the support."""
    tool_gap: float = field(default=0.01, metadata={"unit": "m"})
    """Preferred gap between a pushing tip and the support."""
    wrist_gap: float = field(default=0.04, metadata={"unit": "m"})
    """Height of the flange above the object's top."""
    low: float = field(default=0.04, metadata={"unit": "m"})
    """Height of a push if the tool is long enough: low enough that the object does not
    tip, and high enough that the hand clears the support.
    """
    tool_room: float = field(default=0.06, metadata={"unit": "m"})
    """Distance between two pushing tips that leaves room for their tools."""
    hand_room: float = field(default=0.1, metadata={"unit": "m"})
    """Distance between two pressing tips that leaves room for the hands above them."""
    leaving: float = field(default=0.05, metadata={"unit": "m"})
    """Path length over which the required gap grows to ``motion.clearance``, from a
    start or goal near an obstacle.
    """
    waiting: float = field(default=0.05, metadata={"unit": "m"})
    """Preferred clearance of an arm without a contact: half of ``near_plan``, the
    allowed distance of the object from its planned path.
    """
    touch_speed: float = field(default=0.03, metadata={"unit": "m/s"})
    """Speed of a tip over the last centimetres before a contact."""
    seen_late: float = field(default=0.5, metadata={"unit": "s"})
    """Time after which the filtered pose follows a motion that begins."""
    light_speed: float = field(default=0.006, metadata={"unit": "m/s"})
    """The same before an object that may slide before it is felt."""
    felt_near: float = field(default=0.015, metadata={"unit": "m"})
    """Distance of a tip from its contact below which a noisy force may be the object's:
    errors of arm and camera.
    """
    gap_again: float = field(default=0.025, metadata={"unit": "m"})
    """Free path before a push of a tip that has touched the object before: a centimetre
    until ``felt_near``.
    """
    slowest_touch: float = field(default=0.002, metadata={"unit": "m/s"})
    """Smallest such speed, of an arm that reacts late."""
    contact_stiffness: float = field(default=2e4, metadata={"unit": "N/m"})
    """Stiffness of a rubber tip and what it touches, as far as it is known."""
    loop_share: float = field(default=2.0, metadata={"unit": "1"})
    """Damping of an arm that takes positions or velocities, as a multiple of that
    stiffness times its reaction time.
    """
    position_rate: float = field(default=8.0, metadata={"unit": "1/s"})
    """Rate at which the tip of such an arm comes to a commanded place."""
    correction_speed: float = field(default=0.1, metadata={"unit": "m/s"})
    """Largest speed of such a tip besides that of its reference."""
    longest_reaction: float = field(default=0.1, metadata={"unit": "s"})
    """Longest reaction time of such an arm that presses. In runs with 0.1 s presses kept
    0.59 of their load or more, about ``LOSS_SHARE``. With 0.12 s of pure delay two
    presses lost their contacts and missed their goal.
    """
    pressing: float = field(default=0.4, metadata={"unit": "s"})
    """Time until a typical press reaches its load."""
    approach: float = field(default=5.0, metadata={"unit": "s"})
    """Typical time from the home posture to the start of the touch. The planar engine
    starts at the touch.
    """
    settling: float = field(default=1.8, metadata={"unit": "s"})
    """Time for aligning the tips, confirming the touch, and drawing back."""
    slid: float = field(default=0.0025, metadata={"unit": "m"})
    """Slip of a contact that triggers a replan: the resolution of measured tip and
    pose.
    """
    off_path: float = field(default=0.001, metadata={"unit": "m"})
    """Distance of the object from its path that triggers a replan."""
    off_heading: float = field(default=math.radians(1.0), metadata={"unit": "1"})
    """Heading error [rad] of the object that triggers a replan."""
    off_line: float = field(default=math.radians(2.0), metadata={"unit": "1"})
    """Turn [rad] of the line from the centre of mass to a contact above which the
    centre of mass counts as displaced. Changes of the force alone turn this line by
    about a degree.
    """
    off_line_unsure: float = field(default=math.radians(0.5), metadata={"unit": "1"})
    """``off_line`` [rad] if the belief allows for an uncertain centre of mass."""
    stop: float = field(default=2e-4, metadata={"unit": "m"})
    """Remaining path at which the motion ends."""
    astray: float = field(default=0.1, metadata={"unit": "m"})
    """Distance of the tracking point from its path above which the run is abandoned.
    The planned joint path is then no longer valid.
    """
    turned_away: float = field(default=math.radians(60.0), metadata={"unit": "1"})
    """Heading error [rad] of a pushed object above which the motion ends: the push would
    lead it in circles.
    """
    via: float = field(default=0.02, metadata={"unit": "m"})
    """Position error allowed at a via pose. Within it, the arms still find their next
    contacts.
    """
    turned_via: float = field(default=math.radians(5.0), metadata={"unit": "1"})
    """Yaw error [rad] allowed at a via pose."""
    near_plan: float = field(default=0.1, metadata={"unit": "m"})
    """Distance of an object from its planned path within which the arms' joints can
    follow.
    """
    turned_beside: float = field(default=0.4, metadata={"unit": "1"})
    """Yaw error [rad] of an object within which the arms' joints can follow."""
    stall_time: float = field(default=5.0, metadata={"unit": "s"})
    """Time without motion of the object after which a run is abandoned."""
    retouch: float = field(default=0.012, metadata={"unit": "m"})
    """Smallest slip of a contact, and smallest remaining path, for which a tip lets go
    and touches the planned point again. A new touch costs the arm time.
    """
    slid_side: float = field(default=0.003, metadata={"unit": "m"})
    """Slip along the face above which one of two pushing tips is moved back: the
    accuracy of a touch.
    """
    return_share: float = field(default=0.1, metadata={"unit": "1"})
    """Largest speed along the face of a tip that is moved back, as a share of its
    speed. Higher speeds turned objects by several degrees during their slow approach to
    the goal.
    """
    led_on: float = field(default=0.01, metadata={"unit": "m/s"})
    """Largest speed at which one of two pushing tips is advanced into a face on which
    its force is too small.
    """
    off_axle: float = field(default=0.015, metadata={"unit": "m"})
    """Distance of the virtual axle from its planned position that noisy poses can
    resolve.
    """
    least_left: float = field(default=0.02, metadata={"unit": "m"})
    """Remaining path below which nothing is replanned."""
    touch_depth: float = field(default=0.05, metadata={"unit": "m"})
    """Distance of a tip beyond its expected contact at which the object counts as
    absent.
    """
    felt_time: float = field(default=0.03, metadata={"unit": "s"})
    """Duration of a normal force that confirms a touch."""
    settle_time: float = field(default=0.2, metadata={"unit": "s"})
    """Time for which the force of a touch has to persist."""
    sunk: float = field(default=0.005, metadata={"unit": "m"})
    """Depth of a pressing tip below its height on the object's top at which it counts
    as slid off. It exceeds the effect of the object's tilt and the error of its
    believed height.
    """
    longest_touch: float = field(default=2.0, metadata={"unit": "s"})
    """Extra time for a tip that loses its contact during the touch."""
    push_loss_time: float = field(default=0.12, metadata={"unit": "s"})
    """Time without contact force after which a pushing tip returns to the touch.
    Shorter gaps are bridged.
    """
    press_loss_time: float = field(default=0.008, metadata={"unit": "s"})
    """``push_loss_time`` of a press, which must not lose contact."""
    base: float = field(default=0.14, metadata={"unit": "m"})
    """Radius of an arm's lowest link. The object keeps clear of it."""
    retreat: float = field(default=0.06, metadata={"unit": "m"})
    """Distance by which a tip is drawn back on release."""
    longest_stop: float = field(default=4.0, metadata={"unit": "s"})
    """Longest time from a failure to the end of the run, at rest or not."""
    at_rest: float = field(default=0.005, metadata={"unit": "m/s"})
    """Speed below which a tip counts as at rest."""
    rest_time: float = field(default=0.3, metadata={"unit": "s"})
    """Time for which the tips stand still after a failure before they draw back."""
    joint_buffer: float = field(default=0.03, metadata={"unit": "1"})
    """Distance [rad] of a joint from its limit at which the tool's attitude yields. It
    exceeds the 0.02 rad that planned postures keep.
    """
    attitude: float = field(default=0.2, metadata={"unit": "1"})
    """Error [rad] of a tool's attitude above which the restoring moment no longer
    grows.
    """
    mistaken_time: float = field(default=1.0, metadata={"unit": "s"})
    """Time without a path that leads on, of an object that turns otherwise than planned,
    after which the motion ends.
    """
    slow_way: float = field(default=0.1, metadata={"unit": "m"})
    """Way before the goal on which the pose has to be known well."""
    replan_pause: float = field(default=0.4, metadata={"unit": "s"})
    """Shortest time between two successive replans."""

    def shortest(self, speed: float) -> float:
        """Length [m] of the shortest path over which errors are corrected at ``speed``
        [m/s].
        """
        return self.response * speed

    def loss_time(self, kind: str) -> float:
        """Time [s] without contact force after which a tip returns to the touch, by the
        ``kind`` of its contact.
        """
        return self.push_loss_time if kind == "side" else self.press_loss_time

    def look_ahead(self, length: float, speed: float, min_length: float = 0.0) -> float:
        """Look-ahead [m] of a vehicle of the given ``length`` [m], at least
        ``min_length`` [m] if possible.
        """
        wanted = max(LOOK_AHEAD * length, min_length, self.shortest(speed))
        return min(wanted, max(self.longest_look_ahead, self.shortest(speed)))


ARM = ArmMargins()
"""Margins of the shipped arms."""


def side_lean(friction: float) -> float:
    """Largest lean [rad] of a side against which a tip with this ``friction`` can push."""
    return math.atan(SIDE_LEAN * friction)


def rod_radius(tip_radius: float) -> float:
    """Radius [m] of the rod that holds a tip."""
    return min(ROD_RADIUS, ROD_SHARE * tip_radius)


def inset(tip_radius: float) -> float:
    """Distance [m] that a contact keeps from the edges of its face or of the top."""
    return INSET * tip_radius


def drag_ratio(measured: float, expected: float) -> float:
    """Ratio of the ``measured`` to the ``expected`` drag [N], clipped to ``DRAG``."""
    least, most = DRAG
    return min(max(measured / expected, least), most)


def retry_above(share: float, unsure: float) -> float:
    """Share of the goal's tolerances above which an estimated error triggers a retry.

    ``share`` is that of an error known exactly, ``unsure`` the standard deviation of
    the estimate in shares of the tolerances.
    """
    return max(share - 0.5 * unsure, 0.5 * share)


def longest(detour: tuple[float, float], left: float, radius: float) -> float:
    """Longest allowed path [m] of a replan.

    The object has the ``radius`` [m], and ``left`` [m] of the old path remain.
    """
    ratio, slack = detour
    return ratio * left + slack * radius
