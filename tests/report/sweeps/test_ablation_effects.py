"""What a reading costs, from points of a sweep whose scores are known."""

from dataclasses import asdict
from pathlib import Path

import pytest
import yaml

from industnerf.config import load_params
from industnerf.errors import BadArtifact
from industnerf.report.sweeps.ablations import read_point_scores, readings_table
from industnerf.schema import ReportParams

ROOT = Path(__file__).parents[3]
DEFAULT = load_params(ROOT / "params.yaml").method.industnerf.readings
NUMBERS = [*range(1, 12), 14, 15, 16]  # 12 and 13 are no readings of the method
IDS = {name: f"R{i}" for name, i in zip(asdict(DEFAULT), NUMBERS, strict=True)}
SETTINGS = ReportParams(bootstrap_resamples=200, confidence_level=0.95, contact_sheet_parts=1)


def write_point(
    sweep: Path,
    emd: dict[str, float],
    failed: str = "",
    method: str = "industnerf",
    **readings: str,
) -> None:
    """A finished point: two parts of two families, and rows that are not asked for."""
    folder = sweep / str(len(list(sweep.iterdir())))
    (folder / "reports").mkdir(parents=True)
    params = {
        "methods": [method],
        "method": {method: {"readings": asdict(DEFAULT) | readings}},
    }
    (folder / "params.yaml").write_text(yaml.safe_dump(params))
    lines = ["part_id,family,method,metric,protocol,value,status"]
    for part, value in emd.items():
        status = "failed" if part == failed else "ok"
        lines.append(f"{part},of-{part},{method},emd,P1-even,{value},{status}")
        lines.append(f"{part},of-{part},{method},emd,P1-iid,9,ok")
        lines.append(f"{part},of-{part},hull,emd,P1-even,9,ok")
    (folder / "reports" / "scores.csv").write_text("\n".join(lines) + "\n")
    (folder / "reports" / "cost.csv").write_text("stage,method,part_id,cpu_seconds\n")


@pytest.fixture
def rows(tmp_path):
    write_point(tmp_path, {"a": 0.02, "b": 0.04})
    write_point(tmp_path, {"a": 0.03, "b": 0.07}, position_encoding="printed")
    write_point(
        tmp_path, {"a": 0.5, "b": 0.5}, position_encoding="nerf", encoding_frame="world"
    )  # two at once: of no use
    write_point(tmp_path, {"a": 0.02, "b": 0.03}, failed="b", sample_position="center")
    write_point(tmp_path, {"a": 0.03, "b": 0.05}, method="industnerf_shared", encoder="pretrained")
    (tmp_path / "9").mkdir()  # a point that never finished
    table_lines = readings_table(read_point_scores(tmp_path), DEFAULT, IDS, SETTINGS).splitlines()
    return {tuple(cell.strip() for cell in row.split("|")[1:3]): row for row in table_lines[2:]}


def test_a_reading_stands_with_its_mean_and_its_paired_difference(rows):
    assert rows["R1", "`intended`"] == "| R1 | `intended` | 0.0300 |  |  | 2 | 0 |"
    # +0.01 and +0.03; of two families a bootstrap draws 0.01, 0.02 and 0.03, the ends often enough
    printed = "| R1 | `printed` | 0.0500 | +0.0200 | +0.0100 to +0.0300 | 2 | 0 |"
    assert rows["R1", "`printed`"] == printed


def test_failures_are_counted(rows):
    assert rows["R5", "`center`"].endswith("| 2 | 1 |")
    assert "-0.0050" in rows["R5", "`center`"]


def test_the_method_that_learns_from_other_parts_is_a_reading_too(rows):
    assert rows["R14", "`pretrained`"].startswith("| R14 | `pretrained` | 0.0400 | +0.0100 |")


def test_what_was_not_run_alone_is_not_yet_measured(rows):
    assert "not yet measured" in rows["R1", "`nerf`"]
    assert "not yet measured" in rows["R2", "`world`"]


def test_a_sweep_without_a_finished_point_is_an_error(tmp_path):
    with pytest.raises(BadArtifact, match="no finished point"):
        read_point_scores(tmp_path)
