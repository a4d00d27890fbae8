"""`python -m industnerf.parts.procedural`: the list, the sheet, the files; and the page."""

import numpy as np
import pytest
import trimesh
from PIL import Image

from industnerf.errors import BadParams
from industnerf.parts.contact_sheet import TILE_PX
from industnerf.parts.procedural import __main__ as command
from industnerf.parts.procedural.kinds import ALL_KINDS, KINDS
from industnerf.parts.procedural.solid import procedural_solid


def test_every_kind_is_described_in_one_sentence():
    for kind in ALL_KINDS:
        assert 15 < len(command.describe(kind)) < 100, kind
        assert KINDS[kind].__name__ == kind


def test_the_page_has_the_table_of_kinds(root):
    page = (root / "docs/reference/procedural.md").read_text(encoding="utf-8")
    assert command.kinds_table() in page


def test_export_writes_the_solids(tmp_path):
    command.export(tmp_path / "stl", 0, 2, ("nut", "armed_hub"))
    paths = sorted((tmp_path / "stl").iterdir())
    for index, path in enumerate(paths):
        solid = procedural_solid(0, index, ("nut", "armed_hub"))
        assert path.name == f"{index:05d}-{solid.kind}.stl"
        mesh = trimesh.load_mesh(path)
        assert mesh.is_watertight
        np.testing.assert_allclose(np.sort(mesh.extents)[-1], 100.0, rtol=1e-6)


def test_export_of_nothing_is_refused(tmp_path):
    with pytest.raises(BadParams, match="--count 0"):
        command.export(tmp_path, 0, 0, ALL_KINDS)


def test_the_sheet_has_a_tile_a_solid(tmp_path, monkeypatch):
    monkeypatch.setattr(command, "ALL_KINDS", ("nut", "gear"))
    path = tmp_path / "folder" / "sheet.png"
    command.write_sheet(path, 0)
    image = np.asarray(Image.open(path))
    assert image.shape[1] == 2 * command.SOLIDS_A_KIND * TILE_PX
    tiles = np.split(image[:TILE_PX], 2 * command.SOLIDS_A_KIND, axis=1)
    assert all((tile < 255).any() for tile in tiles)
