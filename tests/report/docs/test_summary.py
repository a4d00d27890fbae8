"""The sentences of the summary say what the tables beside them say."""

from industnerf.report.docs.summary import copy_figures, summary_block
from industnerf.report.tables.formats import csv_text
from tests.report.report_samples import read_rows


def test_each_method_has_its_own_numbers(published):
    text = summary_block(published)
    rows = {
        row["method"]: row for row in read_rows(published / "table1.csv") if row["split"] == "test"
    }
    emd, floors = (float(rows["industnerf"][name]) for name in ("emd_even", "ratio_to_floor"))
    interval = " to ".join(
        f"{float(rows['industnerf'][f'ci_{end}']):.4f}" for end in ("low", "high")
    )
    own = f"EMD {emd:.4f} ({interval}), {floors:.2f} floors"
    assert f"**`industnerf`**, the paper's method: {own}" in text
    failures = sum(int(row["failures"]) for row in rows.values())
    assert f"**Failures**: {failures} of {sum(int(r['parts']) for r in rows.values())} " in text


def test_of_one_family_differences_stand_without_an_interval(published):
    columns = ["method", "other", "difference", "ci_low", "ci_high", "win_rate", "p_holm"]
    rows = [("industnerf", "hull", -0.002, "", "", 0.75, 0.04)]
    (published / "comparisons.csv").write_text(csv_text(columns, rows))
    text = summary_block(published)
    assert "Against the visual hull: -0.0020, better on 75 % of the parts (p 0.04, Holm)." in text


def test_figures_that_were_published_are_copied(published, tmp_path):
    (published / "strata.png").write_bytes(b"picture")
    copy_figures(published, tmp_path)
    assert (tmp_path / "strata.png").read_bytes() == b"picture"
