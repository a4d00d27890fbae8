"""The data card says what the catalogues hold."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from PIL import Image

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.artifacts.split import SplitAssignment
from industnerf.config import load_params
from industnerf.parts.catalogue.data_card import render_card, write_card, write_sheet
from industnerf.parts.catalogue.data_card.tables import (
    checks_table,
    family_table,
    markdown_table,
    strata_table,
)
from industnerf.parts.catalogue.entries import (
    EMBEDDED_FOLDER,
    SCHEMA,
    CatalogueEntry,
    mesh_digest,
    read_catalogue,
    to_part,
)
from industnerf.parts.contact_sheet import CAPTION_LINES, LINE_PX, TILE_PX
from industnerf.parts.measure import measure
from industnerf.parts.split import assign_splits
from tests.solids import box, cup, tube

STEEL = Appearance("steel", (0.56, 0.57, 0.58), 1.0, 0.35)
SPLITS = {
    "a-box": SplitAssignment("dev", None),
    "a-cup": SplitAssignment("test", 2),
    "a-tube": SplitAssignment("test", 2),
}


def entry_of(part_id: str, family: str, mesh: Mesh) -> CatalogueEntry:
    measured = measure(mesh)
    return CatalogueEntry(
        id=part_id,
        designation=f"DIN {len(part_id)}-like",
        family=family,
        origin="embedded",
        library="build123d",
        parameters={},
        finishes=(STEEL,),
        measured=measured,
        back_face_share=0.0,
        reference="b-rep",
        reference_volume_mm3=measured.volume_mm3,
        sha256=mesh_digest(mesh.vertices.astype(np.float32), mesh.faces, mesh.finish),
    )


MESHES = {"a-box": box(20, 30, 40), "a-cup": cup(8, 10, 2, 20), "a-tube": tube(5, 7, 20)}
ENTRIES = [
    entry_of("a-box", "blocks", MESHES["a-box"]),
    entry_of("a-cup", "round", MESHES["a-cup"]),
    entry_of("a-tube", "round", MESHES["a-tube"]),
]


def store_catalogue(folder, entries):
    folder.mkdir(parents=True)
    for entry in entries:
        arrays = vars(MESHES[entry.id])
        arrays = arrays | {"vertices": arrays["vertices"].astype(np.float32)}
        np.savez_compressed(folder / f"{entry.id}.npz", **arrays)
    rows = [asdict(entry) for entry in entries]
    (folder / "catalogue.json").write_text(json.dumps({"schema": SCHEMA, "parts": rows}))
    return folder


@pytest.fixture
def embedded(tmp_path):
    return store_catalogue(tmp_path / "data/embedded", ENTRIES)


def test_the_tracked_card_is_what_the_tracked_catalogue_gives(root):
    settings = load_params(root / "params.yaml").split
    splits = assign_splits([to_part(entry) for entry in read_catalogue()], settings)
    text = render_card(EMBEDDED_FOLDER, root / "data/organic", splits)
    # If not: `python -m industnerf.parts card`.
    assert (root / "docs/reference/dataset.md").read_text(encoding="utf-8") == text


def test_a_table_in_markdown():
    assert (
        markdown_table("name | count:", [("a", 1)]) == "| name | count |\n| --- | --: |\n| a | 1 |"
    )


def test_every_part_has_a_row_that_says_what_was_measured(embedded, tmp_path):
    lines = render_card(embedded, tmp_path / "none", SPLITS).splitlines()
    (row,) = (line for line in lines if line.startswith("| `a-tube`"))
    properties = ENTRIES[2].measured
    volume = f"{properties.volume_mm3 / 1000:.3g}"
    assert row.split(" | ")[1:8] == [
        "DIN 6-like",
        "14 x 14 x 20",
        volume,
        "512",
        "1",
        "1",
        "100.0 %",
    ]
    assert row.endswith("| holes, symmetric |")
    assert sum(line.startswith("| `a-") for line in lines) == 3
    assert "3 industrial parts in 2 families" in lines[4]
    assert "`dev`: `a-box`." in lines
    assert not any("{" in line or "}" in line for line in lines)


def test_checks_count_what_passes_and_name_the_worst():
    whole = ENTRIES[0]
    off = replace(whole, id="off", reference_volume_mm3=whole.measured.volume_mm3 * 1.02)
    torn = replace(whole, id="torn", measured=replace(whole.measured, volume_mm3=None))
    behind = replace(whole, id="behind", back_face_share=0.02, reference="finer mesh")
    text = checks_table([whole, off, torn, behind])
    assert "| closed, consistently oriented | 3 of 4 |" in text
    assert "| positive volume | 3 of 4 |" in text
    assert "from outside | 3 of 4 | 2.0000 %, `behind` |" in text
    assert "of the exact B-rep | 1 of 2 | -1.96 %, `off` |" in text
    assert "four times finer | 1 of 1 |" in text


def test_strata_and_families_are_counted_with_their_dev_parts():
    strata = strata_table(ENTRIES, SPLITS)
    assert "| 1 | 0 |" in next(line for line in strata.splitlines() if "| holes |" in line)
    assert "| 2 | 0 |" in next(line for line in strata.splitlines() if "| symmetric |" in line)
    families = family_table(ENTRIES, SPLITS)
    assert "| blocks | 1 | 1 |  |" in families
    assert "| round | 2 | 0 | 2 |" in families


def test_the_other_set_is_told_of_where_it_is_there(embedded, tmp_path):
    assert "non-industrial" not in render_card(embedded, tmp_path / "none", SPLITS)
    organic = store_catalogue(tmp_path / "data/organic", [ENTRIES[1]])
    text = render_card(embedded, organic, SPLITS)
    assert "1 shapes in `data/organic`" in text.split("## The non-industrial set")[1]


def test_the_sheet_shows_every_part(embedded, tmp_path):
    write_sheet(embedded, tmp_path / "sheet.png")
    image = np.asarray(Image.open(tmp_path / "sheet.png"))
    assert image.shape == (TILE_PX + CAPTION_LINES * LINE_PX + LINE_PX // 2, 3 * TILE_PX, 3)
    for i in range(3):
        assert (image[:TILE_PX, i * TILE_PX : (i + 1) * TILE_PX] < 255).mean() > 0.2


def test_writing_the_card_writes_all_of_it(embedded, tmp_path, root):
    (tmp_path / "docs/reference").mkdir(parents=True)
    (tmp_path / "params.yaml").write_text((root / "params.yaml").read_text())
    written = write_card(tmp_path)
    assert [path.name for path in written] == ["dataset.md", "dataset.png", "parts.png"]
    store_catalogue(tmp_path / "data/organic", ENTRIES[:1])
    written = write_card(tmp_path)
    assert [path.name for path in written] == [
        "dataset.md",
        "dataset.png",
        "parts.png",
        "organic.png",
    ]
    assert all(path.stat().st_size > 1000 for path in written)
