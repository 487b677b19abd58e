"""The paper's experiments with two arms: shipped tasks and the paper's statements.

The paper states no figures for them.
"""

from __future__ import annotations

from pushpressslide_studies.paper.experiment import (
    Experiment,
    Settled,
    Variant,
    Verdict,
)

TWO_ARMS = Experiment(
    name="two-arms",
    title="Two arms: parallel, orthogonal, on top",
    source="Section III, cases 3 to 5",
    claim="Two rear pushes are a car, pushes at right angles and two presses are quasi-holonomic: a wrench "
    "at the CoM is allocated to both arms in closed form. No figure is given.",
    variants=(
        Variant(
            "parallel",
            "Two rear pushes",
            "parallel-push",
            why="Both forces from one wrench on the surface, neither a pull.",
        ),
        Variant(
            "orthogonal",
            "Pushes at right angles",
            "orthogonal-push",
            why="The path stays inside the cone of what they can give.",
        ),
        Variant(
            "on-top",
            "Two presses on top",
            "bimanual-slide",
            why="Moments about the centre of pressure, shear by the room in each cone.",
        ),
    ),
    why="Each wrench is the exact surface's for the wanted twist, about the centre of pressure, and is "
    "divided among the arms inside both friction cones, or else brought to the nearest "
    "one that can be. "
    "Pushes at right angles can give few wrenches, so that the path is planned inside "
    "their cone.",
    pictured=("parallel", "orthogonal", "on-top"),
)

PIVOT_AND_MOVE = Experiment(
    name="pivot-and-move",
    title="Pivot and move",
    source="Section IV-C, bimanual pivot and move",
    claim="A box of 60 x 80 x 70 cm is turned by 90 degrees about the centre of pressure that the left arm's "
    "press has drawn towards itself, while the right arm pushes; then the left arm "
    "pushes it into a slot "
    "between two boxes of its size. No figure is given.",
    variants=(
        Variant(
            "run",
            "The box into its slot",
            "pivot-and-move",
            why="The right arm pushes a face: by friction on top the load could hardly be shifted.",
        ),
        Variant(
            "tight",
            "10 mm a side in place of 20, from another start",
            "pivot-and-move",
            (
                "obstacles.0.pose.y=0.66",
                "obstacles.1.pose.y=-0.56",
                "start.x=0.44",
                "start.yaw_deg=2",
            ),
            why="Replanned from where the box is at the second touch.",
        ),
    ),
    why="Masses and friction are not in the paper; box, arms, their distance and the slot are the paper's. "
    "Here both arms push the box into the slot, in the paper the left one, the other "
    "holding on.",
    pictured=("run",),
    settled=(
        Settled(
            "The left arm alone pushes the box into the slot, the right one holds on",
            Verdict.not_run,
            "Here both arms push.",
        ),
        Settled(
            "The slot is tight",
            Verdict.unstated,
            "The paper does not give the clearance, the masses or the friction.",
        ),
    ),
)

PRESS_FIT = Experiment(
    name="press-fit",
    title="Press and fit",
    source="Section IV-D, bimanual press-fit",
    claim="Two arms press an object of 25 x 25 x 80 cm to a wall, slide it along, turn it until it is "
    "horizontal, and press it into its place in the wall. No figure is given.",
    variants=(
        Variant(
            "run",
            "The object into its place",
            "press-fit",
            why="The normal forces carry the weight by friction; yaw and place are fed back.",
        ),
        Variant(
            "tight",
            "10 mm a side in place of 15",
            "press-fit",
            ("support.opening.size=[0.82, 0.27]", "goal.y=-0.01"),
            why="As above.",
        ),
    ),
    why="Against a wall the weight acts in the plane and only the arms press: they hold it by friction on "
    "both sides. Masses and friction are not in the paper.",
    pictured=("run",),
    settled=(
        Settled(
            "The object fits into its place",
            Verdict.unstated,
            "The paper does not give the clearance, the masses or the friction.",
        ),
    ),
)
