"""The one table of physical margins: distances to limits in plans and control, and
thresholds for small, slow or off-path.

A margin that concerns the physics of the object is dimensionless. It is an angle, a
fraction of the friction, a length divided by the radius of the object
(``ObjectModel.radius``) or of the tip, or a time divided by the time that a length
takes at a speed. Margins that depend on the arm and its sensors have units and are in
``ArmMargins``: a small object makes no arm quicker. Quasi-static motions therefore
scale. If every length is multiplied by k, the forces by any factor and the speeds by
sqrt(k), those of the arm included, the plan is the same (tests/modes/test_scaling.py).

Numbers that only set the resolution of a computation stay where they are used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

# --- where contacts may be

INSET = 0.6
"""Tip radii from a contact to the edges of its face or of the top: a tip that rolls or
creeps by half of that is still on it.
"""
CREEP = 0.15
"""Tip radii by which a pushing tip may creep along a side before it is put back."""
CREPT_TURN = 0.25
"""[rad] by which the side's normal may turn within that: half of a usual friction angle.
A push on the fillet of a corner would leave its cone.
"""
LEAST_LEVER = 0.25
"""Radii of the object: the least lever of a push about a pinned point. With less, what
the push's place is wrong by matters more than the push.
"""
SIDE_LEAN = 0.35
"""Tangent of a pushed side's lean over the tip's friction: the friction that is left in
the plane is a tenth smaller at most.
"""
ROD_RADIUS = 0.008
"""[m] of the steel rod between flange and tip."""
ROD_SHARE = 0.4
"""Of the tip's radius, at most, for its rod: that of a small tip must not come near to
what the tip touches.
"""
SURE_LEVER = 4.0
"""Times the distance by which the centre of mass may be elsewhere: the least lever of a
press that steers. With that the heading is wrong by a quarter of a radian at most, which
the way there tells.
"""
PATCH = 0.16
"""Of a tip's radius: the arm of the friction by which the patch under a press holds the
object's turn, two thirds of the patch's own radius. Where the drag about the centre of
pressure has less moment the object turns as the tool does, whatever the force: no
vehicle is steered so.
"""
HELD_TURN = 8.0
"""Of the drag's moment: as much of the patch's friction a turn may have, which the tool
makes along with the object. Of 31 random objects of 50 to 160 g those with up to 9.5
came within 1.7 mm and 1 degree of their goals, the two with more missed by 5 and 9.5.
"""
LEVER_SHARE = 0.5
"""Of the longest lever about a pinned point: places with less are left out."""
OVER_EDGE = 0.3
"""Tip radii by which a pushing tip's centre may be above the object's upper edge, where
its force leans down by the arcsine of that: 17 degrees.
"""
OVER_EDGE_FRICTION = 0.7
"""Of the tip's friction: the same for a smooth tip, whose force stays inside its cone."""
WIDTHS = (1.0, 0.8, 0.6, 0.4, 0.25)
"""Of the room on a face: half the distances of two contacts on it that are tried."""

# --- tipping: half widths of the base

TIPPING_MARGIN = 0.15
"""That the centre of pressure stays inside the base's edge: the pressure's own
uncertainty, and what a drag that is a tenth higher moves it by.
"""
PUSH_TIPPING_MARGIN = 0.05
"""Of the height at which a pushed object tips, that its contact stays below. Up to there
pushes reach their goals as they do lower down: the axle is read from the pressure as
the push leaves it.
"""
PUSH_STANDS = 0.8
"""Of that height by Coulomb's law alone, up to which tools stay upright: nearer to it the
object tips where it turns. Tools that lean back touch it lower.
"""
SAFE_MARGIN = 0.5
"""Inside the base's edge from which on an object is driven at full speed: nearer to it
the pressure, and with it the virtual axle, changes quickly.
"""
EDGE_MARGIN = 0.3
"""That the centre of pressure stays inside the edge of a table: as at the base's own edge,
and as much again for an object that is off its path.
"""
LEAN = 0.15
"""By which a weight in the plane may move the centre of pressure."""

# --- friction: shares

FRICTION_USES = (0.7, 0.8, 0.9, 0.96)
"""Of a contact's friction that a motion may take, the best first: what is left is for
the servo, and for a friction that is less than believed.
"""
PIN_USES = (0.5, 0.6, *FRICTION_USES)
"""The same of a press that holds a point in its place: what it slips, it keeps."""
CORRECTION_USE = 0.9
"""Of the friction, that corrections within a cone may use."""
PREFERRED_USE = 0.8
"""Of the friction, within which forces are kept where the wrench leaves a choice."""
CONE_USE = 0.93
"""Measured utilisation beyond which the steering is eased."""
HARDER = 1.3
"""Times as hard tips press where the friction turns out too little: two where the
drag's lever takes more of it, and one that crept.
"""
SPARE_LOAD = 0.02
"""Of the load, that the lighter of two presses carries beyond the least for a turn on
the spot.
"""
SQUEEZE = 1.6
"""Times the drag that one of two contacts may push with: more is spent against the
other.
"""
GIVEN = 1e-3
"""Of a wanted wrench: less that contacts can give counts as this."""

# --- cones and steering: angles and shares

CONE_MARGIN = math.radians(6.0)
"""That a planned twist stays inside its motion cone: the limit surface's own error, and
room for corrections.
"""
BENT_MARGIN = math.radians(12.0)
"""The same of every piece of a way of several twists, where there is such a way: the
shortest goes along the cone's edge, where a correction to the outside has no room.
"""
REPLAN_MARGIN = math.radians(2.0)
"""The same of a plan made under way, from a pose and contacts that were seen."""
AMPLE_MARGIN = math.radians(30.0)
"""Inside the cone, from which on a placement with less force is the better one."""
STEERING_RESERVE = 0.12
"""Of a rear push's cone, kept from either edge for the servo and the model."""
STEERING_SHARE = 0.85
"""Of the tightest curve of a pushed car, that steering may ask for."""
PLANNED_STEERING = 0.6
"""Of the steering of a pressed vehicle, that a plan's turns use."""
CORRECTING = math.radians(14.0)
"""That a force must be free to turn on a run-in, so that errors decay on it."""
AXLE_SLIP = math.radians(6.0)
"""Of a virtual axle, sideways: more is not followed like a unicycle's."""
FIRM = 0.5
"""Least change of a pressed contact's direction per change of its force's."""
PUSHED_SPEED = 0.8
"""Of the speed, of a vehicle that is pushed: what is ahead of the contact swings more."""
SWING = 1.2
"""Times the axle's speed that a pressed contact may move at; tighter turns are slower."""
CONTACT_PACE = math.hypot(1.0, SWING)
"""Times motion.speed that a contact moves at, at most: along and across the heading."""
PACE = (0.6, 5.0)
"""Speed of a pressed contact over the speed of the axle, within which turns are used."""
FARTHEST_AXLE = 3.0
"""Radii of the object, from the centre of pressure: a virtual axle beyond is not used,
its place is too sensitive to the pressure's.
"""
STRAIGHTEST = 0.006
"""Curvature times the object's radius, below which a turn counts as straight: over a
way of ten radii it is off by 0.3 radii, which the run-in takes.
"""
CORRECTED = 0.02
"""Radii of the object: the lateral error that all of a turn's steering is used for."""
MISSED = 0.1
"""Radii of the object: the error that is left where a run-in begins, above which other
turns are sought: it decays by no more than ten times on a run-in.
"""
LOOK_AHEAD = 0.35
"""Lengths of a pressed vehicle: its look-ahead, where the arm allows it. Longer ones
correct less, shorter ones swing the contact more.
"""
ROLLED = 0.25
"""Of a press's distance from the CoM: its heading axis turns by no more than that is
steered.
"""
CREPT = 0.2
"""Of a press's distance from the CoM, above which a single one is taken anew: a tip
creeps along its force, and pushed towards the CoM it ends where the drag tips the
object.
"""

# --- ways

LOOP_RATIO = 1.6
"""Times the direct way, and LOOP_SLACK on top: a longer way has turned a loop."""
LOOP_SLACK = 0.25
"""Radii of the object."""
LOOP_FOR_RUN_IN = 1.25
"""Times the shortest loop of a push, that one may take for a longer run-in: where it
ends in a turn, what it is off there stays.
"""
LONGEST_LOOP = 2.5
"""Radii of the object: what a path of a vehicle that was asked for may be longer than
one without a loop.
"""
DETOUR = (1.1, 0.05)
"""Times the way that is left, and radii of the object: what a plan made under way may
take.
"""
TOUCH_DETOUR = (1.2, 0.25)
"""The same after a touch, where object and contact are as they were found."""
RUN_INS = (3.0, 2.0)
"""Look-aheads of straight end after the turns of a manoeuvre."""
RUN_INS_UNSURE = (6.0, 4.5)
"""The same where the centre of mass may be elsewhere: on the way it is seen where it is,
and then the heading is corrected.
"""
VEHICLE_RUN_INS = (5.0, 3.0, 1.5)
"""The same after the path of one vehicle; the longest that fits is taken."""
LEAST_RUN_IN = 0.75
"""Of the shortest straight end that is planned, that a run-in keeps under way."""
BACK_UPS = (0.0, 2.5, 5.0, 7.5)
"""Look-aheads that a vehicle first goes back straight, where the goal is too near."""
CAR_LOOK_AHEAD = 2.0
"""Shortest ways over which the arm corrects: the look-ahead of a pushed car."""
CAR_RUN_IN_UNSURE = 1.0
"""Of ``motion.run_in``: the least straight end of a rear push, where the centre of mass
may be elsewhere.
"""
CAR_RUN_INS = (1.0, 0.5, 0.25)
"""Of ``motion.run_in``: the straight ends of a pushed car that are tried."""
RUN_INS_ONWARD = (1.0, 0.5, 0.25, 0.125)
"""Of the planned straight end of a rear push, on a path made under way: what is left of
the old one is no room for the turns to a new one.
"""
REST_TO_REST = 1.2
"""Times speed over acceleration: what a turn that begins and ends at rest takes
besides.
"""
NARROW = 1.3
"""Radii of the object over the speed: the time that a turn with little steering to
correct it has to save to be taken.
"""
LONGEST = 0.75
"""Of ``limits.time``, that a manoeuvre may take: the rest is for another attempt."""

# --- contact and speed

TOUCH_SHARE = 0.4
"""Of the force that would move the object, pressed before the motion."""
LOSS_SHARE = 0.6
"""Of its planned load, below which a press counts as lost."""
KEPT_SHARE = 0.5
"""Of the force that tells of a contact, which tells that it is still there."""
LEAST_SHARE = 0.2
"""Of its planned force, below which a push counts as lost."""
HELD_SHARE = 0.1
"""Of what two tips push with, that each of them is led on to feel: one that feels less
parts from its face as soon as the object turns a little more than planned.
"""
FELT_SIGMAS = 4.0
"""Standard deviations of a force sensor's noise, from which on a contact is felt."""
LOSS_SIGMAS = 6.0
"""Standard deviations of the mean force between a contact that holds and one that counts
as lost: one false loss in 10^9 measurements.
"""
FLOOR_SPEED = 0.12
"""Of ``motion.speed``: the least speed while the goal is not reached."""

STALL = 0.05
"""Of ``motion.speed``: the mean speed below which an object stands still."""

POSTURE_SPEED = 0.4
"""Of a joint's velocity limit: how fast the posture is led to another one in contact."""
DRAG = (0.5, 2.5)
"""Of the drag that was believed: what is measured counts within these bounds."""
SURE_DRAG = 0.05
"""Of the drag that was believed, that what is measured may be off as the mean of a force
that steers: less is no reason to plan with another friction.
"""

# --- what counts as there: shares of the task's tolerances

RETRY_ABOVE = 0.97
"""Of both tolerances: final errors beyond it trigger a retry."""
RETRY_ABOVE_SEATED = 0.3
"""The same in an opening: the fall into it pushes the object off its path."""
TOOL_ASIDE = 0.2
"""Of ``tolerance.position``, that a tool may be off the straight push."""
ASKEW = math.radians(2.0)
"""Of a tool's face, from the straight push, while it pushes."""
SQUARE = math.radians(20.0)
"""That the sides of a tool's body may be turned against the tool's face."""


@dataclass(frozen=True, slots=True)
class ArmMargins:
    """Margins set by arms, tools and sensors, independent of the object."""

    response: float = field(default=0.8, metadata={"unit": "s"})
    """In which the servo has an object's motion where it is wanted: a law that corrects
    over less than the way of that time asks for forces that come too late.
    """
    longest_look_ahead: float = field(default=0.1, metadata={"unit": "m"})
    """The arm's reach has no room for run-ins of longer ones."""
    quick: float = field(default=0.3, metadata={"unit": "s"})
    """The same as ``response`` of an object that tips hold from above."""
    turn_rate: float = field(default=0.8, metadata={"unit": "1/s"})
    """Of a pushed object: beyond it the tip slips where the steering jumps."""
    steering_time: float = field(default=0.4, metadata={"unit": "s"})
    """In which the steering of a push goes from one arc to the next: a tip that is led
    aside at once slides along the face of a light object, and hammers it.
    """
    regrasp: float = field(default=10.0, metadata={"unit": "s"})
    """Of a placement beside its motion: the way there, the touch, the release."""
    felt_force: float = field(default=0.05, metadata={"unit": "N"})
    """Of a contact, that a sensor without noise is sure of."""
    least_friction: float = field(default=0.5, metadata={"unit": "N"})
    """Of an object that two tips push: below it one tip alone moves it off the other."""
    least_press: float = field(default=3.0, metadata={"unit": "N"})
    """Below it a contact is not felt for sure, and bounces."""
    firm_lever: float = field(default=0.004, metadata={"unit": "m"})
    """From the centre of pressure to a press that steers: its heading turns by a quarter
    of a radian for each millimetre that the tip creeps.
    """
    table_gap: float = field(default=0.006, metadata={"unit": "m"})
    """Of a pushing tip above the support."""
    tool_gap: float = field(default=0.01, metadata={"unit": "m"})
    """The same, where there is a choice."""
    wrist_gap: float = field(default=0.04, metadata={"unit": "m"})
    """Of the flange above the object's top."""
    low: float = field(default=0.04, metadata={"unit": "m"})
    """Height of a push, where the tool is long enough: low, so that nothing tips, and
    high enough that the hand clears the support.
    """
    tool_room: float = field(default=0.06, metadata={"unit": "m"})
    """Between two tips that push, for the tools that hold them."""
    hand_room: float = field(default=0.1, metadata={"unit": "m"})
    """Between two tips that press, for the hands above them."""
    leaving: float = field(default=0.05, metadata={"unit": "m"})
    """Of way from a start or goal that is nearer to an obstacle than motion.clearance, on
    which the gap that is asked for grows to it.
    """
    waiting: float = field(default=0.05, metadata={"unit": "m"})
    """That an arm without a contact keeps from all else, where it can: half of what the
    object may be ``beside`` its planned way.
    """
    touch_speed: float = field(default=0.03, metadata={"unit": "m/s"})
    """Of a tip on the last centimetres before a contact."""
    pressing: float = field(default=0.4, metadata={"unit": "s"})
    """Until a typical press has its load."""
    approach: float = field(default=5.0, metadata={"unit": "s"})
    """From the home posture to before the touch, typically; the planar engine begins
    there.
    """
    settling: float = field(default=1.8, metadata={"unit": "s"})
    """Of lining up, believing the touch, and drawing back."""
    slid: float = field(default=0.0025, metadata={"unit": "m"})
    """Of a contact, before a replan: what the measured tip and pose resolve.
    """
    off_path: float = field(default=0.001, metadata={"unit": "m"})
    """The same of the object from its path."""
    off_heading: float = field(default=math.radians(1.0), metadata={"unit": "1"})
    """The same of its heading [rad]."""
    off_line: float = field(default=math.radians(2.0), metadata={"unit": "1"})
    """Of the line from the centre of mass to a contact [rad], before the centre counts
    as elsewhere: the virtual axle's own change with the force looks like a degree.
    """
    off_line_unsure: float = field(default=math.radians(0.5), metadata={"unit": "1"})
    """The same where the belief says that the centre of mass may be elsewhere [rad]."""
    stop: float = field(default=2e-4, metadata={"unit": "m"})
    """Of path left, at which the motion ends."""
    astray: float = field(default=0.1, metadata={"unit": "m"})
    """Of the tracking point from its path: the run is given up. The joint path that was
    planned along it is of no use any more.
    """
    via: float = field(default=0.02, metadata={"unit": "m"})
    """That a pose on the way may be missed by: the arms still find their next contacts."""
    turned_via: float = field(default=math.radians(5.0), metadata={"unit": "1"})
    """The same of its yaw [rad]."""
    near_plan: float = field(default=0.1, metadata={"unit": "m"})
    """Of an object from its planned way, within which the arms' joints can follow."""
    turned_beside: float = field(default=0.4, metadata={"unit": "1"})
    """The same of its yaw [rad]."""
    stall_time: float = field(default=5.0, metadata={"unit": "s"})
    """In which an object that is led has to move, or the run is given up."""
    retouch: float = field(default=0.012, metadata={"unit": "m"})
    """Of slid contact, and of path left, above which a tip lets go and touches the
    planned place again: what a touch costs is the arm's.
    """
    slid_side: float = field(default=0.003, metadata={"unit": "m"})
    """Off its contact along the face, above which one of two pushing tips is led back:
    what touching it leaves.
    """
    return_share: float = field(default=0.1, metadata={"unit": "1"})
    """Of its speed, at most, at which one of two pushing tips is led back along the face:
    more of it turned objects by degrees while they crawled up to the goal.
    """
    led_on: float = field(default=0.01, metadata={"unit": "m/s"})
    """At most, of one of two pushing tips that is led on into a face it hardly feels."""
    off_axle: float = field(default=0.015, metadata={"unit": "m"})
    """Of the virtual axle from where it is planned: what noisy poses tell apart."""
    least_left: float = field(default=0.02, metadata={"unit": "m"})
    """Remaining path below which nothing is replanned."""
    touch_depth: float = field(default=0.05, metadata={"unit": "m"})
    """Beyond an expected contact, at which the object counts as not there."""
    felt_time: float = field(default=0.03, metadata={"unit": "s"})
    """Of normal force, before a touch is believed."""
    settle_time: float = field(default=0.2, metadata={"unit": "s"})
    """That the force of a touch must hold."""
    sunk: float = field(default=0.005, metadata={"unit": "m"})
    """Below where a tip rests on top of an object, at which it is beside it: more than
    an object tilts by, or is believed too high.
    """
    longest_touch: float = field(default=2.0, metadata={"unit": "s"})
    """Beyond the way to a contact, that a tip which loses it again may go on trying."""
    push_loss_time: float = field(default=0.12, metadata={"unit": "s"})
    """Without contact force before a pushing tip goes back to touch: it rides over a
    gap.
    """
    press_loss_time: float = field(default=0.008, metadata={"unit": "s"})
    """The same of a press, which must not."""
    base: float = field(default=0.14, metadata={"unit": "m"})
    """Radius of an arm's lowest link, which the object keeps off."""
    retreat: float = field(default=0.06, metadata={"unit": "m"})
    """That a tip is drawn back on release."""
    longest_stop: float = field(default=4.0, metadata={"unit": "s"})
    """After a failure until the run ends, at rest or not."""
    at_rest: float = field(default=0.005, metadata={"unit": "m/s"})
    """Of a tip that counts as at rest."""
    rest_time: float = field(default=0.3, metadata={"unit": "s"})
    """That the tips stand still before they draw back, after a failure."""
    joint_buffer: float = field(default=0.03, metadata={"unit": "1"})
    """Of a joint to its limit [rad], inside which the tool's attitude gives way to keep
    it there: more than the 0.02 that planned postures keep.
    """
    attitude: float = field(default=0.2, metadata={"unit": "1"})
    """Of a tool from its wanted attitude [rad], beyond which it is turned no harder."""
    replan_pause: float = field(default=0.4, metadata={"unit": "s"})
    """Between two plans made under way."""

    def shortest(self, speed: float) -> float:
        """Shortest path [m] over which errors are corrected at ``speed`` [m/s]."""
        return self.response * speed

    def loss_time(self, kind: str) -> float:
        """Time [s] without contact force before a tip of a contact of a ``kind``
        returns to the touch.
        """
        return self.push_loss_time if kind == "side" else self.press_loss_time

    def look_ahead(self, length: float, speed: float, min_length: float = 0.0) -> float:
        """Look-ahead [m] of a vehicle of some ``length`` [m], at least ``min_length``
        [m] if possible.
        """
        wanted = max(LOOK_AHEAD * length, min_length, self.shortest(speed))
        return min(wanted, max(self.longest_look_ahead, self.shortest(speed)))


ARM = ArmMargins()
"""Those of the shipped arms."""


def side_lean(friction: float) -> float:
    """Lean [rad] of a side up to which a tip of a ``friction`` pushes it."""
    return math.atan(SIDE_LEAN * friction)


def rod_radius(tip_radius: float) -> float:
    """Radius [m] of the rod that holds a tip."""
    return min(ROD_RADIUS, ROD_SHARE * tip_radius)


def inset(tip_radius: float) -> float:
    """Distance [m] of a contact inside the edges of its face or of the top."""
    return INSET * tip_radius


def drag_ratio(measured: float, expected: float) -> float:
    """Ratio of the ``measured`` drag [N] to the ``expected`` one, clipped to ``DRAG``."""
    least, most = DRAG
    return min(max(measured / expected, least), most)


def longest(detour: tuple[float, float], left: float, radius: float) -> float:
    """Longest allowed path [m] of a replan with ``left`` [m] remaining, for an object
    of a ``radius`` [m].
    """
    ratio, slack = detour
    return ratio * left + slack * radius
