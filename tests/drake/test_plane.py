"""What bodies stand on: their bases in cells, and the half-space under them."""

import math

import numpy as np
import pytest
import shapely
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    DiscreteContactApproximation,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.pose import Pose2
from pushpressslide.core.shapes import Cylinder, Prism
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.sim.plane import SKIN_GAP, add_plane, base_mesh, base_triangles
from pushpressslide.sim.scenes import add_object, mesh_size, softness, solid_inertia

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


def triangles(mesh):
    """Corners (m, 3, 3) [m] of a mesh's faces, larger ones cut into triangles."""
    text = mesh.source().in_memory().mesh_file.contents().decode()
    rows = [line.split() for line in text.splitlines()]
    vertices = np.array([row[1:] for row in rows if row[0] == "v"], dtype=float)
    faces = [[int(i) - 1 for i in row[1:]] for row in rows if row[0] == "f"]
    cut = [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    return vertices[np.array(cut)]


def area_vectors(corners):
    """Area vectors (m, 3) [m^2] of triangles, along their outer normals."""
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


@pytest.mark.parametrize("name", SHAPES)
def test_the_base_of_a_shape_is_its_footprint_in_few_cells(name: str) -> None:
    shape = SHAPES[name]
    corners = triangles(base_mesh(shape))
    base = corners[(corners[:, :, 2] < -0.499 * shape.height).all(axis=1)]
    downwards = -area_vectors(base)[:, 2]
    assert (downwards > 0.0).all()
    assert downwards.sum() == pytest.approx(shape.placed(Pose2()).area, rel=1e-3)
    assert 40 < len(base) < MOST


def test_on_a_wall_the_base_is_where_z_points_to() -> None:
    on_table = area_vectors(triangles(base_mesh(L_SHAPE)))
    on_wall = area_vectors(triangles(base_mesh(L_SHAPE, up=-1.0)))
    outwards = on_wall[on_wall[:, 2] > 0.0][:, 2]
    assert len(outwards) == (on_table[:, 2] < 0.0).sum()
    assert outwards.sum() == pytest.approx(L_SHAPE.placed(Pose2()).area)


@pytest.mark.parametrize("name", SHAPES)
def test_the_skin_is_closed_but_for_a_gap_over_the_base(name: str) -> None:
    shape = SHAPES[name]
    corners = triangles(base_mesh(shape))
    vectors = area_vectors(corners)
    low = corners[:, :, 2].min(axis=1) + 0.5 * shape.height
    assert set(np.round(low[low > 1e-9], 9)) == {SKIN_GAP, shape.height}
    # the area vectors of a closed surface sum to zero, and so do those of a gap
    np.testing.assert_allclose(vectors.sum(axis=0), 0.0, atol=1e-3 * shape.height**2)


def test_cells_cover_a_polygon_once() -> None:
    corners = L_SHAPE.polygon
    cut = [shapely.Polygon(triangle) for triangle in base_triangles(corners, 7, 5)]
    whole = shapely.Polygon(corners)
    assert sum(piece.area for piece in cut) == pytest.approx(whole.area)
    assert shapely.union_all(cut).symmetric_difference(whole).area < 1e-9


class Standing:
    """A body alone on a plane."""

    def __init__(self, X: RigidTransform, frame: SupportFrame = TABLE) -> None:
        body = ObjectModel(Box((0.12, 0.08, 0.06)), 0.8, (0.0, 0.0))
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.002)
        plant.set_contact_model(ContactModel.kHydroelasticWithFallback)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kLagged)
        self.body = add_object(plant, body, 1.0, mesh_size(body.shape))
        plane = add_plane(plant, frame, softness(body.shape), 0.3)
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

    def faces(self) -> list[int]:
        """Return the polygons of each contact."""
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        assert results.num_point_pair_contacts() == 0
        contacts = range(results.num_hydroelastic_contacts())
        infos = [results.hydroelastic_contact_info(i) for i in contacts]
        return [info.contact_surface().num_faces() for info in infos]


def test_an_upright_body_stands_on_its_base_alone() -> None:
    standing = Standing(RigidTransform([0.4, 0.1, 0.03]))
    X = standing.rest(0.2)
    assert X.translation()[2] == pytest.approx(0.03, abs=1e-4)
    (faces,) = standing.faces()
    base = len(base_triangles(Box((0.12, 0.08, 0.06)).corners, 9, 7))
    assert faces == base


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
