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

from industnerf.config import build, load_params
from industnerf.errors import BadParams
from industnerf.methods import load_method
from industnerf.methods.base import Scope
from industnerf.parts.split import assign
from industnerf.report.leaves import leaves
from industnerf.report.subsets import SEED_PARTS, by_hash
from industnerf.report.sweep_lines import COMMAND, line_of
from industnerf.schema import Params
from industnerf.schema.readings import Readings
from pipeline.preset import _seen_from
from pipeline.preset import main as run_preset
from tests.samples import unit_part

CONF = Path(__file__).parents[2] / "conf"
SWEEPS = ["leakage", *(path.stem for path in sorted(CONF.glob("experiment/sweep-*.yaml")))]
ASK_OF_TEST_PARTS = ("leakage", "sweep-views")  # what a claim is worth; nothing is tuned by them
IN_FULL = [*SWEEPS, "ablation", "seeds", "seeds_nets"]  # readings: not on a line
NETS = ("r2n2", "atlasnet", "occupancy")


def composed(preset: str, monkeypatch: pytest.MonkeyPatch, *overrides: str) -> Params:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        values = compose("config", [f"experiment={preset}", *overrides])
    return build(Params, OmegaConf.to_container(values))


def points_of(preset: str, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The overrides of every point of a preset that is a sweep."""
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        hydra = compose("config", [f"experiment={preset}"], return_hydra_config=True).hydra
    assert hydra.mode.name == "MULTIRUN"
    return split([f"{key}={values}" for key, values in hydra.sweeper.params.items()])


def split(words: list[str]) -> list[list[str]]:
    """The overrides of every point of a sweep."""
    with initialize_config_dir(str(CONF), version_base="1.3"):
        parser = OverridesParser.create(GlobalHydra.instance().config_loader())
        overrides = parser.parse_overrides(words)
        (points,) = BasicSweeper.split_arguments(overrides, max_batch_size=None)
    return points


@pytest.mark.parametrize("preset", [path.stem for path in sorted(CONF.glob("experiment/*.yaml"))])
def test_a_preset_names_itself_and_is_valid(preset, monkeypatch):
    assert composed(preset, monkeypatch).preset == preset


def test_a_sweep_is_no_preset_to_be_run_once(monkeypatch):
    monkeypatch.chdir(CONF.parent)
    with pytest.raises(BadParams, match=r"pipeline\.sweep experiment=sweep-noise"):
        run_preset("sweep-noise")


def preset_of(tmp_path: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
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


@pytest.mark.parametrize(("text", "said"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_in_a_preset_is_one_sentence(tmp_path, text, said, monkeypatch):
    with pytest.raises(BadParams, match=re.escape(said)) as refusal:
        preset_of(tmp_path, text, monkeypatch)
    assert "\n" not in str(refusal.value)


def test_a_folder_of_parts_is_where_the_root_has_it(tmp_path):
    """The project lies two folders below; of one that is not there DVC would say it its own way.

    What is relative stays so: params.yaml is published, with no path of a machine in it.
    """
    seen, mine = partial(_seen_from, tmp_path, tmp_path / "runs/some"), tmp_path / "my-parts"
    mine.mkdir()
    assert seen(Path("my-parts")) == Path("../../my-parts")
    assert seen(mine) == mine
    assert seen(Path("data/organic")) == Path("data/organic")
    with pytest.raises(BadParams, match=r"parts\.path .*gone' is neither a folder nor a file"):
        seen(Path("gone"))


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


def wait_until(holds: Callable[[], object]) -> None:
    deadline = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def of_reading(name: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        values = OmegaConf.to_container(compose("config", [f"reading={name}"]))
    params = build(Params, values)
    (own,) = params.methods if name == "encoder-shared" else ["industnerf"]
    return asdict(getattr(params.method, own).readings)


def test_what_learns_from_other_parts_differs_in_its_encoder_alone():
    method = load_params(CONF.parent / "params.yaml").method
    alone, taught = asdict(method.industnerf), asdict(method.industnerf_shared)
    assert taught == alone | {"readings": alone["readings"] | {"encoder": "shared"}}


def test_every_reading_that_is_not_the_default_has_a_file_that_changes_it_alone(monkeypatch):
    usual = of_reading("default", monkeypatch)
    assert usual == asdict(load_params(CONF.parent / "params.yaml").method.industnerf.readings)
    others = {
        f"{name}-{value}": usual | {name: value}
        for name, hint in get_type_hints(Readings).items()
        for value in get_args(hint)
        if value != usual[name]
    }
    files = {path.stem for path in CONF.glob("reading/*.yaml")} - {"default"}
    assert files == set(others)
    for name, expected in others.items():
        assert of_reading(name, monkeypatch) == expected


@pytest.mark.parametrize(
    ("preset", "size"), [("gpu", "full"), ("demo", "tiny"), ("smoke", "tiny"), ("leakage", "cpu")]
)
def test_the_nets_say_which_size_they_have(preset, size, monkeypatch):
    methods = composed(preset, monkeypatch).method
    assert {getattr(methods, name).size for name in NETS} == {size}


@pytest.mark.parametrize("preset", SWEEPS)
def test_every_point_of_a_sweep_is_valid_and_differs_in_what_is_swept(preset, monkeypatch):
    points = points_of(preset, monkeypatch)
    studies = [leaves(asdict(composed(preset, monkeypatch, *point))) for point in points]
    differing = {key for s in studies for key in s if s[key] != studies[0][key]}
    assert len(differing) == 1
    assert len({str(s[next(iter(differing))]) for s in studies}) == len(points) >= 3


def points_of_line(line: str) -> list[list[str]]:
    """The overrides of every point of a --multirun line."""
    return split(shlex.split(line.removeprefix(COMMAND)))


@pytest.mark.parametrize("preset", IN_FULL)
def test_the_line_of_a_preset_asks_the_same_at_every_point(preset, monkeypatch):
    """What both change from point to point is the same, and so is the first point as a whole."""
    points = points_of(preset, monkeypatch)
    lines = points_of_line(line_of(CONF / "experiment" / f"{preset}.yaml"))
    assert [line[len(lines[0]) - len(points[0]) :] for line in lines] == points
    with initialize_config_dir(str(CONF), version_base="1.3"):
        first = build(Params, OmegaConf.to_container(compose("config", lines[0])))
    assert first == composed(preset, monkeypatch, *points[0])


def test_a_sweep_of_files_that_set_what_its_preset_does_is_named():
    """On a line `methods` would win over that of reading `encoder-shared`, which is of another."""
    assert line_of(CONF / "experiment/readings.yaml") == f"{COMMAND} experiment=readings"


@pytest.mark.parametrize("preset", ["seeds", "seeds_nets"])
def test_a_line_says_where_its_sweep_goes_if_the_preset_does(preset):
    words = shlex.split(line_of(CONF / f"experiment/{preset}.yaml"))
    assert f"hydra.sweep.dir=runs/sweeps/{preset}" in words


@pytest.mark.parametrize("preset", sorted({*SWEEPS} - {*ASK_OF_TEST_PARTS}))
def test_sweeps_look_at_dev_parts_only(preset, monkeypatch):
    dev = set(composed("dev", monkeypatch).parts.select)
    for point in points_of(preset, monkeypatch):
        parts = composed(preset, monkeypatch, *point).parts.select
        assert parts
        assert set(parts) <= dev


@pytest.mark.parametrize("preset", ["seeds", "sweep-views"])
def test_the_twenty_parts_are_those_that_the_rule_chooses(preset, monkeypatch):
    params = composed(preset, monkeypatch)
    embedded = [unit_part(path.stem) for path in CONF.parent.glob("data/embedded/*.npz")]
    tested = [name for name, at in assign(embedded, params.split).items() if at.split == "test"]
    assert params.parts.select == sorted(by_hash("seeds", tested)[:SEED_PARTS])


def test_every_random_row_of_the_tables_has_its_seeds_varied(monkeypatch):
    alone, nets = composed("seeds", monkeypatch), composed("seeds_nets", monkeypatch)
    known = [load_method(name) for name in load_params(CONF.parent / "params.yaml").methods]
    assert nets.parts.select == []
    for params, scope in ((alone, Scope.PART), (nets, Scope.DATASET)):
        wanted = {method.name for method in known if method.random and method.scope == scope}
        assert set(params.methods) == wanted


@pytest.mark.parametrize("preset", ["seeds", "seeds_nets"])
def test_seeds_are_three_and_nothing_else_is_swept(preset, monkeypatch):
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        config = compose("config", [f"experiment={preset}"], return_hydra_config=True)
    assert config.hydra.sweeper.params == {"seed": "0,1,2"}
    assert config.hydra.mode.name == "MULTIRUN"
    assert config.hydra.sweep.dir == f"runs/sweeps/{preset}"  # what pipeline.spread is told
