"""The commands of dvc.yaml, taken apart."""

import sys
from dataclasses import replace
from types import SimpleNamespace

from industnerf import config
from pipeline import in_process


def test_a_path_with_spaces_is_one_argument(root, tmp_path, monkeypatch):
    params = config.load_params(root / "params.yaml")
    params = replace(params, parts=replace(params.parts, path="/data/my own parts"), methods=[])
    arguments = {}
    for name in config.load_stages(root / "dvc.yaml"):
        stub = SimpleNamespace(main=lambda _, *paths, name=name: arguments.setdefault(name, paths))
        monkeypatch.setitem(sys.modules, f"pipeline.stages.{name}", stub)
    monkeypatch.chdir(root)
    in_process.run_pipeline(params, tmp_path)
    assert arguments["solids"] == ("/data/my own parts", str(tmp_path / "data/solids"))
    assert arguments["parts"][0] == "/data/my own parts"
