"""The whole chain: whatever is done to a solid on its way into a file, the solid comes back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from industnerf.artifacts.part import Mesh
from industnerf.errors import BadPart
from industnerf.parts.repair import orient, repair_mesh
from industnerf.parts.validation.checks import area_mm2
from tests.parts.repair.shapes import (
    ball,
    box,
    concatenated,
    flipped,
    scaled,
    select_faces,
    settings,
    triangle_soup,
    tube,
    volume,
)

SOLIDS = {
    "box": [box(finish=3)],
    "tube": [tube()],
    "hollow": [concatenated(box((8, 8, 8)), flipped(box((4, 4, 4))))],
    "assembly": [box(finish=1), scaled(tube(), 1.0, (0, 30, 0)), ball(0.5, (0, 0, 9), finish=2)],
}


def triangles(meshes):
    """Corner positions of all faces, in the order of the faces."""
    return np.concatenate([mesh.triangles for mesh in meshes])


@pytest.fixture(autouse=True)
def few_rays(monkeypatch):
    """Faces of these solids are large; a tenth of the rays does."""
    monkeypatch.setattr(orient, "NUM_BEAMS", 30)
    monkeypatch.setattr(orient, "RAYS_PER_SIDE", 48)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("factor", [1e-6, 1.0, 1e6])
def test_a_sound_mesh_of_any_size_and_place_is_unchanged(name, factor):
    solids = [scaled(mesh, factor, (3 * factor, -7 * factor, 11 * factor)) for mesh in SOLIDS[name]]
    cleaned = repair_mesh(solids, settings())
    assert cleaned.repairs == cleaned.residual_defects == ()
    assert cleaned.open_edges == cleaned.back_face_share == 0
    faces = concatenated(*solids)
    np.testing.assert_array_equal(cleaned.mesh.faces, faces.faces)
    np.testing.assert_array_equal(cleaned.mesh.finish, faces.finish)
    # There and back are two roundings of a coordinate of at most 60 factors.
    np.testing.assert_allclose(
        cleaned.mesh.vertices, faces.vertices, rtol=0, atol=60 * factor * 4e-16
    )


def test_a_solid_1e7_from_the_origin_keeps_its_shape():
    """In float64 that leaves 9 of 16 digits: far more than the weld of 1e-6 asks."""
    mesh = scaled(triangle_soup(ball(1.0)), 1.0, (1e7, 1e7, -1e7))
    cleaned = repair_mesh([mesh], settings())
    assert cleaned.repairs == cleaned.residual_defects == ()
    assert len(cleaned.mesh.vertices) == 162
    assert volume(cleaned.mesh) == pytest.approx(volume(ball(1.0)), rel=1e-7)


@st.composite
def defects(draw):
    """Which solids, and what happens to them on the way; none of it loses the shape."""
    name = draw(st.sampled_from(sorted(SOLIDS)))
    kinds = ("soup", "crack", "turn", "double", "nan", "line", "dirt", "shuffle")
    return name, draw(st.sets(st.sampled_from(kinds))), draw(st.integers(0, 2**32 - 1))


def damaged(mesh: Mesh, kinds: set[str], rng: np.random.Generator, diagonal: float) -> Mesh:
    if "soup" in kinds or "crack" in kinds:
        mesh = triangle_soup(mesh)
    if "crack" in kinds:
        noise = rng.uniform(-1, 1, mesh.vertices.shape)
        mesh = Mesh(mesh.vertices + 1e-7 * diagonal * noise, mesh.faces, mesh.finish)
    if "turn" in kinds:
        mesh = flipped(mesh, rng.random(len(mesh.faces)) < rng.random())
    if "double" in kinds:
        face_indices = np.concatenate(
            [np.arange(len(mesh.faces)), rng.integers(len(mesh.faces), size=9)]
        )
        mesh = select_faces(mesh, face_indices)
    if "shuffle" in kinds:
        mesh = select_faces(mesh, rng.permutation(len(mesh.faces)))
    if "nan" in kinds:  # one lost corner is enough to lose a face
        corner = rng.choice([np.nan, np.inf, -np.inf], (1, 3))
        index = len(mesh.vertices)
        mesh = Mesh(
            np.concatenate([mesh.vertices, corner]),
            np.concatenate([mesh.faces, np.array([[0, 1, index], [index, 2, 3]], np.int32)]),
            np.concatenate([mesh.finish, mesh.finish[:2]]),
        )
    if "line" in kinds:
        flat = select_faces(mesh, rng.integers(len(mesh.faces), size=5))
        flat.faces[:, 1] = flat.faces[:, 0]
        mesh = Mesh(
            mesh.vertices,
            np.concatenate([mesh.faces, flat.faces]),
            np.concatenate([mesh.finish, flat.finish]),
        )
    if "dirt" in kinds:
        corners = mesh.vertices[mesh.faces[:5, 0]]
        mesh = concatenated(
            mesh, *(box(1e-3 * diagonal * np.ones(3), index * 0.5) for index in corners)
        )
    return mesh


@examples(max_examples=16)
@given(defects())
def test_whatever_the_defects_the_solid_comes_back(case):
    name, kinds, seed = case
    rng = np.random.default_rng(seed)
    original = concatenated(*SOLIDS[name])
    diagonal = float(np.linalg.norm(np.ptp(original.vertices, axis=0)))
    cleaned = repair_mesh([damaged(m, kinds, rng, diagonal) for m in SOLIDS[name]], settings())
    assert cleaned.open_edges == 0
    assert cleaned.back_face_share == 0
    assert len(cleaned.mesh.faces) == len(original.faces)
    assert len(cleaned.mesh.vertices) == len(original.vertices)
    # A crack moves corners by up to 1.8e-7 diagonals: of the volume, by less than that times the
    # area times the diagonal, which is at most 30 volumes here.
    tolerance = 1e-5 if "crack" in kinds else 1e-12
    assert volume(cleaned.mesh) == pytest.approx(volume(original), rel=tolerance)
    second = repair_mesh([cleaned.mesh], settings(small_component_area=0.0))
    assert second.repairs == ()
    np.testing.assert_array_equal(second.mesh.faces, cleaned.mesh.faces)


@examples(max_examples=5)
@given(st.integers(0, 2**32 - 1), st.floats(-6, 6), st.floats(-1e3, 1e3))
def test_cleaning_a_moved_and_scaled_mesh_moves_and_scales_the_clean_one(seed, power, shift):
    rng = np.random.default_rng(seed)
    mesh = concatenated(
        flipped(select_faces(ball(), rng.permutation(320)[:280]), slice(0, 100)),
        box((1e-3, 1e-3, 1e-3)),
    )
    factor = 10.0**power
    reference = repair_mesh([mesh], settings())
    moved = repair_mesh([scaled(mesh, factor, (shift * factor, 0, -shift * factor))], settings())
    np.testing.assert_array_equal(moved.mesh.faces, reference.mesh.faces)
    np.testing.assert_allclose(
        moved.mesh.vertices / factor - (shift, 0, -shift),
        reference.mesh.vertices,
        atol=1e3 * 4e-16 * 4,  # of a coordinate of at most 1e3, rounded a few times
    )
    # The words count the same things; a ray that grazes an edge may differ in the last digit.
    assert [message.split(":")[0] for message in moved.repairs] == [
        message.split(":")[0] for message in reference.repairs
    ]


@examples(max_examples=5)
@given(st.integers(0, 2**32 - 1))
def test_the_order_of_the_faces_does_not_matter(seed):
    rng = np.random.default_rng(seed)
    mesh = flipped(select_faces(ball(), rng.permutation(320)[:280]), slice(0, 100))
    order = rng.permutation(280)
    reference = repair_mesh([mesh], settings())
    mixed = repair_mesh([select_faces(mesh, order)], settings())
    np.testing.assert_array_equal(mixed.mesh.faces, reference.mesh.faces[order])
    np.testing.assert_array_equal(mixed.mesh.vertices, reference.mesh.vertices)
    assert mixed.residual_defects == reference.residual_defects


def one_face(corners) -> Mesh:
    return Mesh.with_one_appearance(np.array(corners, float), np.array([[0, 1, 2]], np.int32))


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (one_face(np.zeros((3, 3))), "a diagonal of 0 mm"),
        (one_face(np.eye(3)), "no part has fewer than 2"),
        (one_face(np.full((3, 3), np.nan)), "none of its 1 faces has three finite corners"),
        (
            concatenated(*(one_face(k * np.eye(1, 3)[0] * np.c_[:3]) for k in (1, 2))),
            "lie on a line",
        ),
        (triangle_soup(box((1.0, 1e-8, 1e-8))), "no part has fewer than 2|lie on a line"),
        (Mesh.with_one_appearance(1e307 * box().vertices, box().faces), "a diagonal of inf mm"),
    ],
)
def test_what_is_no_surface_is_refused(mesh, message):
    with pytest.raises(BadPart, match=message):
        repair_mesh([mesh], settings())


def test_a_sheet_without_thickness_loads_and_says_so():
    sheet = Mesh.with_one_appearance(
        np.array([[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]], float),
        np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    cleaned = repair_mesh([triangle_soup(sheet)], settings())
    assert area_mm2(cleaned.mesh.vertices, cleaned.mesh.faces) == pytest.approx(6000)
    assert cleaned.open_edges == 4
    assert cleaned.residual_defects[0] == "open edges: 4"
    assert cleaned.residual_defects[-1] == "flat: a sheet without thickness or volume"
    # Half of all rays meet it from behind, whichever way it is wound.
    assert cleaned.back_face_share == pytest.approx(0.5, abs=0.01)


def test_a_two_sided_sheet_becomes_one_sheet():
    """A plate squeezed to nothing: its two sides are the same faces, wound both ways."""
    cleaned = repair_mesh([triangle_soup(box((3.0, 2.0, 0.0)))], settings())
    assert len(cleaned.mesh.vertices) == 4
    # Two if both sides are cut along the same diagonal, else four that overlap.
    assert len(cleaned.mesh.faces) in (2, 4)
    assert "flat: a sheet without thickness or volume" in cleaned.residual_defects


def test_everything_else_is_named():
    mesh = concatenated(select_faces(box((4, 4, 4)), slice(0, 11)), ball(0.5, (9, 0, 0)))
    cleaned = repair_mesh([mesh], settings())
    assert cleaned.residual_defects[0] == "open edges: 3"
    assert cleaned.residual_defects[1].startswith(
        "rays from outside that meet a face from behind: "
    )
