"""Bases of bodies: their cells, and the half-space under them."""

import math
from collections import Counter

import numpy as np
import pytest
import shapely
from pydrake.common.value import Value
from pydrake.geometry import ContactSurface
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ExternallyAppliedSpatialForce,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.geometry.shapes import Cylinder, Prism, Shape
from pushpressslide.mechanics.surface_friction import partner_friction
from pushpressslide.sim.contact import solve_contacts
from pushpressslide.sim.plane import (
    add_plane,
    base_meshes,
    base_triangles,
)
from pushpressslide.sim.scenes import add_object, solid_inertia
from pushpressslide.sim.surfaces import softness
from pushpressslide.sim.volume_mesh import VolumeMesh

L_SHAPE = Prism(
    ((0.0, 0.0), (0.16, 0.0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0.0, 0.16)),
    0.06,
)
SHAPES = {
    "cube": Box((0.15, 0.15, 0.15)),
    "bar": Box((0.60, 0.20, 0.10)),
    "rod": Box((0.36, 0.02, 0.08)),
    "triangle": Prism(((-0.07, -0.08), (0.11, -0.02), (-0.05, 0.10)), 0.10),
    "cylinder": Cylinder(0.08, 0.12),
    "L": L_SHAPE,
}
MOST = 250  # triangles of a base: each is a constraint of the simulation


def volumes(mesh: VolumeMesh) -> np.ndarray:
    """Signed volumes (m,) [m^3] of tetrahedra."""
    corners = np.array(mesh.vertices)[np.array(mesh.tetrahedra)]
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0


def surface(mesh: VolumeMesh) -> np.ndarray:
    """Corners (m, 3, 3) [m] of the triangles that one tetrahedron alone has."""
    cells = Counter(
        frozenset(cell) - {left_out} for cell in mesh.tetrahedra for left_out in cell
    )
    faces = [sorted(face) for face, count in cells.items() if count == 1]
    return np.array(mesh.vertices)[np.array(faces)]


def areas(corners: np.ndarray) -> np.ndarray:
    """Areas (m,) [m^2] of triangles."""
    u = corners[:, 1] - corners[:, 0]
    v = corners[:, 2] - corners[:, 0]
    return 0.5 * np.linalg.norm(np.cross(u, v), axis=1)


def base_of(shape: Shape) -> np.ndarray:
    """Corners (m, 3, 3) [m] of the triangles that a body stands on."""
    faces = np.concatenate([surface(mesh) for mesh in base_meshes(shape)])
    base: np.ndarray = faces[(faces[:, :, 2] == -0.5 * shape.height).all(axis=1)]
    return base


@pytest.mark.parametrize("name", SHAPES)
def test_a_base_is_the_footprint_in_few_cells_and_hardly_larger(name: str) -> None:
    shape = SHAPES[name]
    base = base_of(shape)
    assert 40 < len(base) < MOST
    footprint = shape.placed(Pose2()).area
    # at most, by two parts in a hundred of its length
    assert 1.0 < areas(base).sum() / footprint < 1.04


@pytest.mark.parametrize("name", SHAPES)
def test_friction_at_the_cells_has_the_moment_of_the_whole_base(name: str) -> None:
    shape = SHAPES[name]
    base = base_of(shape)
    weights = areas(base)
    places = base.mean(axis=1)[:, :2]
    middle = weights @ places / weights.sum()
    found = np.hypot(*(places - middle).T) @ weights / weights.sum()
    # the mean distance over a fine grid of the footprint
    outline = shape.placed(Pose2())
    xs, ys = (np.linspace(low, high, 1500) for low, high in extent(outline))
    x, y = (grid.ravel() for grid in np.meshgrid(xs, ys))
    inside = shapely.contains_xy(outline, x, y)
    exact = np.hypot(x[inside] - middle[0], y[inside] - middle[1]).mean()
    assert found == pytest.approx(exact, rel=2e-3)


def extent(outline: shapely.Polygon) -> tuple[tuple[float, float], ...]:
    """Least and greatest x, then y [m]."""
    x_min, y_min, x_max, y_max = outline.bounds
    return ((x_min, x_max), (y_min, y_max))


@pytest.mark.parametrize("up", [1.0, -1.0])
@pytest.mark.parametrize("name", SHAPES)
def test_the_parts_fill_a_shape_about_one_vertex_each(name: str, up: float) -> None:
    shape = SHAPES[name]
    meshes = base_meshes(shape, up=up)
    assert all((volumes(mesh) > 0.0).all() for mesh in meshes)
    whole = sum(volumes(mesh).sum() for mesh in meshes)
    expected = areas(base_of(shape)).sum() * shape.height
    assert whole == pytest.approx(expected, rel=1e-3)
    for mesh in meshes:
        # the vertex inside is on no surface, so that the pressure is greatest there
        *_, inside = mesh.vertices
        assert not (surface(mesh) == inside).all(axis=2).any()
        assert 0.5 * shape.height + up * inside[2] == pytest.approx(softness(shape))


def test_cells_cover_a_polygon_once_and_meet_at_whole_edges() -> None:
    corners = SHAPES["triangle"].polygon
    xs = np.linspace(-0.07, 0.11, 8).tolist()
    ys = np.linspace(-0.08, 0.10, 6).tolist()
    flat = base_triangles(corners, xs, ys)
    cut = [shapely.Polygon([flat.points[i] for i in t]) for t in flat.triangles]
    whole = shapely.Polygon(corners)
    assert all(shapely.is_ccw(piece.exterior) for piece in cut)
    assert sum(piece.area for piece in cut) == pytest.approx(whole.area, rel=1e-4)
    assert shapely.union_all(cut).symmetric_difference(whole).area < 1e-6
    around = [[flat.points[i] for i in side] for side in flat.sides]
    ends = np.array([side[0] for side in around])
    np.testing.assert_allclose(ends, corners, atol=1e-6)
    for side in around:
        line = shapely.LineString([side[0], side[-1]])
        assert shapely.LineString(side).length == pytest.approx(line.length)
        assert all(line.distance(shapely.Point(point)) < 2e-6 for point in side)


class Standing:
    """A body alone on a plane."""

    def __init__(self, X: RigidTransform, frame: SupportFrame = TABLE) -> None:
        body = ObjectModel(Box((0.12, 0.08, 0.06)), 0.8, (0.0, 0.0))
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.002)
        solve_contacts(plant)
        self.body = add_object(plant, body, 1.0)
        plane = add_plane(plant, frame, 0.3)
        plane.stand(plant, self.body, body.shape, 1.0)
        plant.Finalize()
        plane.let_bases_stand(plant, scene_graph)
        self.plant = plant
        self.simulator = Simulator(builder.Build())
        root = self.simulator.get_mutable_context()
        self.context = plant.GetMyMutableContextFromRoot(root)
        plant.SetFreeBodyPose(self.context, self.body, X)
        assert solid_inertia(body).get_mass() == 0.8

    def rest(self, duration: float) -> RigidTransform:
        """Return the pose after some time [s]."""
        self.simulator.AdvanceTo(duration)
        return self.plant.EvalBodyPoseInWorld(self.context, self.body)

    def surfaces(self) -> list[ContactSurface]:
        """Return the surface of each contact."""
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        assert results.num_point_pair_contacts() == 0
        contacts = range(results.num_hydroelastic_contacts())
        infos = [results.hydroelastic_contact_info(i) for i in contacts]
        return [info.contact_surface() for info in infos]


def test_an_upright_body_stands_on_its_base_alone() -> None:
    standing = Standing(RigidTransform([0.4, 0.1, 0.03]))
    X = standing.rest(0.2)
    assert X.translation()[2] == pytest.approx(0.03, abs=1e-4)
    (surface,) = standing.surfaces()
    # seven cells by six, and slivers: one an edge of the rim, one more a corner
    assert surface.num_faces() == 2 * 7 * 6 + 2 * (7 + 6) + 4
    gradients = [
        surface.EvaluateGradE_N_W(i) @ surface.face_normal(i)
        for i in range(surface.num_faces())
    ]
    # the normal points out of the body; where the pressure does not rise into it, there
    # is no constraint
    assert sum(gradient < 0.0 for gradient in gradients) == 2 * 7 * 6


def test_a_body_that_has_fallen_over_lies_on_its_side() -> None:
    lying = RigidTransform(RollPitchYaw(0.5 * math.pi, 0.0, 0.3), [0.4, 0.1, 0.041])
    X = Standing(lying).rest(0.6)
    assert X.translation()[2] == pytest.approx(0.04, abs=3e-4)
    assert np.linalg.norm(X.translation()[:2] - [0.4, 0.1]) < 2e-3


def test_a_plane_lies_where_its_frame_says() -> None:
    frame = SupportFrame.of_incline(math.radians(10.0))
    height = frame.point((0.3, 0.0, 0.03))
    R = RollPitchYaw(0.0, -math.radians(10.0), 0.0).ToRotationMatrix()
    X = Standing(RigidTransform(R, height), frame).rest(0.3)
    assert frame.coordinates(tuple(X.translation()))[2] == pytest.approx(0.03, abs=1e-4)


def pushed(time_step: float) -> tuple[float, float]:
    """Force [N] and turn rate [rad/s] of a small, high box pushed at two thirds of its
    height, so that it stands on a third of its base.
    """
    body = ObjectModel(Box((0.032, 0.095, 0.05)), 0.1, (0.0, 0.0))
    place = np.array([0.016, 0.003, 0.005])
    along = np.array([-math.cos(0.1), -math.sin(0.1), 0.0])
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
    solve_contacts(plant)
    box = add_object(plant, body, 1.0)
    plane = add_plane(plant, TABLE, partner_friction(0.4))
    plane.stand(plant, box, body.shape, 1.0)
    plant.Finalize()
    plane.let_bases_stand(plant, scene_graph)
    port = plant.get_applied_spatial_force_input_port()
    builder.ExportInput(port, "push")
    diagram = builder.Build()
    simulator = Simulator(diagram)
    root = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(root)
    plant.SetFreeBodyPose(context, box, RigidTransform([0.0, 0.0, 0.025]))
    force = 0.0
    while root.get_time() < 0.8:
        X = plant.EvalBodyPoseInWorld(context, box)
        V = plant.EvalBodySpatialVelocityInWorld(context, box)
        direction = X.rotation() @ along
        moving = V.Shift(X.rotation() @ place).translational() @ direction
        force = 4.0 * (min(root.get_time(), 0.3) / 0.3 * 0.15 - moving)
        push = ExternallyAppliedSpatialForce()
        push.body_index = box.index()
        push.p_BoBq_B = place
        push.F_Bq_W = SpatialForce(np.zeros(3), force * direction)
        diagram.GetInputPort("push").FixValue(root, Value([push]))
        simulator.AdvanceTo(root.get_time() + time_step)
    return force, float(V.rotational()[2])


def test_what_slides_on_a_part_of_its_base_is_not_braked_by_long_steps() -> None:
    force, turn_rate = pushed(0.004)
    fine_force, fine_turn_rate = pushed(0.001)
    assert force == pytest.approx(fine_force, rel=2e-3)
    assert turn_rate == pytest.approx(fine_turn_rate, rel=2e-2)
    # turning, it takes a little less than the whole of its friction
    assert 0.95 < force / (0.4 * 0.1 * 9.81) < 1.005
