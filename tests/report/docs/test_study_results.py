"""Published results as Markdown: five rows for the README, all tables for their page."""

import json

import pytest

from industnerf.report.docs.study_results import readme_block, results_block
from industnerf.report.tables.formats import csv_text
from tests.report.report_samples import PROVENANCE, read_rows

DIFFERENCE_COLUMNS = ("difference", "ci_low", "ci_high", "difference_mm")
COLUMNS = {
    "comparisons": ("method", "other", *DIFFERENCE_COLUMNS, "p_holm", "win_rate"),
    "goals": ("method", "goal", "target", "value", "met", "tsdf", "oracle"),
    "inspection": ("method", "covered_0.5mm", "covered_1mm"),
}


def results_text(published):
    return results_block(published, published.parents[1] / "params.yaml")


@pytest.fixture
def write_rows(published):
    """Writes rows of one of the tables, and returns the text of the results."""

    def write(name, rows):
        (published / f"{name}.csv").write_text(csv_text(COLUMNS[name], rows))
        return results_text(published)

    return write


def test_table_1_has_the_test_parts_in_order_of_their_emd(published):
    text = results_text(published)
    assert text.startswith("6 test parts of 5 families, ")
    assert "2026-01-02, commit 0123456. Every number is in `results/study`." in text
    lines = text.splitlines()
    at = lines.index("## All methods") + 2
    assert lines[at] == (
        "| method | inputs | EMD | 90 % | mm | x floor | failed | wall seconds | paper |"
    )
    order = [row["method"] for row in read_rows(published / "table1.csv") if row["split"] == "test"]
    assert [line.split(" | ")[0] for line in lines[at + 2 : at + 6]] == [
        f"| {name}" for name in order
    ]
    (hull,) = [line for line in lines if line.startswith("| hull |")]
    assert hull.endswith(" | 1 | 1.5 |  |")  # failures, mean seconds, no number of the paper's
    assert "| industnerf | RGB 2D (MSE) | " in text


def test_the_papers_tables_come_first_where_asked_for(published):
    text = results_block(published, with_paper_tables=True)
    (emd,) = [
        row["emd_even"]
        for row in read_rows(published / "table1.csv")
        if (row["method"], row["split"]) == ("industnerf", "test")
    ]
    lines = text.splitlines()
    assert [line for line in lines if line.startswith("## ")][:3] == [
        "## The paper's Table 1",
        "## The paper's Table 2",
        "## All methods",
    ]
    assert f"| Ours (`industnerf`) | 0.0122 | {float(emd):.4f} | " in text
    values = {
        row["loss"]: float(row["value"])
        for row in read_rows(published / "table2.csv")
        if (row["method"], row["subset"]) == ("industnerf", "all") and "mm" not in row["unit"]
    }
    at = lines.index("## The paper's Table 2") + 4
    assert [float(line.split(" | ")[2].strip(" |")) for line in lines[at : at + 2]] == [
        pytest.approx(values[loss], rel=0.01) for loss in ("emd", "rgb_mse")
    ]


def test_the_readme_has_bounds_and_the_best_network(published):
    path = published / "table1.csv"
    rows = read_rows(path)
    names = [row["method"] for row in rows if row["split"] == "test"]
    assert [
        line.split(" | ")[0]
        for line in readme_block(published, published.parents[1] / "params.yaml").splitlines()[4:]
    ] == [f"| {name}" for name in names if name != "hull"]
    (hull,) = [row for row in rows if (row["method"], row["split"]) == ("hull", "test")]
    hull["size"] = "cpu"  # as if it were a network
    path.write_text(csv_text(list(rows[0]), [list(row.values()) for row in rows]))
    assert "\n| hull |" in readme_block(published, published.parents[1] / "params.yaml")


def test_a_subset_of_which_nothing_was_rendered_is_left_blank(published):
    table = published / "table2.csv"
    lines = [line for line in table.read_text().splitlines() if "figure3,rgb_mse" not in line]
    table.write_text("\n".join(lines) + "\n")
    (row,) = [line for line in results_text(published).splitlines() if "RGB 2D" in line]
    assert row.split(" | ")[3] == ""


def test_a_number_is_rounded_once(published):
    """Six digits of 17.5649998, 17.565, would round to 17.57; Table 1 has 17.56."""
    head, rule, *lines = (published / "table1.md").read_text().splitlines()
    at = head.split(" | ").index("x floor")
    changed = [line.split(" | ") for line in lines if line.startswith("|")]
    for cells in changed:
        cells[at] = "17.56"
    text = "\n".join([head, rule, *map(" | ".join, changed)]) + "\n"
    (published / "table1.md").write_text(text)
    (hull,) = [line for line in results_text(published).splitlines() if line.startswith("| hull |")]
    assert hull.split(" | ")[5] == "17.56"


def test_a_tree_that_was_not_clean_is_said_to_be(published):
    provenance = PROVENANCE | {"clean": False, "changed": ["code.py"]}
    (published / "made.json").write_text(json.dumps(provenance))
    assert "commit 0123456 with changes. " in results_text(published)


def test_settings_that_changed_since_are_named(published):
    assert "no longer those of the study" not in results_text(published)
    today = published.parents[1] / "params.yaml"
    today.write_text("seed: 1\nviews: {count: 40, sky: {x: {p: 1, q: 2}}, sun: {b: 1, c: 2}}\n")
    items = (
        "- another value: `seed`\n- new: `views.sky.x.q`, `views.sun`\n- removed: `views.fov_deg`\n"
    )
    assert f"no longer those of the study. A new run has others here:\n\n{items}" in results_text(
        published
    )


def test_a_setting_that_several_methods_gained_is_named_once(published):
    today = published.parents[1] / "params.yaml"
    methods = "method: {a: {k: 1, own: 1}, b: {k: 1}}\n"
    (published / "params.yaml").write_text("method: {a: {x: 1}, b: {x: 1}}\n")
    today.write_text(methods.replace("{a: {", "{a: {x: 1, ").replace("b: {", "b: {x: 1, "))
    expected = "\n\n- new: `method.*.k`, `method.a.own`\n"
    assert expected in results_text(published)


def test_an_undertrained_network_is_marked_and_the_reason_given(published):
    path = published / "table1.csv"
    path.write_text(path.read_text().replace(",,0,,,", ",,0,,still learning,", 1))
    text = results_text(published)
    first = text.splitlines()[text.splitlines().index("## All methods") + 4]
    name = first.split(" | ")[0].removeprefix("| ")
    assert name.endswith(" (undertrained)")
    assert f"\n- `{name.removesuffix(' (undertrained)')}`: still learning\n" in text


def test_differences_stand_with_their_interval_and_p(write_rows):
    text = write_rows(
        "comparisons",
        [
            ("industnerf", "hull", 0.0012, -0.001, 0.003, -0.004, 0.2, 0.25),
            ("industnerf_plus", "hull", -0.0123, -0.02, -0.01, -1.234, 0.004, 0.75),
            ("industnerf", "nerf", -0.1, -0.2, -0.1, -9.0, 0.001, 1.0),
        ],
    )
    better = "`industnerf_plus` | `hull` | -0.0123 | -0.0200 to -0.0100 | -1.23 | 0.004 | 75 %"
    worse = "`industnerf` | `hull` | +0.0012 | -0.0010 to +0.0030 | -0.00 | 0.2 | 25 %"
    assert f"| {better} |\n| {worse} |\n" in text
    assert "`nerf`" not in text


def test_the_surface_covered_is_in_per_cent_where_it_was_measured(write_rows):
    rows = [("oracle", 0.77, 0.94), ("hull", 0.531, 0.709), ("industnerf", "", ""), ("box", 0, "")]
    text = write_rows("inspection", rows)
    assert "| `hull` | 53 % | 71 % |\n| `oracle` | 77 % | 94 % |\n" in text
    assert "| `industnerf` |" not in text.split("## Surface within tolerance")[1].split("##")[0]


def test_missed_goals_stand_in_a_table_with_the_bounds(write_rows):
    met = ("industnerf", "seconds", "at most 30", 19.9, "yes", "", "")
    missed = ("industnerf", "EMD", "at most 0.02", 0.0222, "no", 0.0102, 0.009)
    text = write_rows("goals", [met, missed])
    assert "1 of 2 goals are missed. All are in `results/study/goals.md`.\n\n| method |" in text
    assert "| `industnerf` | EMD | at most 0.02 | 0.0222 | 0.0102 | 0.00900 |\n" in text
    assert "at most 30" not in text
    assert "0 of 1 goals are missed. All" in write_rows("goals", [met])


def test_a_table_without_rows_has_no_section(write_rows):
    for name, title in (("goals", "Goals"), ("comparisons", "Comparisons")):
        assert f"## {title}" not in write_rows(name, [])


def test_differences_of_one_family_stand_without_an_interval(write_rows):
    text = write_rows(
        "comparisons", [("industnerf", "hull", 0.0012, None, None, -0.004, 0.2, 0.25)]
    )
    assert "| `industnerf` | `hull` | +0.0012 |  | -0.00 | 0.2 | 25 % |" in text
