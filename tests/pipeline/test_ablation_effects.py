"""Sweeps of one change at a time, and the documents that they go into."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest
import yaml
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from industnerf.config import build, flatten, load_params
from industnerf.errors import BadArtifact
from industnerf.report.docs.markdown_blocks import read_block
from industnerf.report.sweeps.ablations import describe_changes
from industnerf.schema import Params
from pipeline import ablation_effects

ROOT = Path(__file__).parents[2]
CHANGES = sorted(path.stem for path in (ROOT / "conf/ablation").glob("*.yaml"))


@pytest.mark.parametrize("name", CHANGES)
def test_what_is_left_out_is_allowed_and_changes_something(name, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_ROOT", str(ROOT))
    with initialize_config_dir(str(ROOT / "conf"), version_base="1.3"):
        composed = OmegaConf.to_container(compose("config", [f"ablation={name}"]))
    params = build(Params, composed, "here")
    params_today = load_params(ROOT / "params.yaml")
    default_settings = flatten(asdict(params_today.method.industnerf_plus), split_lists=True)
    difference = describe_changes(
        flatten(asdict(params.method.industnerf_plus), split_lists=True), default_settings
    )
    assert bool(difference) == (name != "default")


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """The documents and params of this repository, and one point of a sweep of `preset`."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs/reference").mkdir(parents=True)
    for name in ("params.yaml", "docs/reference/readings.md", "docs/reference/method.md"):
        (tmp_path / name).write_text((ROOT / name).read_text())

    def make_sweep(preset: str) -> Path:
        folder = tmp_path / "sweep"
        (folder / "0/reports").mkdir(parents=True)
        params = yaml.safe_load((ROOT / "params.yaml").read_text())
        params |= {"preset": preset, "methods": ["industnerf", "industnerf_plus"]}
        (folder / "0/params.yaml").write_text(yaml.safe_dump(params))
        header = "part_id,family,method,metric,protocol,value,status\n"
        scores = ("emd,P1-even,0.0123", "rgb_mse,P1-frame,0.007", "rgb_mse,P1-union,0.0045")
        names = params["methods"]
        lines = [f"a,of-a,{name},{score},ok\n" for name in names for score in scores]
        (folder / "0/reports/scores.csv").write_text(header + "".join(lines))
        header = "stage,method,part_id,cpu_seconds\n"
        costs = ("reconstruct,{},a,20.0\n", "reconstruct,{},b,21.0\n", "evaluate,{},a,3.0\n")
        lines = [cost.format(name) for name in names for cost in costs]
        (folder / "0/reports/cost.csv").write_text(header + "".join(lines))
        (folder / "0/reports/summary.json").write_text("{}")  # last: the point is finished
        provenance = {"schema": 1, "date": "2026-01-31", "commit": "abc"}
        (folder / "made.json").write_text(json.dumps(provenance))
        (folder / "sweep.csv").write_text("of the sweep\n")
        return folder

    return make_sweep


@pytest.mark.parametrize(
    ("preset", "document", "row"),
    [
        ("readings", "readings", "| R1 | `intended` | 0.0123 |"),
        ("ablation", "method", "| nothing | 0.0123 |  |  |  | 0 | 0.00450 |  | 20.5 |"),
    ],
)
def test_a_sweep_goes_into_the_document_that_asks_about_it(workspace, preset, document, row):
    ablation_effects.main(str(workspace(preset)))
    content = read_block(Path(f"docs/reference/{document}.md").read_text(), preset)
    assert content.startswith("2026-01-31, commit abc.\n")
    assert row in content
    assert Path(f"docs/reference/{preset}.csv").read_text() == "of the sweep\n"


def test_a_sweep_of_something_else_is_refused(workspace):
    folder = workspace("sweep-noise")
    with pytest.raises(BadArtifact, match=r"not of experiment=readings or experiment=ablation"):
        ablation_effects.main(str(folder))


def test_a_sweep_that_did_not_end_is_refused(workspace):
    folder = workspace("ablation")
    (folder / "sweep.csv").unlink()
    with pytest.raises(BadArtifact, match="writes it at its end"):
        ablation_effects.main(str(folder))


def test_a_sweep_of_other_methods_is_refused(workspace):
    folder = workspace("readings")
    params = yaml.safe_load((folder / "0/params.yaml").read_text())
    (folder / "0/params.yaml").write_text(yaml.safe_dump(params | {"methods": ["hull"]}))
    with pytest.raises(BadArtifact, match="ran none of industnerf, industnerf_shared"):
        ablation_effects.main(str(folder))
