"""The real dvc.yaml: what each stage depends on, and what reruns when a parameter changes."""

import inspect
import json
import re
import shutil
import subprocess
from importlib import import_module
from pathlib import Path

import pytest
import yaml

from industnerf import code_hash, config
from industnerf.methods import MODULES, load_method
from industnerf.methods.base import Input, Scope
from industnerf.report.study import failures_of
from industnerf.schema import MethodSettings, TrainingSettings
from pipeline.preset import DVC_CONFIG
from pipeline.stages.pretrain import NETWORKS

# Corridors that move results about and log them: they are no dependency of any result.
CORE_MODULES = {
    f"industnerf.{name}"
    for name in (
        "cli",
        "config",
        "stage",
        "resume_time",
        "timing",
        "store",
        "content",
        "manifest",
        "origin",
        "code_hash",
        "device",
        "environment",
        "renamed",
        "suggestions",
        "runner",
        "progress",
        "tracking",
    )
}
STAGES = config.load_stages(Path(__file__).parents[2] / "dvc.yaml")
MAX_DAG_COLUMNS, MAX_DAG_ROWS = 200, 45  # of a screen
METHOD_STAGES = ("pretrain", "train", "reconstruct", "evaluate")
RESULT_FILES = (
    "index",
    "failures",
)  # files beside the results of a stage, for the stages behind it


@pytest.mark.parametrize("name", STAGES)
def test_every_module_that_a_stage_imports_is_among_its_deps(name, root):
    deps = config.load_stage(name, root / "dvc.yaml").deps
    dep_paths = [root / dep for dep in deps]
    needed = code_hash.import_closure(f"pipeline.stages.{name}") - CORE_MODULES
    needed = {
        module
        for module in needed
        if not module.startswith(("industnerf.runner.", "industnerf.tracking."))
    }
    if name in ("pretrain", "train", "reconstruct"):
        methods = NETWORKS if name == "pretrain" else MODULES
        closures = (code_hash.import_closure(MODULES[method]) for method in methods)
        needed |= set().union(*closures) - CORE_MODULES
    for module in sorted(needed):
        source = code_hash.source_path(module)
        assert any(source == dep or dep in source.parents for dep in dep_paths), (
            f"stage {name!r} imports {module}, but lists neither it nor its folder under deps"
        )


@pytest.mark.parametrize("name", STAGES)
def test_what_a_stage_reads_of_those_before_it_is_among_its_deps(name, root):
    stage = config.load_stage(name, root / "dvc.yaml")
    _, *names = inspect.signature(import_module(f"pipeline.stages.{name}").main).parameters
    arguments = dict(zip(names, stage.command.split()[3:], strict=True))
    source = (root / "pipeline/stages" / f"{name}.py").read_text()
    for kind, folder in re.findall(r"read_(index|failures)\(Path\((\w+)\)\)", source):
        is_own_output = arguments[folder] in stage.outs
        assert is_own_output or f"{arguments[folder]}/{kind}.json" in stage.deps


def test_the_report_depends_on_the_failures_that_it_lists(root):
    deps = config.load_stage("report", root / "dvc.yaml").deps
    for folder in re.findall(r"read_failures\(folders\.(\w+)\)", inspect.getsource(failures_of)):
        assert f"data/{folder}/failures.json" in deps


def method_params(stage):
    return [name.removeprefix("method.") for name in STAGES[stage]["params"] if "method." in name]


def test_train_reads_the_settings_of_the_methods_that_learn_from_other_parts():
    learning = {name for name in MODULES if load_method(name).scope == Scope.DATASET}
    assert set(method_params("train")) == learning


def test_pretrain_runs_over_the_networks_that_are_trained_twice():
    settings = config.load_params(Path(__file__).parents[2] / "params.yaml").method
    pretrained = {
        name
        for name in MODULES
        if isinstance(getattr(getattr(settings, name), "pretraining", None), TrainingSettings)
    }
    assert set(NETWORKS) == set(method_params("pretrain")) == pretrained
    assert all(Input.PROCEDURAL_SOLIDS in load_method(name).inputs for name in pretrained)


def test_every_method_has_settings_and_a_module():
    assert list(MethodSettings.__dataclass_fields__) == list(MODULES)


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """dvc.yaml and params.yaml as they are, with commands that only touch their outputs."""
    root, project_dir = Path(__file__).parents[2], tmp_path_factory.mktemp("project")
    raw = yaml.safe_load((root / "dvc.yaml").read_text())
    for stage in raw["stages"].values():
        out = stage["outs"][0]
        files = [out] if out.endswith(".json") else [f"{out}/{name}.json" for name in RESULT_FILES]
        stage["cmd"] = f"mkdir -p $(dirname {files[0]}) && echo same | tee {' '.join(files)}"
        for dep in stage["deps"]:
            if dep.startswith(("src", "pipeline")):
                file = project_dir / dep if dep.endswith(".py") else project_dir / dep / "module.py"
                file.parent.mkdir(parents=True, exist_ok=True)
                file.touch()
    (project_dir / "dvc.yaml").write_text(yaml.safe_dump(raw))
    for name in ("params.yaml", "constraints.txt"):
        shutil.copy(root / name, project_dir)
    for folder in ("data/embedded", "results/grid", "results/seeds"):
        shutil.copytree(root / folder, project_dir / folder)
    (project_dir / "data/pretrained").mkdir()
    set_param(project_dir, "methods", ["hull", "oracle"])
    for command in (["init", "--no-scm", "-q"], ["repro", "-q"]):
        subprocess.run(["dvc", *command], cwd=project_dir, check=True)
    return project_dir


def set_param(here, key, value):
    """Set one dotted key of params.yaml; returns what it was."""
    params = yaml.safe_load((here / "params.yaml").read_text())
    *sections, name = key.split(".")
    target = params
    for section in sections:
        target = target[section]
    target[name], before = value, target[name]
    (here / "params.yaml").write_text(yaml.safe_dump(params))
    return before


def outdated_stages(here):
    status = subprocess.run(
        ["dvc", "status", "--json"], cwd=here, check=True, capture_output=True, text=True
    )
    return set(json.loads(status.stdout))


@pytest.mark.parametrize(
    ("key", "value", "stages"),
    [
        ("views.count", 8, {"views", "procedural", "report"}),
        ("views.light.ambient", 0.5, {"views", "procedural"}),
        ("parts.repair.fix_winding", False, {"parts"}),
        ("parts.split_bodies", True, {"parts"}),
        ("parts.units", "cm", {"solids"}),
        ("parts.pattern", "*.stl", {"solids", "parts"}),
        ("split.folds", 5, {"split"}),
        ("split.hold_out", "part", {"split", "report", "train"}),
        ("procedural.solids", 7, {"procedural"}),
        ("pretrain.weights", "none", {"pretrain"}),
        ("method.r2n2.max_views", 2, {"pretrain", "train", "reconstruct", "report"}),
        ("methods", ["oracle", "hull"], {"procedural", *METHOD_STAGES, "report"}),
        ("train.time_limit_s", 5.0, {"train"}),
        ("method.hull.cell_px", 1.0, {"reconstruct"}),
        ("method.retrieval.points", 5, {"train", "reconstruct"}),
        ("method.box.points", 5, {"reconstruct"}),
        ("reconstruct.time_limit_s", 5.0, {"reconstruct"}),
        ("evaluate.fscore_threshold", 0.02, {"truth", "evaluate"}),
        ("report.bootstrap_resamples", 5, {"report"}),
        ("preset", "mine", {"report"}),
    ],
)
def test_one_parameter_outdates_just_the_stages_that_read_it(project, key, value, stages):
    before = set_param(project, key, value)
    try:
        assert outdated_stages(project) == stages
    finally:
        set_param(project, key, before)


def test_another_library_outdates_what_is_keyed_by_its_version(project):
    """The store is asked again: it makes anew what imports it, and hands out the rest."""
    constraints = project / "constraints.txt"
    before = constraints.read_text()
    constraints.write_text(before.replace("torch==", "torch==99."))
    try:
        assert outdated_stages(project) == {
            *("solids", "parts", "views", "truth", "procedural", "pretrain", "train"),
            *("reconstruct", "evaluate"),
        }
    finally:
        constraints.write_text(before)


def test_nothing_is_outdated_after_a_run(project):
    assert outdated_stages(project) == set()


def test_the_graph_of_stages_fits_on_a_screen(project):
    dag = subprocess.run(["dvc", "dag"], cwd=project, check=True, capture_output=True, text=True)
    lines = [line.rstrip() for line in dag.stdout.splitlines()]
    assert len(lines) <= MAX_DAG_ROWS
    assert max(map(len, lines)) <= MAX_DAG_COLUMNS


PLACING = """
stages:
  make:
    cmd: mkdir -p data && ln -f stored data/out
    deps: [source]
    outs: [data/out]
  use:
    cmd: cp data/out used
    deps: [data/out]
    outs: [used]
"""


def test_what_root_writes_into_an_output_is_never_taken_for_the_result(tmp_path, root):
    """With links DVC would hand it out of its cache, and say that nothing changed."""
    line = 'type = "reflink,copy"'
    assert line in DVC_CONFIG
    assert line in (root / ".dvc/config").read_text()
    (tmp_path / "dvc.yaml").write_text(PLACING)
    (tmp_path / "source").touch()
    (tmp_path / "stored").write_text("hello")
    (tmp_path / "stored").chmod(0o444)
    repro = ["repro", "-q"]
    subprocess.run(["dvc", "init", "--no-scm", "-q"], cwd=tmp_path, check=True)
    (tmp_path / ".dvc/config").write_text(DVC_CONFIG)
    subprocess.run(["dvc", *repro], cwd=tmp_path, check=True)
    (tmp_path / "data/out").chmod(0o644)
    (tmp_path / "data/out").write_text("HELLO")
    subprocess.run(["dvc", *repro], cwd=tmp_path, check=True)
    assert [(tmp_path / name).read_text() for name in ("data/out", "used", "stored")] == [
        "hello",
        "hello",
        "hello",
    ]
