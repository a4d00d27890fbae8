"""The non-industrial set: sound as baked, drawn anew without a CAD kernel, never tuned on."""

import subprocess
import sys

import numpy as np
import pytest
from manifold3d import Manifold
from rich.console import Console

from industnerf.artifacts.part import Mesh, load_mesh, load_part
from industnerf.config import read_yaml
from industnerf.errors import BadPart
from industnerf.geometry.raycast import RaycastingScene
from industnerf.parts.catalogue.build import build_catalogue
from industnerf.parts.catalogue.catalogues import CATALOGUE_FOLDERS, load_families
from industnerf.parts.catalogue.entries import (
    install_catalogue_part,
    load_catalogue_mesh,
    read_catalogue,
)
from industnerf.parts.catalogue.organic import FAMILIES
from industnerf.parts.catalogue.organic.face_colors import assemble, color_faces, cut_along_contour
from industnerf.parts.catalogue.organic.forms import level_set, sheet, solid, tube
from industnerf.parts.catalogue.part_builder import build_part
from industnerf.parts.split import assign_splits
from industnerf.parts.validation import checks
from industnerf.schema import SplitParams

FOLDER = CATALOGUE_FOLDERS["organic"]
ENTRIES = {entry.id: entry for entry in read_catalogue(FOLDER)}
every_part = pytest.mark.parametrize("entry", ENTRIES.values(), ids=lambda entry: entry.id)


def bounds(radius):
    return [-1.3 * radius] * 3, [1.3 * radius] * 3


def test_the_set_is_small_broad_and_of_the_families_promised():
    assert 12 <= len(ENTRIES) <= 16
    assert {entry.family for entry in ENTRIES.values()} == {"organic", "thin", "textured"}
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) <= 3_000_000


def test_catalogue_and_families_name_the_same_parts():
    recipes = [
        (family, recipe) for family, family_recipes in FAMILIES.items() for recipe in family_recipes
    ]
    assert sorted(recipe.id for _, recipe in recipes) == sorted(ENTRIES)
    for family, recipe in recipes:
        entry = ENTRIES[recipe.id]
        assert (entry.family, entry.designation) == (family, recipe.designation)
        assert (entry.parameters, entry.finishes) == (recipe.parameters, recipe.palette)


@every_part
def test_each_is_closed_oriented_and_as_catalogued(entry):
    mesh = load_catalogue_mesh(entry, FOLDER)
    checks.require_watertight(entry.id, mesh.vertices, mesh.faces)
    facts = entry.measured
    # the catalogue rounds to ten digits
    assert checks.volume_mm3(mesh.vertices, mesh.faces) == pytest.approx(facts.volume_mm3, rel=1e-9)
    assert checks.extents_mm(mesh.vertices) == pytest.approx(facts.extents_mm, rel=1e-9)
    assert facts.bodies == checks.count_bodies(mesh.faces) == 1
    assert 50 <= max(facts.extents_mm) <= 200
    assert abs(entry.volume_deviation) <= 5e-3  # what industrial parts are held to


@every_part
def test_hardly_a_ray_meets_a_face_from_behind(entry):
    mesh = load_catalogue_mesh(entry, FOLDER)
    scene = RaycastingScene(mesh.vertices, mesh.faces)
    share = checks.back_face_share(
        mesh.vertices, mesh.faces, lambda o, d: scene.cast(o, d).face, views=8, rays_per_side=48
    )
    assert max(share, entry.back_face_share) <= checks.MAX_BACK_FACE_SHARE


@every_part
def test_every_finish_of_the_palette_is_seen(entry):
    mesh = load_catalogue_mesh(entry, FOLDER)
    assert np.array_equal(np.unique(mesh.finish), np.arange(len(entry.finishes)))
    assert len(entry.finishes) <= 8
    assert all(0 <= x <= 0.72 for finish in entry.finishes for x in finish.albedo)


@pytest.mark.parametrize("part_id", ["organic-knot", "thin-leaf", "textured-ball"])
def test_a_part_drawn_anew_is_the_part_that_was_baked(part_id):
    stored = ENTRIES[part_id]
    (recipe,) = (candidate for candidate in FAMILIES[stored.family] if candidate.id == part_id)
    fresh = build_part(stored.family, recipe).entry
    # One machine repeats the bytes; another's sines may differ by a rounding, which moves a vertex
    # by one step of the grid, 1/1024 mm, and the volume by area times that.
    slack = stored.measured.area_mm2 / 1024
    assert fresh.measured.volume_mm3 == pytest.approx(stored.measured.volume_mm3, abs=slack)
    assert fresh.measured.extents_mm == pytest.approx(stored.measured.extents_mm, abs=2 / 1024)
    assert fresh.measured.euler_number == stored.measured.euler_number
    assert fresh.finishes == stored.finishes


def test_one_family_is_built_and_the_others_stay(tmp_path, monkeypatch):
    """Two cheap sculptures stand for the set."""
    names = {"organic": "organic-knot", "textured": "textured-fox"}
    few = {f: [s for s in FAMILIES[f] if s.id == part_id] for f, part_id in names.items()}
    monkeypatch.setattr("industnerf.parts.catalogue.build.load_families", lambda name: few)
    monkeypatch.setenv("INDUSTNERF_RUNNER", "serial")
    console = Console(quiet=True)
    build_catalogue(console, "organic", None, tmp_path)
    before = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.npz")}
    build_catalogue(console, "organic", "textured", tmp_path)
    after = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.npz")}
    assert sorted(after) == ["organic-knot.npz", "textured-fox.npz"]
    assert after["organic-knot.npz"] == before["organic-knot.npz"]
    assert after["textured-fox.npz"] > before["textured-fox.npz"]
    entries = read_catalogue(tmp_path)
    assert [entry.id for entry in entries] == ["organic-knot", "textured-fox"]
    assert load_catalogue_mesh(entries[1], tmp_path).faces.shape == (
        ENTRIES["textured-fox"].measured.faces,
        3,
    )


def test_drawing_needs_no_cad_kernel():
    heavy = ("OCP", "build123d", "bd_warehouse", "py_gearworks", "torch")
    code = (
        "import sys; from industnerf.parts.catalogue.part_builder import build_part;"
        "from industnerf.parts.catalogue.catalogues import *;"
        "build_part(*find_recipe('organic', 'textured-fox'));"
        f"print(*[name for name in {heavy} if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == []


def test_none_of_them_is_ever_dev(tmp_path):
    """Dev is a share of the parts of origin `embedded`: nothing was tuned on this set."""
    entry = ENTRIES["textured-fox"]
    install_catalogue_part(FOLDER, entry, tmp_path)
    part = load_part(tmp_path)
    assert part.origin == "organic"
    assert np.array_equal(load_mesh(tmp_path).faces, load_catalogue_mesh(entry, FOLDER).faces)
    settings = SplitParams(dev_fraction=0.999, folds=3, hold_out="family")
    assert assign_splits([part], settings)[part.part_id].split == "test"


def test_the_preset_reads_the_set(root):
    delta = read_yaml(root / "conf" / "experiment" / "organic.yaml")
    assert delta == {"preset": "organic", "parts": {"path": "data/organic"}}
    assert (root / "data" / "organic").samefile(FOLDER)
    assert list(load_families("organic")) == ["organic", "thin", "textured"]


def test_a_level_set_lies_on_its_surface():
    """A ball of 10 mm: Newton's step leaves a vertex within e^2 / 8 r squared of the surface."""
    ball = level_set(lambda p: 10 - np.linalg.norm(p, axis=1), *bounds(10.0), 1.5)
    vertices = np.asarray(ball.to_mesh64().vert_properties)[:, :3]
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(10.0, abs=1e-6)
    # Chords inside: a triangle of edges up to e misses e^2 / 4 r of the volume's radius at most.
    assert -3 * 1.5**2 / (4 * 10**2) < ball.volume() / (4 / 3 * np.pi * 1000) - 1 < 0


def test_a_torus_has_the_volume_of_pappus():
    """2 pi R times pi r^2; the rings are of the circle's area, so only the R polygon is short."""
    t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    centers = 20 * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    ring = tube(centers, np.full(120, 4.0), 1.0, closed=True)
    # rings spaced by 3 degrees: the polygon is (pi / 120)^2 / 6 = 1.1e-4 short
    assert ring.volume() == pytest.approx(2 * np.pi * 20 * np.pi * 16, rel=1e-3)
    assert ring.genus() == 1


def test_a_tube_has_round_ends():
    centers = np.stack([np.linspace(0, 30, 31), np.zeros(31), np.zeros(31)], axis=1)
    rod = tube(centers, np.full(31, 5.0), 0.5)
    # 62 sides: the ends are polyhedra inside a ball, short by about (2 pi / 62)^2 / 4 = 0.3 %
    assert rod.volume() == pytest.approx(np.pi * 25 * 30 + 4 / 3 * np.pi * 125, rel=3e-3)


def test_a_sheet_is_as_thick_as_it_says():
    x, y = np.meshgrid(np.linspace(0, 30, 11), np.linspace(0, 20, 9), indexing="ij")
    plate = sheet(np.stack([x, y, 0 * x], axis=-1), 1.5)
    assert plate.volume() == pytest.approx(30 * 20 * 1.5, rel=1e-12)
    turn = 2 * np.pi * np.arange(90) / 90
    wall = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1) * [10, 10, 1]
    pipe = np.stack([wall + np.array([0, 0, z]) for z in np.linspace(20, 0, 11)])
    # a prism of 90 sides: (2 pi / 90)^2 / 6 = 0.08 % short of the round one
    body = sheet(pipe, 1.0, is_ring=True)
    assert body.volume() == pytest.approx(2 * np.pi * 10 * 1.0 * 20, rel=1e-3)
    assert body.genus() == 1


def test_a_form_that_is_not_closed_is_refused():
    with pytest.raises(BadPart, match="a form of 2 faces is refused"):
        solid(np.eye(3), np.array([[0, 1, 2], [0, 1, 2]]))


def test_a_cut_keeps_the_surface_and_its_orientation():
    mesh = assemble([Manifold.sphere(10.0, 48)])
    halved = cut_along_contour(mesh, lambda p: p[:, 2] - 3.3, 0)
    checks.require_watertight("ball", halved.vertices, halved.faces)
    assert len(halved.faces) > len(mesh.faces)
    # New vertices lie on old edges: volume and area stay, up to rounding.
    for measured in (checks.volume_mm3, checks.area_mm2):
        before = measured(mesh.vertices, mesh.faces)
        assert measured(halved.vertices, halved.faces) == pytest.approx(before, rel=1e-12)


def test_paint_stops_at_the_contour():
    """A cap above z = 3.3 mm of a ball of 10 mm has the area 2 pi r h."""
    mesh = assemble([Manifold.sphere(10.0, 96)])
    above = lambda p: p[:, 2] - 3.3  # noqa: E731
    two = color_faces(mesh, [above], lambda p: (above(p) > 0).astype(int))
    cap = checks.area_mm2(two.vertices, two.faces[two.finish == 1])
    # Corners nearer than a tenth of an edge (0.65 mm) take the contour: 0.065 mm of 6.7 mm at most.
    assert cap == pytest.approx(2 * np.pi * 10 * 6.7, rel=0.01)
    border = np.intersect1d(two.faces[two.finish == 0], two.faces[two.finish == 1])
    assert np.abs(two.vertices[border, 2] - 3.3).max() <= 0.1 * 0.75  # edges are at most 0.75 mm


def test_paint_covers_what_it_is_asked_to_cover_only():
    left, right = (Manifold.cube((10, 10, 10)).translate((x, 0, 0)) for x in (0, 30))
    mesh = assemble([left, right])
    striped = color_faces(mesh, [lambda p: p[:, 2] - 5], lambda p: np.where(p[:, 2] > 5, 2, 0))
    finish_of_right = striped.finish[striped.triangles[:, :, 0].min(axis=1) > 20]
    assert finish_of_right.tolist() == [1] * 12  # nor is it cut
    area = {
        f: checks.area_mm2(striped.vertices, striped.faces[striped.finish == f]) for f in (0, 2)
    }
    assert area == pytest.approx({0: 300.0, 2: 300.0}, rel=1e-12)


def test_a_carved_face_has_the_finish_of_the_chisel():
    mesh = assemble([Manifold.cube((20, 20, 20))], carved=[Manifold.cube((10, 10, 10))])
    carved = Mesh(mesh.vertices, mesh.faces[mesh.finish == 1], mesh.finish[mesh.finish == 1])
    assert checks.area_mm2(carved.vertices, carved.faces) == pytest.approx(300.0, rel=1e-12)
    assert checks.volume_mm3(mesh.vertices, mesh.faces) == pytest.approx(7000.0, rel=1e-12)
