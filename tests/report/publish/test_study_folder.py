"""What is published agrees with itself, and the README with it; so does what is committed."""

import json
from pathlib import Path

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.docs.markdown_blocks import read_block, replace_block
from industnerf.report.docs.readme_tables import study_block
from industnerf.report.docs.study_tables import cluster_block, costs_block, nets_block
from industnerf.report.publish.study_folder import (
    COPIED_FILES,
    RUN_FILES,
    publish_study,
    readme_text,
)
from pipeline.publish import document_blocks as shown_of
from tests.report.report_samples import disagreements, read_rows, write_report

PARAMS_YAML = "seed: 0\nviews: {count: 40, fov_deg: 30.0, sky: {x: {p: 1}}}\n"  # params.yaml
PROVENANCE = {
    "schema": 1,
    "command": "make repro",
    "date": "2026-01-02",
    "commit": "0123456789abcdef",
    "clean": True,
    "changed": [],
    "preset": "study",
    "interval": 0.9,
}
RESULTS = Path(__file__).parents[3] / "results"
STUDY = RESULTS / "study"


@pytest.fixture
def published(tmp_path):
    report, out = write_report(tmp_path / "reports"), tmp_path / "results" / "study"
    for name, _ in RUN_FILES.values():
        (tmp_path / name).write_text(PARAMS_YAML)
    publish_study(report, out, PROVENANCE, tmp_path)
    return out


def published_block(published):
    return study_block(published, published.parents[1] / "params.yaml")


def committed_studies():
    return [STUDY] if STUDY.exists() else []


def test_it_holds_the_tables_the_machine_and_the_commit(published):
    names = {path.name for path in published.iterdir()}
    extra = {"README.md", "made.json", "environment.json", "contact_sheet.png"}
    assert names == set(COPIED_FILES) | set(RUN_FILES) | extra
    assert json.loads((published / "made.json").read_text()) == PROVENANCE
    readme = (published / "README.md").read_text()
    assert "# Results of `make repro`" in readme
    assert all(f"`{name}`" in readme for name in COPIED_FILES)
    assert "![contact_sheet.png](contact_sheet.png)" in readme


def test_rebuilt_tables_are_said_to_be(published):
    assert "rebuilt" not in readme_text(published, PROVENANCE)
    rebuilt = PROVENANCE | {"rebuilt": {"date": "2026-02-03", "commit": "abcdef0"}}
    assert "rebuilt from its scores and costs on 2026-02-03, commit abcdef0" in readme_text(
        published, rebuilt
    )


@pytest.mark.parametrize("missing", ["reports/table2.csv", "dvc.lock"])
def test_what_is_published_stays_if_a_file_is_missing(published, missing):
    project = published.parents[1]
    (project / missing).unlink()
    with pytest.raises(BadArtifact, match=missing):
        publish_study(project / "reports", published, PROVENANCE, project)
    assert (published / "table1.csv").exists()


def test_what_was_there_before_goes(published):
    (published / "old.csv").touch()
    publish_study(published.parents[1] / "reports", published, PROVENANCE, published.parents[1])
    assert not (published / "old.csv").exists()


def test_what_is_interrupted_leaves_what_was_there(published, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("industnerf.report.publish.study_folder.environment", interrupted)
    with pytest.raises(KeyboardInterrupt):
        publish_study(published.parents[1] / "reports", published, PROVENANCE, published.parents[1])
    assert (published / "environment.json").exists()


def test_a_subset_of_which_nothing_was_rendered_is_left_blank(published):
    table = published / "table2.csv"
    lines = [line for line in table.read_text().splitlines() if "figure3,rgb_mse" not in line]
    table.write_text("\n".join(lines) + "\n")
    (row,) = [line for line in published_block(published).splitlines() if "RGB 2D" in line]
    assert row.split(" | ")[3] == ""


def test_costs_of_nothing_are_refused(published):
    (published / "cost.csv").write_text(COSTS.splitlines()[0] + "\n")
    with pytest.raises(BadArtifact, match=r"cost\.csv knows no cost"):
        cluster_block(published)


def test_a_report_that_lacks_a_file_changes_nothing(published):
    report = published.parents[1] / "reports"
    (report / "strata.csv").unlink()
    with pytest.raises(BadArtifact, match=r"strata\.csv is missing"):
        publish_study(report, published, PROVENANCE, published.parents[1])
    assert (published / "strata.csv").exists()


def test_published_tables_are_those_of_the_published_scores(published):
    for folder in [published, *(path.parent for path in RESULTS.glob("*/table1.csv"))]:
        assert disagreements(folder) == []


@pytest.mark.parametrize(
    ("name", "column"),
    [
        ("table1.csv", "emd_even"),
        ("table1.csv", "emd_full"),
        ("table1.csv", "failures"),
        ("table2.csv", "value"),
        ("comparisons.csv", "difference"),
        ("comparisons.csv", "p"),
        ("comparisons.csv", "p_holm"),
        ("comparisons.csv", "win_rate"),
        ("strata.csv", "floor"),
    ],
)
def test_a_number_that_was_touched_is_found(published, name, column):
    lines = (published / name).read_text().splitlines()
    at = lines[0].split(",").index(column)
    cells = lines[1].split(",")
    cells[at] = str(float(cells[at]) + 0.001)
    (published / name).write_text("\n".join([lines[0], ",".join(cells), *lines[2:]]))
    (disagreement,) = disagreements(published)
    assert disagreement.startswith(f"{name}: ")
    assert f" {column} is {cells[at]}" in disagreement


def test_the_block_shows_few_columns_of_the_test_parts(published):
    text = published_block(published)
    assert text.startswith("6 test parts of 5 families, ")
    assert "2026-01-02, commit 0123456; every number is in [results/study]" in text
    head = "| method | inputs | EMD (even) | 90 % | mm | x floor | failed | s a part | paper |"
    lines = text.splitlines()
    assert lines[2] == head
    order = [row["method"] for row in read_rows(published / "table1.csv") if row["split"] == "test"]
    assert [line.split(" | ")[0] for line in lines[4:8]] == [f"| {name}" for name in order]
    (hull,) = [line for line in lines if line.startswith("| hull |")]
    assert hull.endswith(" | 1 | 1.5 |  |")  # failures, mean seconds, no number of the paper's
    assert "| industnerf | RGB 2D (MSE) | " in text
    assert " | 0.0118 |\n\n- `industnerf_plus` has an EMD " in text  # Table 2, then what was found


def test_a_number_is_rounded_once(published):
    """Six digits of 17.5649998, 17.565, would round to 17.57; Table 1 has 17.56."""
    head, rule, *lines = (published / "table1.md").read_text().splitlines()
    at = head.split(" | ").index("x floor")
    changed = [line.split(" | ") for line in lines if line.startswith("|")]
    for cells in changed:
        cells[at] = "17.56"
    text = "\n".join([head, rule, *map(" | ".join, changed)]) + "\n"
    (published / "table1.md").write_text(text)
    (hull,) = [
        line for line in published_block(published).splitlines() if line.startswith("| hull |")
    ]
    assert hull.split(" | ")[5] == "17.56"


def test_a_tree_that_was_not_clean_is_said_to_be(published):
    provenance = PROVENANCE | {"clean": False, "changed": ["code.py"]}
    (published / "made.json").write_text(json.dumps(provenance))
    assert "commit 0123456 with changes; " in published_block(published)


def test_settings_that_changed_since_are_named(published):
    assert "Since then" not in published_block(published)
    today = published.parents[1] / "params.yaml"
    today.write_text("seed: 1\nviews: {count: 40, sky: {x: {p: 1, q: 2}}, sun: {b: 1, c: 2}}\n")
    gained = "has gained `views.sky.x.q`, `views.sun`"
    changed = f"has changed in `seed` and {gained} and has lost `views.fov_deg`"
    assert published_block(published).splitlines()[-1] == f"Since then params.yaml {changed}."


def test_a_net_that_is_undertrained_is_marked(published):
    path = published / "table1.csv"
    path.write_text(path.read_text().replace(",,0,,,", ",,0,,still learning,", 1))
    first = published_block(published).splitlines()[4]
    assert first.split(" | ")[0].endswith(" (undertrained)")


def test_a_block_is_put_where_its_marks_are():
    text = "a\n<!-- study -->\nold\n<!-- end study -->\nb\n<!-- demo -->\n<!-- end demo -->\n"
    new = replace_block(text, "study", "new \\1\n")
    assert new == text.replace("old", "new \\1")
    assert (read_block(new, "study"), read_block(new, "demo")) == ("new \\1\n", "")


@pytest.mark.parametrize(
    "text", ["no marks", "<!-- study -->\nx", 2 * "<!-- study -->\n<!-- end study -->\n"]
)
def test_missing_or_double_marks_are_refused(text):
    with pytest.raises(BadArtifact, match="one place between <!-- study --> and"):
        replace_block(text, "study", "new")


def test_the_documents_show_the_committed_study(root):
    """Run `make results` if this fails, or `python -m pipeline.publish readme`."""
    for document, blocks in shown_of(STUDY, root / "params.yaml").items():
        for name, expected in blocks.items():
            assert read_block((root / document).read_text(), name) == expected, document


COSTS = """\
stage,method,part_id,seconds,peak_mb,device,extra_seconds
views,,a,60,9,cpu,0
truth,,a,60,9,cpu,0
train,r2n2,fold-0,120,9,cpu,0
train,r2n2,fold-1,240,9,cpu,0
reconstruct,industnerf,a,30,9,cpu,6
reconstruct,industnerf,b,90,9,cpu,0
reconstruct,industnerf_plus,a,60,9,cpu,0
evaluate,hull,a,6,9,cpu,0
"""


def test_costs_are_summed_by_step_and_spread_by_method(published):
    (published / "cost.csv").write_text(COSTS)
    markdown_text = costs_block(published)
    assert (
        "All of it is 11 minutes of one core: 1 for photographs, 1 for truth and floors,"
        in markdown_text
    )
    assert "6 for training, 3 for reconstruction and 0 for its pictures" in markdown_text
    assert "| reconstruct | `industnerf` | 2 | 60.00 | 60.00 | 90.00 |" in markdown_text
    assert "| train | `r2n2` | 2 | 180.00 | 180.00 | 240.00 |" in markdown_text
    assert "0 for scoring." in markdown_text
    more = COSTS + "parts,,a,60,9,cpu,0\n"
    (published / "cost.csv").write_text(more)
    assert "All of it is 12 minutes" in costs_block(published)
    assert "0 for scoring,\n1 for cleaning meshes." in costs_block(published)
    more += "solids,,a,30,9,cpu,0\nreport,,,60,9,cpu,0\n"
    (published / "cost.csv").write_text(more)
    with_other_stages = costs_block(published)
    assert "All of it is 14 minutes" in with_other_stages
    assert "2 for reading CAD files, cleaning meshes and the report." in with_other_stages
    assert with_other_stages.splitlines()[-3:] == [
        "| solids |  | 1 | 30.00 | 30.00 | 30.00 |",
        "| parts |  | 1 | 60.00 | 60.00 | 60.00 |",
        "| report |  | 1 | 60.00 | 60.00 | 60.00 |",
    ]
    # of one photographed part 120 s and 6 s for its pictures, so of 10 000 on 64 nodes 19 688 s
    assert "| `industnerf` | 10 000 x 126.0 s / 64 | 5.5 h |" in cluster_block(published)


def test_a_net_stands_beside_what_it_must_beat(tmp_path):
    names = {"industnerf": 0.02, "r2n2": 0.08, "retrieval": 0.06}
    head = (
        "method,split,emd_even,ci_low,ci_high,parameters,steps,size,num_train_parts,paper_emd,"
        "emd_mm"
    )
    lines = [
        f"{name},test,{emd},0.01,0.1,77,9,{'cpu' if name == 'r2n2' else ''},"
        f"{0 if name == 'industnerf' else 73},{'' if name == 'retrieval' else emd / 2},{100 * emd}"
        for name, emd in names.items()
    ]
    (tmp_path / "table1.csv").write_text("\n".join([head, *lines]) + "\n")
    rows = [("a", "r2n2", 0.05), ("b", "r2n2", 0.11), ("a", "retrieval", 0.06)]
    rows += [("b", "retrieval", 0.06)]
    scores = [f"{part},{method},test,emd,P1-even,{emd}" for part, method, emd in rows]
    head = "part_id,method,split,metric,protocol,value"
    (tmp_path / "scores.csv").write_text("\n".join([head, *scores]) + "\n")
    (tmp_path / "cost.csv").write_text(COSTS + "train,retrieval,fold-0,6,9,cpu,0\n")
    for name, content in (("made", PROVENANCE), ("environment", {"cores": 2, "cpu": "chip"})):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    markdown_text = nets_block(tmp_path)
    assert "On 2 cores of chip, 2026-01-02, commit 0123456." in markdown_text
    net = "| `r2n2` | cpu | 77 | 3.0 | 9 | 0.0800 (0.0100 to 0.1000) | 8.00 | 4.00 | 0.0400, 4.00 |"
    assert f"{net} 50 % |  |" in markdown_text
    assert (
        "| `retrieval` |  |  | 0.1 |  | 0.0600 (0.0100 to 0.1000) | 6.00 | 3.00 |  |  |  |"
        in markdown_text
    )


def test_committed_results_are_small_enough_for_a_repository():
    for folder in committed_studies():
        assert sum(path.stat().st_size for path in folder.glob("*.png")) < 1_500_000
