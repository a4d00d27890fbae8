"""The commands of dvc.yaml, taken apart."""

import os
import shutil
import subprocess
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


def test_a_checkout_beside_the_installed_one_runs_its_own_code(root, tmp_path):
    """DVC queues what stands there then, and runs it when the files are other ones."""
    for name in ("src/industnerf", "pipeline"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    code = "import pipeline.in_process, industnerf; print(industnerf.__file__)"
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{root / 'src'}"}
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert found.stdout.strip() == str(tmp_path / "src/industnerf/__init__.py"), found.stderr
