"""Table 2: who is in it, over which parts, and what stands beside each loss."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import pytest

from industnerf.artifacts.scores import PartScore, Score
from industnerf.artifacts.split import SplitAssignment
from industnerf.methods import load_method
from industnerf.report.figures.held_out_renderings import HeldOutRenderings
from industnerf.report.html.page import PageMedia, render_page
from industnerf.report.part_subsets import figure3_parts
from industnerf.report.results import Results
from industnerf.report.study import InputViews, Study, StudyFolders
from industnerf.report.tables.table2 import (
    COLUMNS,
    LOSSES,
    NO_TABLE2,
    format_row,
    metric_means,
    table2_csv,
    table2_md,
    table2_rows,
)
from industnerf.schema import ReportParams
from tests.samples import unit_part

SETTINGS = ReportParams(bootstrap_resamples=200, confidence_level=0.9, contact_sheet_parts=4)
RENDERED = {
    "rgb_mse": 0.01,
    "depth_mse": 0.002,
    "psnr": 20.0,
    "ssim": 0.8,
    "coverage": 0.7,
    "silhouette_iou": 0.6,
}
CONFIDENCE = {
    "confidence_spearman": -0.5,
    "confidence_ause": 0.2,
    "confidence_ause_chance": 0.4,
}
PARTS = "abcd"
PAPER_COLUMN = COLUMNS.index("paper")


def score(part, method, metric, protocol, value, status="ok", floor=0.0):
    unit = "diagonal" if metric == "emd" else "1"
    return PartScore(part, method, Score(metric, protocol, value, floor, unit, status))


def study_of(rendering: bool, method: str = "hull") -> Study:
    """Three test parts and the dev part d; `method` may render, but failed on part c."""
    scores = []
    for number, part in enumerate(PARTS):
        failed = "failed" if part == "c" else "ok"
        for protocol in ("P1-even", "P1-iid", "P1-full"):
            scores.append(score(part, method, "emd", protocol, 0.1, failed, 0.05))
            scores.append(score(part, "oracle", "emd", protocol, 0.05, floor=0.05))
        if rendering and part != "c":
            for metric, value in RENDERED.items():
                scores.append(score(part, method, metric, "P1-union", (1 + number) * value))
                if metric not in ("coverage", "silhouette_iou"):
                    scores.append(score(part, method, metric, "P1-frame", value / 2))
            for metric, value in CONFIDENCE.items():
                scores.append(score(part, method, metric, "P1-near", value))
    return Study(
        preset="smoke",
        seed=0,
        num_train_views=12,
        methods={name: load_method(name) for name in (method, "oracle")},
        parts={name: unit_part(name, family) for name, family in zip(PARTS, "ffgg", strict=True)},
        assignments={
            name: SplitAssignment("dev" if name == "d" else "test", None) for name in PARTS
        },
        scores=scores,
        failures={},
        input_warnings={},
        parameters_and_steps={method: (0, 0), "oracle": (0, 0)},
        training_summaries={},
        train_visible_share={},
        rig_visible_share={},
        folders=StudyFolders.all_at(Path("nowhere")),
        input_views=dict.fromkeys((method, "oracle"), InputViews(12)),
        seeds_sd={},
        empty_predictions={},
    )


def show_page(study: Study) -> str:
    return render_page(
        Results.from_study(study, SETTINGS), PageMedia(b"", [], HeldOutRenderings([], []), b"")
    )


def test_every_loss_of_whoever_renders_and_nobody_else():
    table_rows = table2_rows(study_of(rendering=True), SETTINGS)
    assert {table_row.method for table_row in table_rows} == {"hull"}
    names = [loss.name for loss in LOSSES]
    assert [table_row.loss.name for table_row in table_rows] == 3 * names
    subsets = [name for name in ("all", "figure3", "dev") for _ in names]
    assert [table_row.subset for table_row in table_rows] == subsets


def test_a_mean_is_over_the_parts_that_have_it_and_failures_are_counted():
    table_rows = {
        (table_row.loss.metric, table_row.subset): table_row
        for table_row in table2_rows(study_of(True), SETTINGS)
    }
    rgb, emd = table_rows["rgb_mse", "all"], table_rows["emd", "all"]
    assert rgb.mean == pytest.approx((0.01 + 0.02) / 2)  # of a and b
    assert (rgb.ci_low, rgb.ci_high) == (None, None)  # of one family
    assert emd.ci_low <= emd.mean <= emd.ci_high
    assert rgb.whole_image == pytest.approx(0.005)
    assert (rgb.parts, rgb.failures) == (2, 1)
    assert (emd.parts, emd.failures) == (3, 1)
    assert (emd.best, emd.whole_image) == (pytest.approx(0.05), None)
    assert table_rows["coverage", "all"].whole_image is None
    assert table_rows["rgb_mse", "dev"].mean == pytest.approx(0.04)


def test_the_papers_three_numbers_stand_beside_its_own_method_and_no_others():
    study = study_of(True, "industnerf")
    published = {
        table_row.loss.name: format_row(table_row)[PAPER_COLUMN]
        for table_row in table2_rows(study, SETTINGS)
    }
    assert {name: text for name, text in published.items() if text} == {
        "Point Cloud (EMD)": "0.0121665",
        "RGB 2D (MSE)": "0.0986291",
        "Depth 2D (MSE)": "0.0117503",
    }
    assert {
        format_row(table_row)[PAPER_COLUMN] for table_row in table2_rows(study_of(True), SETTINGS)
    } == {""}


def test_the_file_and_the_page_hold_the_lines():
    study = study_of(rendering=True)
    text = table2_md(table2_rows(study, SETTINGS), SETTINGS.confidence_level)
    assert "| 90 % |" in text.splitlines()[0]
    assert len(text.splitlines()) == 2 + 3 * len(LOSSES)
    line = "| hull | RGB 2D (MSE) | all | 0.01500 | "
    assert line in text
    page_html = show_page(study)
    assert "<h2 id='table-2'>Table 2</h2>" in page_html
    assert "90 %</button>" in page_html
    assert "<td class=text>RGB 2D (MSE)<td class=text>all<td>0.01500<td>" in page_html
    for folded in ("One part of every family", "The dev parts"):
        assert f"<details><summary>{folded}" in page_html


def test_figure_3_has_one_part_of_every_family():
    """Parts a and b are of one family, c, which failed, is the only one of the other."""
    study = study_of(rendering=True)
    (figure3_part,) = figure3_parts(study) - {"c"}
    table_rows = {
        (table_row.loss.metric, table_row.subset): table_row
        for table_row in table2_rows(study, SETTINGS)
    }
    rgb, emd = table_rows["rgb_mse", "figure3"], table_rows["emd", "figure3"]
    assert (rgb.parts, emd.parts, emd.failures) == (1, 2, 1)
    assert rgb.mean == pytest.approx({"a": 0.01, "b": 0.02}[figure3_part])


def test_of_one_family_there_is_no_interval():
    table_rows = table2_rows(study_of(True, "industnerf"), SETTINGS)
    intervals = {
        (table_row.subset, table_row.families): format_row(table_row)[COLUMNS.index("95 %")]
        for table_row in table_rows
    }
    assert intervals[("dev", 1)] == ""
    assert " to " in intervals[("all", 2)]
    alone = [replace(row, subset="all") for row in table_rows if row.subset == "dev"]
    rows = list(csv.DictReader(io.StringIO(table2_csv(alone))))
    assert {(row["ci_low"], row["ci_high"]) for row in rows} == {("", "")}


def test_the_csv_has_the_papers_losses_on_reported_parts_and_no_others():
    text = table2_csv(table2_rows(study_of(True, "industnerf"), SETTINGS))
    assert text.splitlines()[0] == "method,subset,loss,value,ci_low,ci_high,unit,paper,coverage"
    rows = [row for row in csv.DictReader(io.StringIO(text)) if row["unit"] != "mm"]
    assert [(row["subset"], row["loss"]) for row in rows] == [
        (subset, loss) for subset in ("all", "figure3") for loss in ("emd", "rgb_mse", "depth_mse")
    ]
    assert rows[1]["value"] == "0.015"
    assert {row["loss"]: row["paper"] for row in rows} == {
        "emd": "0.0121665",
        "rgb_mse": "0.0986291",
        "depth_mse": "0.0117503",
    }
    assert {row["unit"] for row in rows} == {"diagonal", "1"}
    # beside the error of depth, which pixels without one do not enlarge
    assert {row["loss"] for row in rows if row["coverage"]} == {"depth_mse"}


def test_a_length_stands_in_mm_too_part_by_part():
    """Parts of 1 and 3 mm, each a tenth of it off: 0.2 mm; a tenth of the mean part, squared, is
    4 times 0.01, and each part by itself (1 + 9) / 2 times.
    """
    parts = {
        name: unit_part(name, name, extents_mm=(size, 0.0, 0.0))
        for name, size in (("a", 1.0), ("b", 3.0))
    }
    scores = [
        PartScore(name, "hull", Score(metric, protocol, value, 0.0, unit, "ok"))
        for name in parts
        for metric, protocol, value, unit in (
            ("emd", "P1-even", 0.1, "diagonal"),
            ("depth_mse", "P1-union", 0.01, "diagonal^2"),
            ("rgb_mse", "P1-union", 0.5, "white^2"),
        )
    ]
    study = replace(study_of(False), parts=parts, scores=scores)
    table_rows = [
        table_row for table_row in table2_rows(study, SETTINGS) if table_row.subset == "all"
    ]
    mm_cells = {
        table_row.loss.metric: format_row(table_row)[COLUMNS.index("mm")]
        for table_row in table_rows
    }
    assert mm_cells == {"emd": "0.200", "depth_mse": "0.0500 mm²", "rgb_mse": ""}
    rows = [
        row for row in csv.DictReader(io.StringIO(table2_csv(table_rows))) if "mm" in row["unit"]
    ]
    assert [(row["loss"], row["unit"], float(row["value"])) for row in rows] == [
        ("emd", "mm", pytest.approx(0.2)),
        ("depth_mse", "mm^2", pytest.approx(0.05)),
    ]
    assert rows[0]["ci_low"] == "0.1"
    assert {row["paper"] for row in rows} == {""}


def test_without_a_method_that_renders_it_is_left_out_and_said():
    study = study_of(rendering=False)
    assert table2_rows(study, SETTINGS) == []
    assert len(table2_csv([]).splitlines()) == 1
    assert table2_md([], SETTINGS.confidence_level) == f"{NO_TABLE2}\n"
    assert NO_TABLE2 in show_page(study)


def test_its_means_have_names_of_their_own():
    metric_values = metric_means(table2_rows(study_of(rendering=True), SETTINGS))
    assert metric_values["hull.test.psnr"] == pytest.approx(30.0)
    assert metric_values["hull.dev.confidence_ause"] == pytest.approx(0.2)
    assert len(metric_values) == 2 * (len(LOSSES) - 1)
