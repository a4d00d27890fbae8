"""A cloud and a CAD file to a map, by the command."""

import csv
import json
import re

import numpy as np
import pytest

from industnerf.deviation.__main__ import main
from industnerf.deviation.picture import BAR_PX, LINE_PX, deviation_colors, deviation_picture
from industnerf.deviation.statistics import deviation_statistics, histogram
from industnerf.errors import BadArtifact, BadParams
from tests.conftest import ROOT
from tests.deviation import block
from tests.report.html.browser import visit
from tests.report.html.test_browser import HELPERS


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The block as CAD, and a cloud that is 0.1 mm too large all round."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "params.yaml").symlink_to(ROOT / "params.yaml")
    block.mesh().export("block.stl")
    np.savetxt("cloud.xyz", block.cloud(block.mesh(), offset=0.1))
    return tmp_path


def numbers(folder, name="cloud.xyz"):
    return json.loads((folder / f"{name}.deviation.json").read_text())


def test_an_offset_all_round_is_the_deviation_of_every_point(folder, capsys):
    main(["cloud.xyz", "block.stl", "--in-place", "--tolerance", "0.2"])
    with (folder / "cloud.xyz.deviation.csv").open() as file:
        deviation = [float(row["deviation_mm"]) for row in csv.DictReader(file)]
    # less where a point stands beyond a concave edge, nearer to the other face
    assert np.median(deviation) == pytest.approx(0.1, abs=1e-4)
    assert len(deviation) == 8000
    found = numbers(folder)
    assert found["mean_mm"] == pytest.approx(0.1, abs=1e-3)
    assert (found["within_tolerance"], found["above"], found["strays"]) == (1.0, 0.0, 0)
    assert found["move"] == np.eye(4).tolist()
    output = capsys.readouterr().out
    assert "within tolerance: 100.0% within 0.2 mm; 0.0% above, 0.0% below" in output
    main(["cloud.xyz", "block.stl", "--in-place", "--tolerance", "0.05"])
    assert numbers(folder)["above"] > 0.99


def test_a_moved_cloud_in_meters_is_brought_back(folder, capsys):
    np.savetxt("moved.xyz", block.MOVE(block.cloud(block.mesh(), offset=0.1)) / 1000)
    with pytest.raises(BadParams, match=r"0\.00101 times as large .* --units m if .* --with-scale"):
        main(["moved.xyz", "block.stl"])
    main(["moved.xyz", "block.stl", "--units", "m", "--png"])
    found = numbers(folder, "moved.xyz")
    assert found["median_abs_mm"] == pytest.approx(0.1, abs=0.02)  # the fit takes some of it
    assert (folder / "moved.xyz.deviation.png").is_file()
    output = capsys.readouterr().out
    assert "another pose" not in output
    assert "warning: it would fit better if it were 0.99" in output


def test_a_fitted_scale_is_told(folder, capsys):
    np.savetxt("colmap.xyz", block.MOVE(block.cloud(block.mesh())) * 0.11)
    main(["colmap.xyz", "block.stl", "--with-scale"])
    assert numbers(folder, "colmap.xyz")["rms_mm"] < 1e-3
    assert "its scale was fitted, 9.09" in capsys.readouterr().out


def test_what_is_no_part_of_it_is_a_stray_and_what_was_not_measured_is_counted(folder):
    points = block.cloud(block.mesh())
    half = points[points[:, 1] < 20]  # of a block of 40
    np.savetxt("half.xyz", np.vstack([half, [[30, 20, 90]] * 7]))
    main(["half.xyz", "block.stl", "--in-place"])
    found = numbers(folder, "half.xyz")
    assert (found["strays"], found["max_mm"] < 1e-3) == (7, True)
    assert 0.4 < found["covered"] < 0.6


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["gone.ply", "block.stl"], "gone.ply is no file"),
        (["cloud.xyz", "gone.step"], "gone.step is no file"),
        (["cloud.xyz", "block.stl", "--out", "page.txt"], "must end in .html"),
        (["far.xyz", "block.stl", "--in-place"], "no point of far.xyz is within 3.742 mm"),
    ],
)
def test_what_cannot_be_meant_is_refused(folder, arguments, reason):
    np.savetxt("far.xyz", block.cloud(block.mesh()) + 1000)
    with pytest.raises((BadArtifact, BadParams), match=re.escape(reason)):
        main(arguments)


def test_the_page_draws_red_outside_and_blue_inside_and_is_no_wider_than_its_window(folder):
    """Of a cloud whose one half is 0.1 mm outside and whose other half is as far inside."""
    out, inward = (block.cloud(block.mesh(), offset=offset) for offset in (0.1, -0.1))
    points = np.vstack([out[out[:, 0] > 30], inward[inward[:, 0] < 30]])
    np.savetxt("twisted.xyz", points)
    main(["twisted.xyz", "block.stl", "--in-place", "--tolerance", "0.1"])
    page = (folder / "twisted.xyz.deviation.html").read_text()
    assert re.findall(r"\w*://|@import|\bfetch\(", page) == []
    visited = visit(
        page,
        HELPERS
        + """
        await drawn();
        const pixels = document.createElement("canvas");
        [pixels.width, pixels.height] = [canvas.width, canvas.height];
        const context = pixels.getContext("2d", { willReadFrequently: true });
        context.drawImage(canvas, 0, 0);
        const { data } = context.getImageData(0, 0, pixels.width / 2, pixels.height);
        let [red, blue] = [0, 0];
        for (let i = 0; i < data.length; i += 4) {
          red += data[i] > data[i + 2] + 60;
          blue += data[i + 2] > data[i] + 60;
        }
        const root = document.documentElement;
        const legend = document.querySelector("#legend").textContent;
        const { options } = document.querySelector("[name=limit]");
        const limits = [...options].map((option) => option.textContent);
        return { red, blue, legend, limits, title: document.title,
                 overflow: root.scrollWidth - root.clientWidth,
                 bars: document.querySelectorAll("svg rect").length };
        """,
        folder,
    )
    assert visited.console_messages == []
    assert visited.result["red"] > 1000
    assert visited.result["blue"] > 1000
    assert visited.result["overflow"] == 0
    assert visited.result["bars"] == 61
    assert visited.result["title"] == "Deviation of twisted.xyz from block.stl"
    assert visited.result["limits"] == ["0.100 mm", "0.200 mm", "0.500 mm", "1.00 mm", "2.00 mm"]
    assert "-0.200 mm  +0.200 mm" in visited.result["legend"]
    assert "the tolerance, 0.1 mm on either side" in visited.result["legend"]


def test_statistics_of_a_few_numbers_by_hand():
    deviation = np.array([-0.3, -0.1, 0.0, 0.1, 0.2, 9.0])
    found = deviation_statistics(deviation, 0.15, 1.0, np.array([0.1, 0.3]), 0.2)
    assert (found.points, found.strays, found.covered) == (6, 1, 0.5)
    assert (found.within_tolerance, found.above, found.below) == (0.6, 0.2, 0.2)
    assert found.mean_mm == pytest.approx(-0.02)
    assert found.rms_mm == pytest.approx(np.sqrt(0.15 / 5))
    assert (found.median_abs_mm, found.min_mm, found.max_mm) == (0.1, -0.3, 0.2)


def test_the_histogram_holds_every_point_the_last_bars_all_beyond():
    counts, edges = histogram(np.array([-5.0, -0.01, 0.0, 0.01, 1.0]), 0.61)
    assert (len(counts), counts.sum()) == (61, 5)
    assert (counts[0], counts[30], counts[-1]) == (1, 3, 1)
    assert (edges[0], edges[-1]) == (-0.61, 0.61)


def test_the_picture_has_a_title_and_a_bar_with_ticks_at_the_tolerance():
    """Red, white and blue points; the bar ends in their colors, and each tick is a dark column."""
    points = np.random.default_rng(0).normal(size=(300, 3))
    image = deviation_picture(points, np.zeros(300), 0.4, 0.1, "a.ply from b.step")
    assert (image[:LINE_PX] < 128).any()
    bar = image[LINE_PX + 360 + BAR_PX // 2].astype(int)
    left, right = 360, 3 * 360 - 1  # the middle half of four views of 360 px
    is_tick = (bar[left : right + 1] < 100).all(axis=1)
    ticks = np.flatnonzero(is_tick) / (right - left)
    np.testing.assert_allclose(np.unique(ticks.round(2)), [0, 0.37, 0.5, 0.62, 1], atol=0.011)
    np.testing.assert_allclose(bar[left + 2], deviation_colors(np.array([-0.399]), 0.4)[0], atol=2)
    assert bar[right - 2][0] > bar[right - 2][2] + 60
    np.testing.assert_array_equal(bar[left - 2], [255, 255, 255])


def test_a_long_title_is_not_cut():
    points = np.random.default_rng(0).normal(size=(300, 3))
    image = deviation_picture(points, np.zeros(300), 0.4, 0.1, 25 * "long name ")
    dark = np.flatnonzero((image[:LINE_PX] < 128).any(axis=(0, 2)))
    assert dark.min() > 5
    assert dark.max() < image.shape[1] - 5
