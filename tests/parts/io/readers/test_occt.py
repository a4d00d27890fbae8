"""STEP, IGES and BREP: solids, instances, colors, units; and what the kernel cannot read."""

import re
from functools import partial
from math import pi

import numpy as np
import pytest

from industnerf.errors import BadPart
from industnerf.parts.io.readers import read_solids, write_solids
from industnerf.parts.validation.checks import area_mm2, volume_mm3
from industnerf.runner import ProcessRunner

pytest.importorskip("OCP", reason="needs the [cad] extra")

from industnerf.parts.io.occt_triangulation import LINEAR_DEFLECTION
from industnerf.parts.io.readers.occt import bounding_box
from industnerf.parts.io.readers.occt_piece import triangulate_piece
from tests.parts.io.readers import drawings
from tests.parts.io.readers.drawings import Drawing


def volumes(solids):
    """Of every solid; its faces come apart, but the divergence theorem does not mind."""
    return [volume_mm3(solid.mesh.vertices, solid.mesh.faces) for solid in solids.solids]


def face_colors(solids, solid=0):
    """The color of each face of one solid."""
    return [solids.finishes[i].name for i in solids.solids[solid].mesh.finish]


@pytest.mark.parametrize(("unit", "stated"), [("MM", "mm"), ("INCH", "inch"), ("M", "m")])
def test_step_comes_in_mm_from_any_unit(tmp_path, unit, stated):
    drawing = Drawing()
    drawing.add(drawings.box(), "block")
    solids = read_solids(drawing.write_step(tmp_path / "a.step", unit), "cm")
    assert solids.unit == f"{stated}, stated"
    assert volumes(solids) == pytest.approx([6000])
    assert solids.solids[0].name == "block"
    assert [finish.name for finish in solids.finishes] == ["unstated"]


@pytest.mark.parametrize(
    ("stated", "units", "scale"), [("INCH", "mm", 1 / 25.4), ("MM", "m", 1000.0), ("MM", "mm", 1.0)]
)
def test_a_stated_unit_can_be_overridden(tmp_path, stated, units, scale):
    """The kernel turns lengths into mm: the numbers in the file count in the other unit."""
    drawing = Drawing()
    drawing.add(drawings.box(), "block")
    path = drawing.write_step(tmp_path / "a.step", stated)
    solids = read_solids(path, units, override_units=True)
    assert volumes(solids) == pytest.approx([6000 * scale**3])
    assert solids.unit == f"{units}, {'stated' if scale == 1 else 'overridden'}"


@pytest.mark.parametrize("odd", [drawings.half_space, drawings.empty_solid])
def test_a_body_without_end_or_extent_is_left_out_with_a_warning(tmp_path, odd):
    both = drawings.compound_of(odd(), drawings.box())
    solids = read_solids(drawings.write_brep(both, tmp_path / "a.brep"), "mm")
    assert volumes(solids) == pytest.approx([6000])
    [warning] = [text for text in solids.warnings if "left out" in text]
    assert warning == "bodies left out, for they have no extent or no end: 1"


def test_a_face_whose_triangles_miss_its_area_is_named(tmp_path):
    invalid = drawings.cylinder_with_a_cone_for_its_wall(10.0, 20.0, 8.0)
    both = drawings.compound_of(drawings.box(), invalid)
    solids = read_solids(drawings.write_brep(both, tmp_path / "a.brep"), "mm")
    [warning] = solids.warnings
    assert warning.startswith(
        "faces whose triangles miss the area that the drawing gives them by more than 5%, so the "
        "drawing is invalid there: 2 (face 1 near ("
    )
    meshed, exact = map(float, re.findall(r"has (\S+) of (\S+) mm\u00b2", warning)[0])
    assert exact == pytest.approx(2 * pi * 10 * 20, rel=1e-3)
    assert meshed < 0.95 * exact


def test_an_invalid_face_is_repaired_where_the_kernel_can(tmp_path):
    plate = drawings.plate_with_a_hole(10.0, 4.0)
    solids = read_solids(drawings.write_brep(plate, tmp_path / "a.brep"), "mm")
    (solid,) = solids.solids
    assert area_mm2(solid.mesh.vertices, solid.mesh.faces) == pytest.approx(100 - 16)
    assert "bodies with invalid faces that the kernel repaired: 1" in solids.warnings
    assert not any("miss the area" in warning for warning in solids.warnings)


def test_a_repaired_face_keeps_its_color():
    plate = drawings.plate_with_a_hole(10.0, 4.0)
    mesh = triangulate_piece(
        plate, bounding_box(plate), lambda face: np.full(3, 0.3 if face.IsSame(plate) else np.nan)
    )
    assert mesh.is_repaired
    np.testing.assert_array_equal(mesh.albedo, np.full((len(mesh.faces), 3), 0.3))


def test_the_usual_facets_miss_no_area():
    """Of a small ball on a large plate, too, whose facets are as coarse as the plate's."""
    both = drawings.compound_of(drawings.box(500.0, 500.0, 1.0), drawings.ball(0.5))
    mesh = triangulate_piece(both, bounding_box(both), lambda face: np.zeros(3))
    assert (mesh.num_unmeshed, mesh.wrong_areas, mesh.is_repaired) == (0, (), False)


@pytest.mark.parametrize("radius", [0.05, 500.0])
def test_the_mesh_is_as_fine_as_the_size_requires(tmp_path, radius):
    drawing = Drawing()
    drawing.add(drawings.ball(radius), "ball")
    solids = read_solids(drawing.write_step(tmp_path / "ball.step"), "mm")
    # A chord error of CHORD diagonals of the box, 2 sqrt(3) radii, takes off at most three such
    # shares of the volume, and never adds any.
    share = volumes(solids)[0] / (4 / 3 * pi * radius**3)
    assert 1 - 3 * LINEAR_DEFLECTION * 2 * np.sqrt(3) < share < 1


def test_an_assembly_has_a_solid_for_every_place(tmp_path):
    drawing = Drawing()
    bolt = drawing.add(drawings.box(1, 2, 3), "bolt", (1, 0, 0))
    pair, whole = drawing.assembly("pair"), drawing.assembly("whole")
    drawing.add_component(pair, bolt, 0)
    drawing.add_component(pair, bolt, 10, angle=pi / 2)
    for x in (0, 100, 200):
        drawing.add_component(whole, pair, x)
    solids = read_solids(drawing.write_step(tmp_path / "whole.stp"), "mm")
    assert volumes(solids) == pytest.approx(6 * [6])
    low = sorted(tuple(np.round(s.mesh.vertices.min(axis=0), 6)) for s in solids.solids)
    # turned by 90 degrees about z, the box of 1 x 2 reaches from -2 to 0 in x
    expected = [(x + dx, 0.0, 0.0) for x in (0, 100, 200) for dx in (0, 8)]
    np.testing.assert_allclose(low, expected, atol=1e-6)
    assert {name for i in range(6) for name in face_colors(solids, i)} == {"#ff0000"}


def test_colors_of_faces_go_before_those_of_parts_and_of_places(tmp_path):
    drawing = Drawing()
    shape = drawings.box()
    part = drawing.add(shape, "part", (0, 0, 128 / 255))
    drawing.color_face(shape, 5, (1, 0, 0))  # the kernel's last face is the top
    bare = drawing.add(drawings.box(1, 1, 1), "bare")
    whole = drawing.assembly("whole")
    drawing.add_component(whole, part, 0, color=(0, 1, 0))
    drawing.add_component(whole, bare, 100, color=(0, 1, 0))
    solids = read_solids(drawing.write_step(tmp_path / "a.step"), "mm")
    mesh = solids.solids[0].mesh
    on_top = (mesh.triangles[:, :, 2] > 9.99).all(axis=1)
    assert face_colors(solids) == ["#ff0000" if top else "#000080" for top in on_top]
    assert on_top.sum() == 2
    assert set(face_colors(solids, 1)) == {"#00ff00"}


def test_solids_of_one_part_and_loose_faces_are_bodies_of_their_own(tmp_path):
    box, other = drawings.box(), drawings.translated(drawings.box(5, 5, 5), 100)
    faces = list(drawings.faces_of(drawings.translated(drawings.box(2, 2, 2), 200)))[:2]
    path = drawings.write_brep(drawings.compound_of(box, other, *faces), tmp_path / "a.brep")
    solids = read_solids(path, "cm")
    assert solids.format == "BREP"
    assert solids.unit == "cm, assumed"
    assert [len(s.mesh.faces) for s in solids.solids] == [12, 12, 4]
    assert volumes(solids)[:2] == pytest.approx([6000e3, 125e3])
    assert solids.warnings == ("bodies that are shells or loose faces, not solids: 1",)
    assert [s.name for s in solids.solids] == ["solid 1", "solid 2", "solid 3"]


def test_iges_in_mm_with_its_color(tmp_path):
    drawing = Drawing()
    drawing.add(drawings.box(), "block", (1, 0, 0))
    solids = read_solids(drawing.write_iges(tmp_path / "a.igs"), "inch")
    assert (solids.format, solids.unit) == ("IGES", "mm, stated")
    points = np.concatenate([s.mesh.vertices for s in solids.solids])
    assert np.ptp(points, axis=0) == pytest.approx((30, 20, 10))
    assert sum(len(s.mesh.faces) for s in solids.solids) == 12
    assert [finish.name for finish in solids.finishes] == ["#ff0000"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("words.step", b"these are words"),
        ("head.step", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
        ("cut.step", b"ISO-10303-21;\nHEADER;\n"),
        ("words.igs", b"these are words"),
        ("words.brep", b"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nwords"),
    ],
)
def test_what_the_kernel_cannot_read_is_one_sentence(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadPart, match=f"^{name}: .*"):
        read_solids(tmp_path / name, "mm")


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["step", "igs", "brep"])
def test_torn_files_cost_themselves_only(tmp_path, suffix):
    """Cut short and with flipped bits: read, refused, or the end of one child process.

    The kernel does hang on some torn BREP files: the time limit ends them.
    """
    drawing = Drawing()
    drawing.add(drawings.compound_of(drawings.box(), drawings.ball(9)), "both", (1, 0, 0))
    write = {"step": drawing.write_step, "igs": drawing.write_iges}.get(
        suffix, partial(drawings.write_brep, drawings.compound_of(drawings.box(), drawings.ball(9)))
    )
    whole = write(tmp_path / f"whole.{suffix}").read_bytes()
    rng = np.random.default_rng(0)
    works = []
    for i in range(18):
        data = bytearray(whole[: rng.integers(1, len(whole))] if i % 3 == 0 else whole)
        for at in rng.integers(0, len(data), 0 if i % 3 == 0 else 1 + i):
            data[at] ^= 1 << rng.integers(8)
        (tmp_path / f"{i}.{suffix}").write_bytes(bytes(data))
        (tmp_path / f"out{i}").mkdir()
        works.append(partial(write_solids, tmp_path / f"{i}.{suffix}", "mm", tmp_path / f"out{i}"))
    outcomes = list(ProcessRunner(2).map(works, 15.0, 4096))
    assert len(outcomes) == len(works)
    errors = [outcome.error for outcome in outcomes if outcome.error is not None]
    assert not [error for error in errors if "\n" in error]
    ended = ("crashed", "timed out") if suffix == "brep" else ("crashed",)
    assert not [e for e in errors if f".{suffix}: " not in e and not e.startswith(ended)]
