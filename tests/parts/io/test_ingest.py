"""The solids of a file to a part folder."""

import numpy as np
import pytest

from industnerf.artifacts.part import UNSPECIFIED, Appearance, load_mesh, load_part
from industnerf.artifacts.part_warnings import load_part_warnings
from industnerf.artifacts.solids import Solid, Solids
from industnerf.errors import BadArtifact, BadPart
from industnerf.parts.io.ingest import ingest, used_appearances
from tests.parts.repair.shapes import (
    ball,
    box,
    flipped,
    scaled,
    select_faces,
    settings,
    triangle_soup,
)

RED = Appearance("red", (0.5, 0.0, 0.0), 0.0, 0.5)
BLUE = Appearance("blue", (0.0, 0.0, 0.5), 0.0, 0.5)


@pytest.fixture
def folder(tmp_path):
    """A box, and an inside-out ball away from it, of the second and the third of three finishes."""
    solids = (
        Solid("plate", triangle_soup(box(finish=1))),
        Solid("knob", flipped(ball(4.0, (0, 0, 12), finish=2))),
    )
    file = Solids("a.stl", "STL", "mm, assumed", (UNSPECIFIED, RED, BLUE), ("a warning",), solids)
    (tmp_path / "solids").mkdir()
    file.save(tmp_path / "solids")
    return tmp_path / "solids"


def test_a_whole_file_becomes_one_part(folder, tmp_path):
    ingest(folder, "a", "own", None, settings(), tmp_path / "out")
    part, mesh = load_part(tmp_path / "out"), load_mesh(tmp_path / "out")
    assert (part.part_id, part.family, part.designation, part.origin) == (
        "a",
        "own",
        "a.stl",
        "file",
    )
    assert part.source == "a.stl (STL; mm, assumed)"
    assert part.bodies == 2
    assert part.extents_mm == pytest.approx((30, 20, 21))
    assert part.volume_mm3 == pytest.approx(6000 + 4 / 3 * np.pi * 64, rel=0.01)  # faceted ball
    assert part.finishes == (RED, BLUE)  # no face is UNSTATED
    assert np.bincount(mesh.finish).tolist() == [12, 320]
    assert part.defects[0] == "a warning"
    assert part.defects[1].startswith("faces turned: 320 of 332")
    assert len(part.defects) == 2


@pytest.mark.parametrize(("which", "name", "finish"), [(0, "plate", RED), (1, "knob", BLUE)])
def test_one_solid_becomes_a_part_of_its_own(folder, tmp_path, which, name, finish):
    ingest(folder, "a-1", "own", which, settings(), tmp_path / "out")
    part = load_part(tmp_path / "out")
    assert part.designation == f"a.stl: {name}"
    assert part.bodies == 1
    assert part.finishes == (finish,)


def test_a_size_that_the_assumed_unit_makes_unlikely_has_a_note(tmp_path):
    solids = (Solid("solid 1", scaled(box(), 1e-3)),)
    Solids("m.stl", "STL", "mm, assumed", (UNSPECIFIED,), (), solids).save(tmp_path)
    ingest(tmp_path, "m", "own", None, settings(), tmp_path / "out")
    (warning,) = load_part(tmp_path / "out").defects
    assert warning.startswith("its largest side is 0.03 mm if its numbers are mm, as assumed")
    assert load_part_warnings(tmp_path, "parts") == {"out": [warning]}


def test_an_open_part_has_no_volume_and_lists_its_defects(tmp_path):
    solids = (Solid("solid 1", select_faces(box(), slice(1, None))),)
    Solids("o.ply", "PLY", "mm, assumed", (UNSPECIFIED,), (), solids).save(tmp_path)
    ingest(tmp_path, "o", "own", None, settings(), tmp_path / "out")
    part = load_part(tmp_path / "out")
    assert part.volume_mm3 is None
    assert part.defects[0] == "open edges: 3"


def test_what_is_no_part_is_refused_and_leaves_nothing(tmp_path):
    solids = (Solid("solid 1", scaled(box(), 0.0)),)
    Solids("p.ply", "PLY", "mm, assumed", (UNSPECIFIED,), (), solids).save(tmp_path)
    with pytest.raises(BadPart, match="a diagonal of 0 mm"):
        ingest(tmp_path, "p", "own", None, settings(), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_missing_folder_names_the_stage_that_fills_it(tmp_path):
    with pytest.raises(BadArtifact, match="dvc repro solids"):
        ingest(tmp_path / "nowhere", "p", "own", None, settings(), tmp_path / "out")


def test_unused_finishes_go_and_the_others_are_renumbered():
    mesh = box()
    mesh.finish[:] = [4, 1] * 6
    finishes = tuple(Appearance(str(i), None, 0.0, 1.0) for i in range(6))
    renumbered, names = used_appearances(mesh, finishes)
    assert [finish.name for finish in names] == ["1", "4"]
    assert renumbered.finish.tolist() == [1, 0] * 6
