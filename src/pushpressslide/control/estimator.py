"""Estimate of the object's state and parameters from stamped poses, commanded motion
and contact forces.

``RunOptions.estimator`` passes another estimator to a run. It must have the two
functions of ``Estimator``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.correction import touched_point
from pushpressslide.control.felt_center import felt_center, with_felt_center
from pushpressslide.control.following import BoundLaws, Prediction
from pushpressslide.control.hand_eye import HandEye
from pushpressslide.control.pose_filter import ARM, Advance, FilterState, PoseFilter
from pushpressslide.control.sightings import Estimated, PictureComparison, Sightings
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.plan import Contact, Segment
from pushpressslide.core.pose import Point, Pose2, cross, wrap_angle
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.sensing import Sensing
from pushpressslide.core.twist_path import integrate
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.center import SURE, CenterState
from pushpressslide.identification.drag import DragIdentifier, DragState
from pushpressslide.identification.felt_drag import FeltDrag
from pushpressslide.identification.online import AxleState
from pushpressslide.identification.parameter_estimates import (
    NOTHING,
    ParameterEstimates,
)
from pushpressslide.kernels.leading import corrected
from pushpressslide.modes import MODES
from pushpressslide.rom.drives import PressedDrive, RearSteerDrive

# [m], [rad] of noise that may remain in the object's pose: the mean of as many
# measurements as it takes, up to 1 / LEAST_GAIN
POSE_NOISE = 2e-4
YAW_NOISE = math.radians(0.08)
LEAST_GAIN = 0.1
STEEPEST = math.atan(0.5)  # [rad] of the line to the centre of friction from the belief
# error of the line of an object that is turned by a force off it, as a share of the angle
SKEWED = 0.4
# smallest factor on ARM, across a line to the centre of mass that turns have told
LEARNT = 0.7
# largest standard deviation of a line that pictures have told, as a share of that before
TOLD = 0.7
NEAR = 5e-3  # [m] before its estimated place, from where a tip may touch an object
OFF_REACH = 0.15  # share by which an axle is off before it contradicts the plan
# [s] per [rad] of noise of the yaw: in this time two thirds of a correction are followed
SMOOTHED = 8.0
LONGEST_SMOOTHED = 0.3  # [s]
ONE_CONTACT = (PressedDrive, RearSteerDrive)  # whose turns tell the line to the contact
NO_TWIST = Twist(0.0, 0.0, 0.0)


class Estimate(NamedTuple):
    """Estimated state and parameters of the object at a time."""

    time: float  # [s]
    X_WG: Pose2
    twist: Twist = NO_TWIST  # in B
    parameters: ParameterEstimates = NOTHING  # rho only where it is identified now
    age: float = 0.0  # [s] of the last pose that was measured, and used
    # standard deviations [m], [rad] of the pose
    spread: tuple[float, float] = (0.0, 0.0)
    # [m] from where the only tip is measured to where it is seen to be, world
    tip_error: Point = (0.0, 0.0)

    def from_tip(self, X_WB: Pose2) -> Pose2:
        """Pose of an object at ``X_WB`` relative to the only tip as it is measured."""
        x, y = self.tip_error
        if x == 0.0 == y:
            return X_WB
        return Pose2(X_WB.x - x, X_WB.y - y, X_WB.yaw)


class Observation(NamedTuple):
    """Input of an estimator at a tick."""

    time: float  # [s]
    pose: StampedPose | None  # None: nothing new
    commanded_twist: Twist  # commanded to the object since the last tick, in B
    driven: bool  # whether the tips are to move the object now
    tips: tuple[TipState, ...]  # as measured
    binding: BoundLaws  # the followed segment with its laws
    prediction: Prediction  # prediction of the plan
    disturbed: bool = False  # whether tips touch or let go of the object
    lets_go: bool = False  # whether they let go of it
    unfelt: tuple[int, ...] = ()  # those of several contacts that are not felt


class Estimator(Protocol):
    """An estimator without mutable attributes. The caller keeps its state."""

    def start(self, pose: StampedPose) -> Any:
        """State at the start of a placement, with the object at the measured ``pose``."""
        ...

    def step(self, state: Any, observation: Observation) -> tuple[Estimate, Any]:
        """Estimate at a tick, and the next state. It never raises."""
        ...


class EstimatorState(NamedTuple):
    """State of the estimator between ticks."""

    pose: StampedPose  # the last one that was measured
    time: float  # [s] of the last tick
    X_WG: Pose2 | None = None  # as estimated at the last tick; None before the first
    prediction: Prediction = Prediction()  # reference of the next two fields
    axle: AxleState = AxleState()  # state of the virtual axle's identification
    center: CenterState = CenterState()  # the same of the CoM
    felt: FeltDrag = FeltDrag()  # what two tips feel of drag and CoM
    estimates: ParameterEstimates = NOTHING  # estimates from all of these
    filtered: Filtered | None = None  # None: poses are used as they come
    drag: DragState = DragState()  # for the result alone
    sightings: Sightings = Sightings()  # for the result alone


class Began(NamedTuple):
    """When the first tip began to move the object."""

    X_WG: Pose2
    place: float  # [m] standard deviation of the pose's place
    tip: Point  # [m] as measured


class Filtered(NamedTuple):
    """A filter of the pose with its state."""

    filter: PoseFilter
    state: FilterState
    segment: Segment  # followed at the last tick
    place: Point  # [m] in B of the first tip's centre
    tips: tuple[Point, ...]  # [m] of the contacts at the last tick
    spread: tuple[float, float]  # [m], [rad] standard deviations of place and yaw
    # corrections [m], [m], [rad] of the pose that are still to be followed
    ahead: tuple[float, float, float] = (0.0, 0.0, 0.0)
    smoothed: float = 0.01  # [s] in which they are followed
    began: Began | None = None
    # of the first tip where it began to move the object, and where it last did
    hand_eye: HandEye = HandEye()
    hand_eye_now: HandEye | None = None
    # state of the filter when the tips last moved the object in pictures
    touched: FilterState | None = None
    unsure: float = math.inf  # [rad] standard deviation of the line before the touch

    @property
    def X_WG(self) -> Pose2:
        """The pose now, which follows corrections smoothly: arms follow it."""
        x, y, yaw = self.ahead
        now = self.state.present
        return self.filter.pose(
            now._replace(x=now.x - x, y=now.y - y, yaw=now.yaw - yaw)
        )

    def step(self, observation: Observation, dt: float) -> Filtered:
        """The filter after a tick of ``dt`` [s]."""
        tips = _tips(observation)
        advance = Advance(
            observation.time,
            dt,
            disturbed=observation.disturbed,
            lets_go=observation.lets_go,
            unled=bool(observation.unfelt),
        )
        if observation.driven and observation.unfelt:
            advance = advance._replace(tip=self._led(observation, tips))
        elif observation.driven:
            (x, y), (before_x, before_y) = tips[0], self.tips[0]
            moved = (x - before_x, y - before_y)
            turn = _turn(self.tips, tips)
            advance = advance._replace(tip=moved, turn=turn, tips=tips)
        elif observation.disturbed and self.filter.along is not None:
            advance = advance._replace(tip=self._pushed(tips[0]), touching=True)
        segment = observation.binding.segment
        before = self._redirected(segment)
        state = self.filter.step(before, advance, observation.pose)
        predicted = before.present.after(advance, self.filter.along)
        kept = math.exp(-dt / self.smoothed)
        x, y, yaw = self.ahead
        ahead = (
            kept * x + state.present.x - predicted.x,
            kept * y + state.present.y - predicted.y,
            kept * yaw + wrap_angle(state.present.yaw - predicted.yaw),
        )
        began = None
        if observation.driven:
            X_WG = self.filter.pose(self.state.present)
            began = self.began or Began(X_WG, self.spread[0], self.tips[0])
        spread = self.spread
        hand_eye = self.hand_eye
        hand_eye_now = self.hand_eye_now
        touched = self.touched
        if state.covariance is not self.state.covariance:
            spread = self.filter.spread(state)
            if began is not None:
                begun = self._hand_eye_begun(state, began)
                known = self.filter.hand_eye or HandEye()
                hand_eye = begun if begun.plausible else known
                hand_eye_now = self._hand_eye_now(state, tips[0])
                touched = state
        return Filtered(
            self.filter,
            state,
            segment,
            self.place,
            tips,
            spread,
            ahead,
            self.smoothed,
            began,
            hand_eye,
            hand_eye_now,
            touched,
            self.unsure,
        )

    def _led(self, observation: Observation, tips: Sequence[Point]) -> Point:
        """Displacement [m] of the first tip that is felt. None is: none."""
        for i, (before, now) in enumerate(zip(self.tips, tips, strict=True)):
            if i not in observation.unfelt:
                return (now[0] - before[0], now[1] - before[1])
        return (0.0, 0.0)

    def _hand_eye_begun(self, state: FilterState, began: Began) -> HandEye:
        """Where the tip was when it ``began`` to move the object, beside where it was
        measured.
        """
        x, y = began.X_WG.apply(self.filter.place(state.present))
        offset = (x - began.tip[0], y - began.tip[1])
        covariance = self.filter.tip_covariance(state) + began.place**2 * np.eye(2)
        return HandEye.from_axes(offset, covariance, began.X_WG.yaw)

    def _hand_eye_now(self, state: FilterState, tip: Point) -> HandEye:
        """Where a measured ``tip`` is now, if it has not slid."""
        now = state.present
        offset = (now.x - tip[0], now.y - tip[1])
        return HandEye.from_axes(offset, state.covariance[:2, :2], 0.0)

    @property
    def seen_tip(self) -> HandEye | None:
        """Where the first tip is seen beside where it is measured, for another placement.
        None if it has not moved the object in pictures, or its offset is not plausible.
        """
        if self.hand_eye_now is None or self.hand_eye.xx == 0.0:
            return None
        first = self.hand_eye.elsewhere()
        now = self.hand_eye_now.elsewhere()
        # a press creeps, and a push may slide: then only the first says where it is
        pushes = self.filter.along is not None
        sticks = pushes and now.plausible and now.agrees(first)
        return now if sticks else first

    def _pushed(self, tip: Point) -> Point:
        """Displacement [m] by which a ``tip`` that touches may move the object: none
        before it is near the object.
        """
        now = self.state.present
        assert self.filter.along is not None
        tx, ty = Pose2(0.0, 0.0, now.yaw).rotate(self.filter.along)
        nx, ny = ty, -tx
        x, y = tip
        off_x, off_y = self.hand_eye.offset
        x += off_x
        y += off_y
        beyond = (x - now.x) * nx + (y - now.y) * ny + NEAR
        before_x, before_y = self.tips[0]
        ahead = min(beyond, (tip[0] - before_x) * nx + (tip[1] - before_y) * ny)
        return (ahead * nx, ahead * ny) if ahead > 0.0 else (0.0, 0.0)

    def touch_offset(
        self, across: Point, X_GB: Pose2, radius: float
    ) -> tuple[float, float]:
        """Distance [m] along a unit vector in G by which the first tip, of a ``radius``
        [m], has touched beside where it is followed, and its standard deviation.
        """
        if self.touched is None:
            return 0.0, 0.0
        off, deviation = self.filter.touch_offset(self.touched, across)
        x, y = self.segment.contacts[0].tip_place(radius)[0]
        followed = X_GB.rotate((x - self.place[0], y - self.place[1]))
        return off - followed[0] * across[0] - followed[1] * across[1], deviation

    @property
    def tells_line(self) -> bool:
        """Whether pictures have told the line to the centre of mass."""
        return self.filter.line(self.state)[1] < TOLD * self.unsure

    def touches_anew(self, before: Filtered | None) -> bool:
        """Whether the tips have begun to touch, or to let go, in this tick, ``before``
        which they did not.
        """
        if before is None:
            return False
        return self.state.disturbed and not before.state.disturbed

    def tips_seen(self, before: Filtered) -> tuple[Point, ...]:
        """Places [m] of the tips at the stamp of the picture that this tick has used,
        ``before`` which they were known. Empty if they did not drive the object then.
        """
        ahead = len(before.state.advances) - len(self.state.advances)
        if ahead < 0:
            return ()
        if ahead == len(before.state.advances):
            return self.tips
        return before.state.advances[ahead].tips

    def _redirected(self, segment: Segment) -> FilterState:
        """The filter's state with the turn arm that ``segment`` has beside that of the
        last tick: a press turns an object otherwise in another direction.
        """
        was, drive = self.segment.drive, segment.drive
        if drive is was:
            return self.state
        if not (isinstance(was, PressedDrive) and isinstance(drive, PressedDrive)):
            return self.state
        scale = abs(_ahead(self.segment, self.place) / _ahead(segment, self.place))
        return self.filter.rescaled(self.state, drive.skew - was.skew, scale)

    def center(
        self,
        before: CenterState,
        segment: Segment,
        X_BG: Pose2,
        belief: CenterBelief,
        followed: Point,
    ) -> CenterState:
        """``before`` with the centre of mass where the turns of the object show it,
        across the line from the origin of B to the only contact. Along it, it is that of
        the ``followed`` plan [m] in B.

        A line that is skewed is that of the model as much as of the centre: each has the
        share of its variance, that of the centre according to the ``belief``.
        """
        contacts = segment.contacts
        drive = segment.drive
        if contacts[0].point == (0.0, 0.0) or not isinstance(drive, ONE_CONTACT):
            return before
        x, y = contacts[0].point
        angle, deviation = self.filter.line(self.state)
        off = wrap_angle(angle + X_BG.yaw - math.atan2(y, x) - drive.skew)
        if drive.skew != 0.0:
            lever = math.hypot(x, y)
            across = X_BG.unrotate((-y / lever, x / lever))
            believed = (belief.deviation(across) / lever) ** 2
            skewed = (SKEWED * drive.skew) ** 2
            share = believed / (believed + skewed)
            off *= share
            deviation = math.sqrt(deviation * deviation + share * skewed)
        turned = -math.tan(min(max(off, -STEEPEST), STEEPEST))
        along = (followed[0] * x + followed[1] * y) / (x * x + y * y)
        turned *= 1.0 - along
        center = (along * x - turned * y, along * y + turned * x)
        return before._replace(center=center, off=deviation, filtered=True)

    def with_reach(
        self, estimates: ParameterEstimates, segment: Segment
    ) -> ParameterEstimates:
        """The ``estimates`` with the distance from the contact to the axle, if it
        contradicts that of a followed ``segment``.
        """
        planned = MODES[segment.mode].reach(segment)
        if planned is None:
            return estimates
        reach, deviation = self.filter.reach(self.state)
        contact = segment.contacts[0].point
        reach += abs(_ahead(segment, contact)) - abs(_ahead(segment, self.place))
        allowed = max(OFF_REACH * planned, SURE * deviation)
        if abs(reach - planned) < allowed:
            return estimates
        return estimates._replace(reach=reach, elsewhere=True)


class ObjectEstimator:
    """Corrects a predicted pose by the measured one. Identifies virtual axle, rho, drag
    and CoM while the object is driven.
    """

    def __init__(self, query: MotionQuery) -> None:
        """Bind to the believed object and sensors of ``query``."""
        self._query = query
        self._X_GB = query.X_GB
        self._X_BG = self._X_GB.inverse()
        self._gain = pose_gain(query.sensing)
        self._sensing = query.sensing
        self._uses_every_pose = query.sensing.every_pose
        self._radius = query.scene.body.radius
        self._radii = [robot.tip_radius for robot in query.scene.robots]
        self._center_error = query.scene.center_error
        opening = query.scene.support.opening
        self._friction_alone = query.resisted_by_friction_alone and opening is None
        self._pictures = PictureComparison(query)
        self._hand_eye: HandEye | None = None
        self._center = CenterBelief.before_run(query.scene)

    def know_tip(self, hand_eye: HandEye | None) -> None:
        """Start with what other placements have told of the first tip's ``hand_eye``
        offset. None: nothing.
        """
        self._hand_eye = hand_eye

    def know_center(self, center: CenterBelief) -> None:
        """Start with what other placements have told of the ``center`` of mass."""
        self._center = center

    def start(self, pose: StampedPose) -> EstimatorState:
        """State without identified parameters."""
        return EstimatorState(pose, pose.time)

    def step(
        self, state: EstimatorState, observation: Observation
    ) -> tuple[Estimate, EstimatorState]:
        """Estimate at a tick, and the next state."""
        time = observation.time
        pose = observation.pose or state.pose
        filtered = None
        used = pose.time
        spread = (0.0, 0.0)
        tip_error = (0.0, 0.0)
        if self._uses_every_pose:
            X_WG = self._pose(state, observation)
        else:
            filtered = self._filtered(state, observation)
            X_WG = filtered.X_WG
            used = filtered.state.used
            spread = filtered.spread
            if len(observation.binding.segment.contacts) == 1:
                tip_error = filtered.hand_eye.offset
        predicted = observation.prediction
        axle = state.axle
        center = state.center
        found = state.estimates
        if predicted is not state.prediction:
            axle, center = _carried_over(state, predicted)
        sightings = self._sightings(state, observation, filtered)
        drag = state.drag
        felt = state.felt
        if observation.driven:
            X_WB = X_WG.compose(self._X_GB)
            axle, center = _identified(axle, center, X_WB, observation)
            if self._friction_alone and len(observation.binding.segment.contacts) > 1:
                felt = _felt(felt, X_WB, observation, time - state.time)
            drag = _dragged(drag, center, X_WB, observation)
        else:
            drag = DragIdentifier.paused(drag)
        # walls and bodies turn an object, too: a centre that is sure is not learnt
        learning = filtered if self._center_error > 0.0 else None
        if learning is not None:
            segment = observation.binding.segment
            followed = predicted.followed_center
            center = learning.center(
                center, segment, self._X_BG, self._center, followed
            )
        anew = filtered is not None and filtered.touches_anew(state.filtered)
        if observation.driven or anew or predicted is not state.prediction:
            found = _estimates(predicted, axle, center)
            segment = observation.binding.segment
            if len(segment.contacts) > 1:
                found = self._with_felt(found, felt, segment)
            if learning is not None:
                found = learning.with_reach(found, segment)
        twist = observation.commanded_twist
        estimate = Estimate(time, X_WG, twist, found, time - used, spread, tip_error)
        return estimate, EstimatorState(
            pose,
            time,
            X_WG,
            predicted,
            axle,
            center,
            felt,
            found,
            filtered,
            drag,
            sightings,
        )

    def _with_felt(
        self, estimates: ParameterEstimates, felt: FeltDrag, segment: Segment
    ) -> ParameterEstimates:
        """The ``estimates`` with drag and centre of mass as two tips feel them."""
        estimates = estimates._replace(drag=felt.drag)
        center = felt_center(felt, segment, self._query, self._center)
        return with_felt_center(estimates, center, segment)

    def _sightings(
        self,
        state: EstimatorState,
        observation: Observation,
        filtered: Filtered | None,
    ) -> Sightings:
        """What pictures have told after a tick, beside the pose."""
        picture = observation.pose
        sightings = state.sightings
        if picture is None or picture.time <= state.pose.time:
            return sightings
        if filtered is not None:
            sightings = sightings.arrived(picture.time, observation.time)
        if not self._pictures.due(sightings, picture):
            return sightings
        places: tuple[Point, ...] = ()
        estimated = Estimated(picture.X_WG)
        if filtered is None:
            places = _tips(observation) if observation.driven else ()
        elif state.filtered is not None and filtered.state.used == picture.time:
            places = filtered.tips_seen(state.filtered)
            X_WG = filtered.filter.pose(filtered.state.mean)
            estimated = Estimated(X_WG, filtered.spread[1], filtered.hand_eye.offset)
        return self._pictures.step(
            sightings, picture, estimated, places, observation.binding, observation.tips
        )

    def _filtered(self, state: EstimatorState, observation: Observation) -> Filtered:
        """The filter after a tick. It starts at the first tick of a placement."""
        if state.filtered is not None:
            return state.filtered.step(observation, observation.time - state.time)
        segment = observation.binding.segment
        first = segment.contacts[0]
        place, _ = first.tip_place(self._radii[first.arm])
        arm, doubt = (0.0, 0.0), None
        if isinstance(segment.drive, ONE_CONTACT):
            arm = self._X_GB.rotate(_turn_arm(segment, place))
            doubt = self._arm_covariance(segment, arm)
        own = PoseFilter.for_sensing(
            self._sensing,
            self._X_GB.apply(place),
            self._radius,
            arm,
            doubt,
            _face(first, self._X_GB),
            self._hand_eye,
        )
        started = own.start(state.pose)
        smoothed = min(max(0.01, SMOOTHED * self._sensing.yaw_noise), LONGEST_SMOOTHED)
        tips = _tips(observation)
        spread = own.spread(started)
        hand_eye = self._hand_eye or HandEye()
        return Filtered(
            own,
            started,
            segment,
            place,
            tips,
            spread,
            smoothed=smoothed,
            hand_eye=hand_eye,
            unsure=own.line(started)[1],
        )

    def _arm_covariance(self, segment: Segment, arm: Point) -> Array:
        """Covariance (2, 2) [rad^2/m^2] of the believed turn ``arm`` in G. The centre of
        mass is known along the line to a segment's only contact, and across it. The
        more is learnt of it, the surer is the model.
        """
        x, y = segment.contacts[0].point
        center_x, center_y = segment.drive.center
        lever = math.hypot(x - center_x, y - center_y)
        ex, ey = self._X_GB.rotate(((x - center_x) / lever, (y - center_y) / lever))
        size = math.hypot(*arm)
        ax, ay = arm[0] / size, arm[1] / size
        center = self._center
        planned_x, planned_y = self._X_GB.position
        off = (center.x - planned_x, center.y - planned_y)
        P = np.zeros((2, 2))
        for line, axis in (((ex, ey), (ax, ay)), ((-ey, ex), (-ay, ax))):
            deviation = center.deviation(line)
            beside = off[0] * line[0] + off[1] * line[1]
            error = math.hypot(math.sqrt(2.0) * deviation, beside)
            unsure = size * error / lever
            model = ARM / self._radius
            if center.before > 0.0:
                model *= max(LEARNT, min(deviation / center.before, 1.0))
            P += (unsure * unsure + model * model) * np.outer(axis, axis)
        return P

    def _pose(self, state: EstimatorState, observation: Observation) -> Pose2:
        """X_WG predicted from the motion since the last tick.

        The measured pose corrects the prediction, unless the camera missed the object.
        """
        measured = observation.pose
        before = state.X_WG
        if before is None:
            return (measured or state.pose).X_WG
        if measured is not None and self._gain == 1.0:
            return measured.X_WG
        at_com = observation.commanded_twist.moved_to((0.0, 0.0))
        dt = observation.time - state.time
        X_WB = before.compose(self._X_GB)
        predicted = integrate(X_WB, (at_com.vx, at_com.vy, at_com.w), dt)
        if measured is None:
            return predicted.compose(self._X_BG)
        filtered = measured.X_WG.compose(self._X_GB)
        pose = corrected(
            (predicted.x, predicted.y, predicted.yaw),
            (filtered.x, filtered.y, filtered.yaw),
            self._gain,
        )
        return Pose2(*pose).compose(self._X_BG)


def pose_gain(sensing: Sensing) -> float:
    """Fraction of the prediction's error that a measured pose corrects.

    It is 1 without noise, and less if the noise exceeds POSE_NOISE or YAW_NOISE.
    """
    noise = max(sensing.position_noise / POSE_NOISE, sensing.yaw_noise / YAW_NOISE)
    return min(1.0, max(LEAST_GAIN, 1.0 / max(noise * noise, 1e-12)))


def filtered_noise(sensing: Sensing) -> tuple[float, float]:
    """Standard deviations [m], [rad] of an object at rest whose poses ``pose_gain``
    filters. 0 if not every control period has a pose.
    """
    if not sensing.every_pose:
        return (0.0, 0.0)
    gain = pose_gain(sensing)
    share = math.sqrt(gain / (2.0 - gain))
    return (share * sensing.position_noise, share * sensing.yaw_noise)


def stamped(measurement: Measurement) -> StampedPose:
    """Pose in a measurement, with the time at which it was measured.

    The pose is either new or the last one received.
    """
    time = measurement.pose_time
    return StampedPose(
        measurement.time if time is None else time,
        measurement.object_pose,
        measurement.pictures,
    )


def _tips(observation: Observation) -> tuple[Point, ...]:
    """Places [m] of the tips at the contacts."""
    contacts = observation.binding.segment.contacts
    places = (observation.tips[contact.arm].position for contact in contacts)
    return tuple((x, y) for x, y, _ in places)


def _turn(before: Sequence[Point], now: Sequence[Point]) -> float:
    """Turn [rad] of the line from the first tip to the second. 0 of a single tip."""
    if len(now) == 1:
        return 0.0
    was, is_now = (
        math.atan2(second[1] - first[1], second[0] - first[0])
        for first, second, *_ in (before, now)
    )
    return wrap_angle(is_now - was)


def _face(contact: Contact, X_GB: Pose2) -> Point | None:
    """Unit vector in G along the face that a contact pushes. None of a press."""
    if contact.normal is None:
        return None
    nx, ny = X_GB.rotate(contact.normal)
    return -ny, nx


def _ahead(segment: Segment, place: Point) -> float:
    """Signed distance [m] of a ``place`` in B ahead of a segment's axle."""
    return segment.X_VB.apply(place)[0]


def _turn_arm(segment: Segment, place: Point) -> Point:
    """Believed turn arm [rad/m] in B of the ``place`` of the tip at a segment's only
    contact: the axle moves along its heading, however the object turns.
    """
    reach = _ahead(segment, place)
    ex, ey = segment.X_BV.rotate((1.0, 0.0))
    return ex / reach, ey / reach


def _carried_over(
    state: EstimatorState, prediction: Prediction
) -> tuple[AxleState, CenterState]:
    """Identification state of virtual axle and CoM that remains valid when the plan's
    predictions change.
    """
    axle = state.axle
    center = state.center
    before = state.prediction
    if prediction.axle is not before.axle:
        axle = AxleState(drag=axle.drag)
    if prediction.center is not before.center and before.center is not None:
        center = before.center.carry_over(center)
    return axle, center


def _identified(
    axle: AxleState, center: CenterState, X_WB: Pose2, observation: Observation
) -> tuple[AxleState, CenterState]:
    """Identification state of virtual axle and CoM after a tick in which the first
    contact drives the object.
    """
    binding = observation.binding
    contact = binding.segment.contacts[0]
    tip = observation.tips[contact.arm]
    force = X_WB.unrotate(tip.force[:2])
    time = observation.time
    predicted = observation.prediction
    if predicted.axle is not None:
        axle = predicted.axle.step(axle, time, X_WB, force)
    if predicted.center is not None:
        touched = touched_point(binding.sides[0], X_WB, tip)
        center = predicted.center.step(center, time, X_WB, force, touched)
    return axle, center


def _felt(felt: FeltDrag, X_WB: Pose2, observation: Observation, dt: float) -> FeltDrag:
    """What two tips feel, after a tick of ``dt`` [s] in which they move the object."""
    binding = observation.binding
    drive = binding.segment.drive
    rho = drive.rho
    if rho is None:
        return felt
    contacts = binding.segment.contacts
    first, second = (observation.tips[contact.arm] for contact in contacts)
    x, y, _ = first.position
    apart_x, apart_y = second.position[0] - x, second.position[1] - y
    vx, vy, _ = first.velocity
    off_x, off_y = second.velocity[0] - vx, second.velocity[1] - vy
    w = (apart_x * off_y - apart_y * off_x) / (apart_x**2 + apart_y**2)
    forces = [X_WB.unrotate(tip.force[:2]) for tip in (first, second)]
    touched = binding.contact_points(X_WB, observation.tips)
    wrench = Wrench(
        math.fsum(fx for fx, _ in forces),
        math.fsum(fy for _, fy in forces),
        math.fsum(map(cross, touched, forces)),
    )
    twist = Twist(*X_WB.unrotate((vx, vy)), w, X_WB.unapply((x, y)))
    return felt.step(wrench, twist.moved_to((0.0, 0.0)), drive.center, rho, dt)


def _dragged(
    drag: DragState, center: CenterState, X_WB: Pose2, observation: Observation
) -> DragState:
    """State of the drag's identification after a tick in which the first contact drives
    the object.
    """
    identifier = observation.prediction.drag
    if identifier is None:
        return drag
    binding = observation.binding
    tip = observation.tips[binding.segment.contacts[0].arm]

    def lever() -> Point:
        """The contact [m] from the centre of mass, in B."""
        x, y = touched_point(binding.sides[0], X_WB, tip)
        return (x - center.center[0], y - center.center[1])

    force = X_WB.unrotate(tip.force[:2])
    return identifier.step(drag, observation.time, X_WB, force, lever)


def _estimates(
    predicted: Prediction, axle: AxleState, center: CenterState
) -> ParameterEstimates:
    """Identified parameters that contradict the plan: virtual axle and CoM. An
    identified axle comes with rho.
    """
    identified = None
    if predicted.axle is not None:
        identified = predicted.axle.identified(axle)
    place = center.center
    elsewhere = False
    if predicted.center is not None:
        followed = predicted.followed_center
        elsewhere = predicted.center.contradicts(center, followed)
        if not elsewhere:  # the plan is not contradicted
            place = followed
    rho = None if identified is None else identified.rho
    return ParameterEstimates(
        identified, rho, axle.drag, place, center.off, elsewhere=elsewhere
    )
