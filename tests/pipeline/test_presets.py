"""Every preset composes to parameters that are complete and right."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import get_args, get_type_hints

import pytest
from hydra import compose, initialize_config_dir
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import OmegaConf

from industnerf.config import build, flatten, load_params
from industnerf.errors import BadParams
from industnerf.methods import load_method
from industnerf.methods.base import Scope
from industnerf.parts.split import assign_splits
from industnerf.report.part_subsets import SEED_PARTS, order_by_hash
from industnerf.report.sweeps.preset_table import COMMAND, command_line_of
from industnerf.schema import Params
from industnerf.schema.readings import Readings
from pipeline.preset import _relative_to_project
from pipeline.preset import main as run_preset
from tests.samples import unit_part

CONF = Path(__file__).parents[2] / "conf"
SWEEPS = ["leakage", *(path.stem for path in sorted(CONF.glob("experiment/sweep-*.yaml")))]
SWEEPS_OVER_TEST_PARTS = (
    "leakage",
    "sweep-views",
)  # what a claim is worth; nothing is tuned by them
FULL_LINES = [*SWEEPS, "ablation", "seeds", "seeds_nets"]  # readings: not on a line
NETS = ("r2n2", "atlasnet", "occupancy")


def compose_preset(preset: str, monkeypatch: pytest.MonkeyPatch, *overrides: str) -> Params:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        values = compose("config", [f"experiment={preset}", *overrides])
    return build(Params, OmegaConf.to_container(values))


def sweep_points(preset: str, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The overrides of every point of a preset that is a sweep."""
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        hydra = compose("config", [f"experiment={preset}"], return_hydra_config=True).hydra
    assert hydra.mode.name == "MULTIRUN"
    return split_sweep([f"{key}={values}" for key, values in hydra.sweeper.params.items()])


def split_sweep(overrides_text: list[str]) -> list[list[str]]:
    """The overrides of every point of a sweep."""
    with initialize_config_dir(str(CONF), version_base="1.3"):
        parser = OverridesParser.create(GlobalHydra.instance().config_loader())
        overrides = parser.parse_overrides(overrides_text)
        (points,) = BasicSweeper.split_arguments(overrides, max_batch_size=None)
    return points


@pytest.mark.parametrize("preset", [path.stem for path in sorted(CONF.glob("experiment/*.yaml"))])
def test_a_preset_names_itself_and_is_valid(preset, monkeypatch):
    assert compose_preset(preset, monkeypatch).preset == preset


def test_a_misspelled_preset_gets_the_one_that_was_meant(monkeypatch):
    monkeypatch.chdir(CONF.parent)
    with pytest.raises(BadParams, match=r"'demmo' is unknown, did you mean `demo`\? known are abl"):
        run_preset("demmo")


def test_a_sweep_is_no_preset_to_be_run_once(monkeypatch):
    monkeypatch.chdir(CONF.parent)
    with pytest.raises(BadParams, match=r"pipeline\.sweep experiment=sweep-noise"):
        run_preset("sweep-noise")


def run_own_preset(tmp_path: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a preset of one's own with this text, in a project that shares the suite's conf."""
    shutil.copytree(CONF, tmp_path / "conf")
    shutil.copy(CONF.parent / "params.yaml", tmp_path)
    (tmp_path / "conf/experiment/mine.yaml").write_text(text)
    monkeypatch.chdir(tmp_path)
    run_preset("mine")


MISTAKES = {
    "no header": ("preset: mine\n", "does not begin with the line '# @package _global_'"),
    "too late": ("# mine\n# @package _global_\npreset: mine\n", "does not begin with the line"),
    "a list": ("# @package _global_\nmethod: [hull]\n", "Cannot merge DictConfig with ListConfig"),
    "no base": ("# @package _global_\ndefaults: [fuor, _self_]\n", "Could not load"),
}


@pytest.mark.parametrize(("text", "message"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_in_a_preset_is_one_sentence(tmp_path, text, message, monkeypatch):
    with pytest.raises(BadParams, match=re.escape(message)) as refusal:
        run_own_preset(tmp_path, text, monkeypatch)
    assert "\n" not in str(refusal.value)


def test_a_folder_of_parts_is_where_the_root_has_it(tmp_path):
    """The project lies two folders below; of one that is not there DVC would say it its own way.

    What is relative stays so: params.yaml is published, with no path of a machine in it.
    """
    resolve = partial(_relative_to_project, tmp_path, tmp_path / "runs/some")
    own_parts = tmp_path / "my-parts"
    own_parts.mkdir()
    assert resolve(Path("my-parts")) == Path("../../my-parts")
    assert resolve(own_parts) == own_parts
    assert resolve(Path("data/organic")) == Path("data/organic")
    with pytest.raises(BadParams, match=r"parts\.path .*gone' is neither a folder nor a file"):
        resolve(Path("gone"))


DVC = """#!/bin/sh
[ "$1" = repro ] || exit 0
echo $$ > "$PIDS"
exec sleep 60
"""


def test_dvc_ends_with_the_preset_that_started_it(root, tmp_path):
    """Else the next one finds its project locked, and nobody knows by whom."""
    dvc, pids = tmp_path / "dvc", tmp_path / "pid"
    dvc.write_text(DVC)
    dvc.chmod(0o755)
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "PIDS": str(pids)}
    for name in ("src", "pipeline", "conf", "data", "params.yaml", "dvc.yaml", ".dvcignore"):
        (tmp_path / name).symlink_to(root / name)
    command = [sys.executable, "-m", "pipeline.preset", "smoke"]
    preset = subprocess.Popen(command, cwd=tmp_path, env=environment)
    try:
        wait_until(lambda: pids.exists() and pids.read_text().strip())
    finally:
        preset.kill()
        preset.wait()
    wait_until(lambda: has_ended(pids.read_text().strip()))


def has_ended(pid: str) -> bool:
    """It may wait for a parent that never asks for it."""
    state = Path(f"/proc/{pid}/stat")
    return not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z"


def wait_until(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_the_demo_has_the_rows_to_know_first_as_in_the_study_and_trains_nothing(monkeypatch):
    demo = compose_preset("demo", monkeypatch)
    study = load_params(CONF.parent / "params.yaml")
    rows = {"industnerf", "industnerf_plus", "nerf", "carve", "hull", "retrieval", "oracle", *NETS}
    assert set(demo.methods) == rows
    assert demo.procedural.solids == 0  # to make them takes longer than to answer
    assert demo.pretrain.weights == "shipped"
    assert {getattr(demo.method, name).training.max_steps for name in NETS} == {0}
    assert (demo.views, demo.evaluate, demo.split) == (study.views, study.evaluate, study.split)
    for name in rows - set(NETS):
        assert getattr(demo.method, name) == getattr(study.method, name)


def reading_settings(name: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        values = OmegaConf.to_container(compose("config", [f"reading={name}"]))
    params = build(Params, values)
    (method_name,) = params.methods if name == "encoder-pretrained" else ["industnerf"]
    return asdict(getattr(params.method, method_name).readings)


def test_what_learns_from_other_parts_differs_in_its_encoder_alone():
    method = load_params(CONF.parent / "params.yaml").method
    own_settings, shared_settings = asdict(method.industnerf), asdict(method.industnerf_shared)
    assert shared_settings.pop("pretraining")
    assert shared_settings == own_settings | {
        "readings": own_settings["readings"] | {"encoder": "pretrained"}
    }


def test_every_reading_that_is_not_the_default_has_a_file_that_changes_it_alone(monkeypatch):
    default_readings = reading_settings("default", monkeypatch)
    assert default_readings == asdict(
        load_params(CONF.parent / "params.yaml").method.industnerf.readings
    )
    expected_readings = {
        f"{name}-{value}": default_readings | {name: value}
        for name, hint in get_type_hints(Readings).items()
        for value in get_args(hint)
        if value != default_readings[name]
    }
    files = {path.stem for path in CONF.glob("reading/*.yaml")} - {"default"}
    assert files == set(expected_readings)
    for name, expected in expected_readings.items():
        assert reading_settings(name, monkeypatch) == expected


@pytest.mark.parametrize(
    ("preset", "size"), [("gpu", "full"), ("demo", "cpu"), ("smoke", "tiny"), ("leakage", "cpu")]
)
def test_the_nets_say_which_size_they_have(preset, size, monkeypatch):
    methods = compose_preset(preset, monkeypatch).method
    assert {getattr(methods, name).size for name in NETS} == {size}


@pytest.mark.parametrize("preset", SWEEPS)
def test_every_point_of_a_sweep_is_valid_and_differs_in_what_is_swept(preset, monkeypatch):
    points = sweep_points(preset, monkeypatch)
    studies = [
        flatten(asdict(compose_preset(preset, monkeypatch, *point)), split_lists=True)
        for point in points
    ]
    differing = {key for s in studies for key in s if s[key] != studies[0][key]}
    assert len(differing) == 1
    assert len({str(s[next(iter(differing))]) for s in studies}) == len(points) >= 3


def line_points(line: str) -> list[list[str]]:
    """The overrides of every point of a --multirun line."""
    return split_sweep(shlex.split(line.removeprefix(COMMAND)))


@pytest.mark.parametrize("preset", FULL_LINES)
def test_the_line_of_a_preset_asks_the_same_at_every_point(preset, monkeypatch):
    """What both change from point to point is the same, and so is the first point as a whole."""
    points = sweep_points(preset, monkeypatch)
    lines = line_points(command_line_of(CONF / "experiment" / f"{preset}.yaml"))
    assert [line[len(lines[0]) - len(points[0]) :] for line in lines] == points
    with initialize_config_dir(str(CONF), version_base="1.3"):
        first = build(Params, OmegaConf.to_container(compose("config", lines[0])))
    assert first == compose_preset(preset, monkeypatch, *points[0])


def test_a_sweep_of_files_that_set_what_its_preset_does_is_named():
    """On a line `methods` would win over that of reading `encoder-shared`, which is of another."""
    assert command_line_of(CONF / "experiment/readings.yaml") == f"{COMMAND} experiment=readings"


@pytest.mark.parametrize("preset", ["seeds", "seeds_nets"])
def test_a_line_says_where_its_sweep_goes_if_the_preset_does(preset):
    words = shlex.split(command_line_of(CONF / f"experiment/{preset}.yaml"))
    assert f"hydra.sweep.dir=runs/sweeps/{preset}" in words


@pytest.mark.parametrize("preset", sorted({*SWEEPS} - {*SWEEPS_OVER_TEST_PARTS}))
def test_sweeps_look_at_dev_parts_only(preset, monkeypatch):
    dev = set(compose_preset("dev", monkeypatch).parts.select)
    for point in sweep_points(preset, monkeypatch):
        parts = compose_preset(preset, monkeypatch, *point).parts.select
        assert parts
        assert set(parts) <= dev


@pytest.mark.parametrize("preset", ["seeds", "sweep-views"])
def test_the_twenty_parts_are_those_that_the_rule_chooses(preset, monkeypatch):
    params = compose_preset(preset, monkeypatch)
    embedded = [unit_part(path.stem) for path in CONF.parent.glob("data/embedded/*.npz")]
    test_parts = [
        name
        for name, assignment in assign_splits(embedded, params.split).items()
        if assignment.split == "test"
    ]
    assert params.parts.select == sorted(order_by_hash("seeds", test_parts)[:SEED_PARTS])


def test_every_random_row_of_the_tables_has_its_seeds_varied(monkeypatch):
    alone, nets = compose_preset("seeds", monkeypatch), compose_preset("seeds_nets", monkeypatch)
    methods = [load_method(name) for name in load_params(CONF.parent / "params.yaml").methods]
    assert nets.parts.select == []
    for params, scope in ((alone, Scope.PART), (nets, Scope.DATASET)):
        expected = {
            method.name for method in methods if method.is_stochastic and method.scope == scope
        }
        assert set(params.methods) == expected


@pytest.mark.parametrize("preset", ["seeds", "seeds_nets"])
def test_seeds_are_three_and_nothing_else_is_swept(preset, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        config = compose("config", [f"experiment={preset}"], return_hydra_config=True)
    assert config.hydra.sweeper.params == {"seed": "0,1,2"}
    assert config.hydra.mode.name == "MULTIRUN"
    assert config.hydra.sweep.dir == f"runs/sweeps/{preset}"  # what pipeline.seed_variance is told


TINY = """# @package _global_
defaults: [smoke, _self_]
preset: tiny
methods: [hull, oracle]
parts: {select: [enclosure-120x80x40, clevis-din71752-g12x24]}
views: {count: 6, held_out: 1, resolution: 32}
procedural: {solids: 0}
pretrain: {weights: none}
method: {hull: {points: 2048}, oracle: {points: 2048}}
evaluate: {points: 128, dense_samples: 2048, max_points: 2048}
"""


@pytest.mark.slow
def test_a_preset_ends_with_table_sentence_and_page_and_no_word_of_dvc(root, tmp_path):
    """So it does where there is nothing left to do."""
    for name in ("src", "pipeline", "data", "results", "params.yaml", "dvc.yaml"):
        (tmp_path / name).symlink_to(root / name)
    shutil.copy(root / "constraints.txt", tmp_path)
    shutil.copytree(root / "conf", tmp_path / "conf")
    shutil.copy(root / ".dvcignore", tmp_path)
    (tmp_path / "conf/experiment/tiny.yaml").write_text(TINY)
    environment = {**os.environ, "INDUSTNERF_MLFLOW": "off", "INDUSTNERF_WORKERS": "1"}
    command = [sys.executable, "-m", "pipeline.preset", "tiny"]
    outputs = []
    for _ in range(2):
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        outputs.append(done.stdout + done.stderr)
    assert "reconstruct hull: 2 made, " in outputs[0]
    assert "reconstruct: done, 4 made, 0 reused, 0 failed" in outputs[0]
    assert "procedural" not in outputs[0]  # which has nothing to do
    for output in outputs:
        assert output.rstrip().endswith("open runs/tiny/reports/report.html")
        assert output.count("report.html") == 1
        assert "On 2 parts hull comes closest to the true surface" in output
        assert not re.search(r"dvc|lock file|Running stage", output)
    assert "done" not in outputs[1]
