"""A finished sweep is brought into the documents."""

import json
from pathlib import Path

import pytest
from PIL import Image

from industnerf.errors import BadArtifact
from industnerf.report.sweeps.series import PowerLaw, Trend
from pipeline.sweep_docs import main, published_trends


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two presets, a document, and a finished sweep of one of them."""
    (tmp_path / "conf/experiment").mkdir(parents=True)
    for name in ("sweep-a", "sweep-b"):
        text = f"# @package _global_\n# What of {name}?\n# About 3 minutes on 2 cores.\npreset: x\n"
        text += "hydra: {sweeper: {params: {n: '1,4'}}}\n"
        (tmp_path / f"conf/experiment/{name}.yaml").write_text(text)
    (tmp_path / "docs/reference").mkdir(parents=True)
    (tmp_path / "docs/reference/sweeps.md").write_text(
        "a\n<!-- sweeps -->\n<!-- end sweeps -->\nb\n"
    )
    sweep = tmp_path / "runs/sweeps/now"
    for number in "01":
        (sweep / number / "reports").mkdir(parents=True)
        (sweep / number / "reports/summary.json").write_text("{}")
        (sweep / number / "reports/cost.csv").write_text(
            "stage,method,part_id,seconds,peak_mb,device,extra_seconds\n"
            f"parts,,p1,20,9,cpu,10\nreconstruct,hull,p1,6{number},9,cpu,0\n"
        )
    (sweep / "0/params.yaml").write_text("preset: sweep-b\n")
    (sweep / "sweep.csv").write_text(
        "point,n,method,split,emd\n0,1,hull,dev,0.03\n0,1,box,dev,0.1\n1,4,hull,dev,0.02\n"
        "1,4,box,dev,0.1\n"
    )
    (sweep / "trend.csv").write_text("series,quantity,exponent,standard error,points\n")
    (sweep / "steps.csv").write_text("series\nhull\n")
    provenance = {"schema": 1, "date": "2026-01-02", "commit": "0123456 with changes"}
    (sweep / "made.json").write_text(json.dumps(provenance))
    Image.new("RGB", (640, 800), (255, 0, 0)).save(sweep / "sweep.png")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_sweep_comes_with_its_row_its_plot_and_where_it_was_made(project: Path):
    main("runs/sweeps/now", "a quiet machine")
    text = (project / "docs/reference/sweeps.md").read_text()
    first, second = [line for line in text.splitlines() if line.startswith("| `sweep")]
    assert first == (
        "| `sweep-a` | What of sweep-a? |  | about 3 minutes on 2 cores, estimated "
        "| not yet run |  |"
    )
    assert second == (
        "| `sweep-b` | What of sweep-b? | 2 | 2.5 minutes of one core, measured "
        "| EMD at `n` 1 and 4: `hull` 0.0300 to 0.0200, `box` 0.1000 to 0.1000 "
        "([table](sweeps/sweep-b/sweep.csv), [steps](sweeps/sweep-b/steps.csv)) |  |"
    )
    assert "![sweep-b](sweeps/sweep-b/sweep.png)" in text
    assert "a quiet machine" in text
    assert text.count("    python -m pipeline.sweep --multirun preset=x n=1,4\n") == 2
    metadata = json.loads((project / "docs/reference/sweeps/sweep-b/about.json").read_text())
    assert set(metadata) == {"schema", "date", "commit", "machine", "core_minutes"}
    assert "2026-01-02, at commit 0123456 with changes, a quiet machine" in text
    with Image.open(project / "docs/reference/sweeps/sweep-b/sweep.png") as plot:
        assert plot.size == (640, 800)


def test_the_table_alone_can_be_written_anew(project: Path):
    main()
    once = (project / "docs/reference/sweeps.md").read_text()
    main()
    assert (project / "docs/reference/sweeps.md").read_text() == once
    assert once.count("not yet run") == 2


def test_an_unfinished_sweep_is_refused(project: Path):
    (project / "runs/sweeps/now/sweep.csv").unlink()
    with pytest.raises(BadArtifact, match="writes it at its end"):
        main("runs/sweeps/now")


def test_a_sweep_with_a_failed_point_is_refused(project: Path):
    (project / "runs/sweeps/now/1/reports/summary.json").unlink()
    with pytest.raises(BadArtifact, match=r"1 points of .* have no report"):
        main("runs/sweeps/now")


def test_every_split_of_a_sweep_has_ends_of_its_own(project: Path):
    (project / "runs/sweeps/now/sweep.csv").write_text(
        "point,n,method,split,emd\n0,1,hull,test,0.03\n0,1,hull,dev,0.5\n1,4,hull,test,0.02\n"
        "1,4,hull,dev,0.6\n"
    )
    main("runs/sweeps/now")
    text = (project / "docs/reference/sweeps.md").read_text()
    assert "`hull` (test) 0.0300 to 0.0200, `hull` (dev) 0.5000 to 0.6000" in text


def test_ends_are_in_mm_too_where_the_sweep_knows_them(project: Path):
    (project / "runs/sweeps/now/sweep.csv").write_text(
        "point,n,method,split,emd,emd_mm\n0,1,hull,dev,0.0179,2.4665\n1,4,hull,dev,0.0228,12.1\n"
    )
    main("runs/sweeps/now")
    text = (project / "docs/reference/sweeps.md").read_text()
    assert "`hull` 0.0179 (2.47 mm) to 0.0228 (12.1 mm)" in text


def test_exponents_stand_in_the_table_and_their_file_is_linked(project: Path):
    (project / "runs/sweeps/now/trend.csv").write_text(
        "series,quantity,exponent,standard error,points\nhull,seconds,0.858,0.181,4\n"
        "hull,peak_mb,-0.003,0.039,4\nbox,peak_mb,1.000,0.000,4\n"
    )
    main("runs/sweeps/now")
    text = (project / "docs/reference/sweeps.md").read_text()
    assert (
        "[trend](sweeps/sweep-b/trend.csv)) "
        "| `hull` seconds 0.86 ± 0.18, MB 0.00 ± 0.04; `box` MB 1.00 ± 0.00 |\n"
    ) in text


@pytest.mark.parametrize(
    ("machine", "quantities"),
    [("idle", ["seconds", "peak_mb"]), ("shared: seconds are inflated", ["peak_mb"])],
)
def test_a_plot_drawn_anew_has_the_exponents_of_the_table(tmp_path, machine, quantities):
    (tmp_path / "about.json").write_text(json.dumps({"machine": machine}))
    (tmp_path / "trend.csv").write_text(
        "series,quantity,exponent,standard error,points\n"
        "hull,seconds,0.616,0.255,4\nhull,peak_mb,0.180,0.038,4\n"
    )
    fitted = [Trend("hull", name, PowerLaw(0.6, 0.2, 3.0, 4)) for name in ("seconds", "peak_mb")]
    trends = published_trends(tmp_path, fitted)
    assert [trend.quantity for trend in trends] == quantities
    assert trends[-1].law == PowerLaw(0.180, 0.038, 3.0, 4)


def test_sweeps_with_documents_of_their_own_are_listed_below(project: Path):
    """Of the seeds of nets nothing was brought in."""
    for name in ("ablation", "seeds", "seeds_nets"):
        text = f"preset: {name}\nhydra: {{mode: MULTIRUN, sweeper: {{params: {{n: '1,4'}}}}}}\n"
        (project / f"conf/experiment/{name}.yaml").write_text(text)
    (project / "docs/reference/ablation.csv").touch()
    (project / "results/seeds").mkdir(parents=True)
    (project / "results/seeds/made.json").write_text('{"schema": 1, "sweeps": {"seeds": {}}}')
    main()
    assert (
        "\nOther sweeps, and where their results stand: `ablation` in [method.md](method.md), "
        "`seeds` in [protocol.md](protocol.md), `seeds_nets` not yet run.\n\n"
        "    python -m pipeline.sweep --multirun preset=ablation n=1,4\n"
        "    python -m pipeline.sweep --multirun preset=seeds n=1,4\n"
        "    python -m pipeline.sweep --multirun preset=seeds_nets n=1,4\n"
    ) in (project / "docs/reference/sweeps.md").read_text()


def test_a_sweep_of_no_preset_is_refused(project: Path):
    (project / "runs/sweeps/now/0/params.yaml").write_text("preset: study\n")
    with pytest.raises(BadArtifact, match=r"preset 'study', which has no row here$"):
        main("runs/sweeps/now")
    (project / "runs/sweeps/now/0/params.yaml").write_text("preset: seeds\n")
    message = r"here; `python -m pipeline\.seed_variance` publishes it"
    with pytest.raises(BadArtifact, match=message):
        main("runs/sweeps/now")


def test_a_sweep_without_one_of_its_files_changes_nothing(project: Path):
    (project / "runs/sweeps/now/steps.csv").unlink()
    with pytest.raises(BadArtifact, match=r"lacks steps\.csv"):
        main("runs/sweeps/now", "")
    assert not (project / "docs/reference/sweeps").exists()
