"""A page and a picture of anybody's clouds."""

import re

import numpy as np
import pytest
import trimesh
from PIL import Image

from industnerf.artifacts.ply import write_ply
from industnerf.errors import BadArtifact, BadParams
from industnerf.view.__main__ import main
from tests.report.html.browser import visit
from tests.report.html.test_browser import HELPERS

BOX = trimesh.creation.box((20, 30, 40))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A mesh, its points in red with a confidence, and the same elsewhere, without color."""
    monkeypatch.chdir(tmp_path)
    BOX.export("box.glb")
    points = BOX.sample(4000, seed=0)
    red = np.tile(np.array([200, 10, 10], np.uint8), (4000, 1))
    write_ply(tmp_path / "red.ply", points, colors=red, confidence=np.linspace(0, 1, 4000))
    np.savetxt("moved.xyz", points + np.array([1.0, 0, 0]))
    return tmp_path


def test_a_page_of_a_single_file_is_whole_and_fetches_nothing(folder, capsys):
    main(["red.ply"])
    page = (folder / "red.ply.html").read_text()
    assert re.findall(r"\w*://|@import|\bfetch\(", page) == []
    output = capsys.readouterr().out
    assert "red.ply: a cloud, 20 x 30 x 40\n" in output
    assert output.endswith("page: red.ply.html\n")


def test_a_picture_has_a_row_for_each_file_and_remarks_are_told(folder, capsys):
    main(["red.ply", "box.glb", "moved.xyz", "--out", "all.html", "--png"])
    with Image.open(folder / "all.png") as image:
        assert image.size == (1440, 3 * 360)
    output = capsys.readouterr().out
    assert "box.glb: a mesh of 12 faces" in output
    assert "box.glb: a mesh of 12 faces: 65536 points are drawn of it, evenly by area" in output
    assert "<li>box.glb: its unit is m, stated" in (folder / "all.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["gone.ply"], "gone.ply is no file"),
        (["red.ply", "--out", "red.ply"], "must end in .html"),
        (["red.ply", "--out", "page.txt"], "must end in .html"),
    ],
)
def test_what_cannot_be_meant_is_refused(folder, arguments, reason):
    with pytest.raises((BadArtifact, BadParams), match=re.escape(reason)):
        main(arguments)


def probe(folder, arguments, script):
    main([*arguments, "--out", "page.html"])
    visited = visit((folder / "page.html").read_text(), HELPERS + script, folder)
    assert visited.console_messages == []
    assert "thrown" not in visited.result, visited.result["thrown"]
    return visited.result


def test_one_file_fills_the_stage_and_every_coloring_draws(folder):
    result = probe(
        folder,
        ["red.ply"],
        """
        const colors = {};
        for (const input of document.querySelectorAll("[name=coloring]")) {
          await set(`[name=coloring][value=${input.value}]`);
          colors[input.value] = canvasColors();
        }
        return { colors, caption: caption("whole") };
        """,
    )
    assert list(result["colors"]) == ["own", "confidence", "height"]
    left, right = result["colors"]["own"]
    assert left["drawn"] == pytest.approx(right["drawn"], rel=0.2)  # one box in the middle
    assert left["sum"][0] > 10 * left["sum"][1]  # red
    assert len({str(each) for each in result["colors"].values()}) == 3
    assert result["caption"] == "a cloud, 20 x 30 x 40; 4000 of 4000 points are shown"


def test_of_two_files_the_distance_shows_where_they_differ(folder):
    """Points of one are 1 from those of the other, and the scale can end at 2.7 or at 0.1."""
    result = probe(
        folder,
        ["red.ply", "moved.xyz"],
        """
        await set("[name=coloring][value=error]");
        const { options } = document.querySelector("[name=limit]");
        const limits = [...options].map((option) => option.textContent);
        return { colors: canvasColors(), limits, own: caption("right") };
        """,
    )
    assert all(half["drawn"] > 0.05 for half in result["colors"])
    assert result["limits"][0] == "0.108 units"  # 0.2 % of 54
