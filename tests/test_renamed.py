"""Old names: each is unknown now, says the new one, and the new one is there."""

import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatchcase
from importlib.util import find_spec
from typing import get_args, get_type_hints

import pytest

from industnerf import renamed
from industnerf.config import build, load_params, read_yaml
from industnerf.errors import BadParams
from industnerf.reconstruct.cli import parse_args
from industnerf.reconstruct.settings import resolve_config
from industnerf.schema import Params
from pipeline.command_line import check_command_line
from pipeline.preset import read_preset
from tests.conftest import ROOT

PARAMS = read_yaml(ROOT / "params.yaml")
READINGS = "method.industnerf.readings"


def has(key: str) -> bool:
    node = PARAMS
    for name in key.split("."):
        if not isinstance(node, dict) or name not in node:
            return False
        node = node[name]
    return True


def expand(old: str, new: str) -> Iterator[tuple[str, str]]:
    """Both keys, of each method that has the new one."""
    for method in PARAMS["method"]:
        pattern = new.split(".")[1]
        if "*" not in pattern:
            yield old, new
            return
        keys = old.replace(pattern, method, 1), new.replace(pattern, method, 1)
        if fnmatchcase(method, pattern) and has(keys[1]):
            yield keys


@pytest.mark.parametrize(("old", "new"), renamed.KEYS.items())
def test_an_old_key_is_unknown_and_says_the_new_one(old, new):
    keys = list(expand(old, new))
    assert keys
    for old_key, key in keys:
        assert has(key)
        assert not has(old_key)
        assert renamed.new_key(old_key) == key


def test_no_key_of_today_is_taken_for_an_old_one():
    keys = [key for key, _ in renamed.flatten_preset(PARAMS)]
    assert [key for key in keys if renamed.new_key(key)] == []


def test_a_key_below_a_renamed_section_follows_it():
    new = "method.industnerf_plus.sdf.init.grid_res"
    assert renamed.new_key("method.industnerf_plus.relief.start.grid_res") == new
    assert renamed.new_key("method.nerf.relief.start.grid_res") == new
    assert renamed.new_key("parts.clean.fill_holes") == "parts.repair.fill_holes"


VALUE_CASES = [
    (pattern, old, new) for pattern, values in renamed.VALUES.items() for old, new in values.items()
]


def with_value(key: str, value: object) -> dict:
    values = read_yaml(ROOT / "params.yaml")
    *sections, name = key.split(".")
    node = values
    for section in sections:
        node = node[section]
    assert name in node
    node[name] = value
    return values


def section_type(key: str) -> type:
    """The dataclass of the section that `key` is in."""
    section: type = Params
    for name in key.split(".")[:-1]:
        section = get_type_hints(section)[name]
    return section


@pytest.mark.parametrize(("pattern", "old", "new"), VALUE_CASES)
def test_an_old_value_is_refused_with_the_new_one(pattern, old, new):
    key = pattern.replace("*nerf*", "industnerf")
    with pytest.raises(BadParams, match=rf"{key}: {old} is now {new}$"):
        build(Params, with_value(key, old))
    assert renamed.new_value(key, new) is None
    field_type = get_type_hints(section_type(key), include_extras=True)[key.rpartition(".")[2]]
    assert new in get_args(field_type)


def test_params_yaml_with_an_old_key_says_the_new_one(tmp_path):
    path = tmp_path / "params.yaml"
    text = (ROOT / "params.yaml").read_text().replace("  dev_fraction:", "  dev_share:")
    path.write_text(text)
    with pytest.raises(BadParams, match=r"split\.dev_share is now split\.dev_fraction"):
        load_params(path)


def test_set_with_an_old_key_says_the_new_one():
    override = "method.industnerf_plus.relief.fill_every=3"
    new = r"method\.industnerf_plus\.sdf\.median_filter_interval"
    with pytest.raises(BadParams, match=rf"relief\.fill_every is now {new}"):
        resolve_config("industnerf_plus", [override], ROOT / "params.yaml")


@pytest.mark.parametrize(
    ("argument", "message"),
    [
        ("method.industnerf.veil=0,1", "veil is now method.industnerf.binary_opacity_weight"),
        ("++views.photo.lamp_deg=3", "is now views.photorealistic.light_half_angle_deg"),
        ("without=relief,surface", "without=relief,surface is now ablation=sdf,surface"),
        ("ablation=shallow", "ablation=shallow is now ablation=relax_max_depth"),
        ("reading=views-surest", "is now reading=view_pooling-argmax_confidence"),
        ("reading=pose-nerf,default", "is now reading=position_encoding-nerf,default"),
    ],
)
def test_a_sweep_of_an_old_name_is_refused_with_the_new_one(argument, message):
    with pytest.raises(BadParams) as refusal:
        check_command_line([argument, "--multirun"])
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    "text",
    [
        "views: {light: {flicker: 0.1}}",
        "hydra: {sweeper: {params: {views.light.flicker: '0,1'}}}",
    ],
)
def test_a_preset_with_an_old_key_says_the_new_one(tmp_path, text):
    (path := tmp_path / "mine.yaml").write_text(f"# @package _global_\n{text}\n")
    with pytest.raises(BadParams, match=r"flicker is now views\.light\.intensity_jitter"):
        read_preset(path)


def test_names_of_today_pass():
    presets = [path.stem for path in ROOT.glob("conf/experiment/*.yaml")]
    files = [f"{path.parent.name}={path.stem}" for path in ROOT.glob("conf/[ra]*/*.yaml")]
    check_command_line([*(f"experiment={preset}" for preset in presets), *files])


@pytest.mark.parametrize(
    ("group", "old", "new"),
    [
        *(("ablation", old, new) for old, new in renamed.ABLATIONS.items()),
        ("reading", "frame-world", "encoding_frame-world"),
        ("reading", "encoder-shared", "encoder-pretrained"),
        ("reading", "signal-left_out", "target_views-disjoint"),
    ],
)
def test_an_old_file_of_conf_is_gone_and_the_new_one_there(group, old, new):
    assert renamed.new_choice(group, old) == new
    assert not (ROOT / "conf" / group / f"{old}.yaml").exists()
    assert (ROOT / "conf" / group / f"{new}.yaml").exists()


@pytest.mark.parametrize(("old", "new"), renamed.FLAGS.items())
def test_an_old_flag_says_the_new_one(old, new, capsys):
    with pytest.raises(SystemExit):
        parse_args([old], "")
    assert f"{old} is now {new}" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        parse_args(["--help"], "")
    out = capsys.readouterr().out
    assert new in out
    assert f"{old} " not in out


def test_a_flag_cut_short_is_no_flag(capsys):
    with pytest.raises(SystemExit):
        parse_args(["--cameras", "c.json", "--out", "c.ply", "--no-res"], "")
    assert "unrecognized arguments: --no-res" in capsys.readouterr().err


@pytest.mark.parametrize(("old", "new"), renamed.COMMANDS.items())
def test_an_old_command_says_the_new_one(old, new):
    assert find_spec(new)
    with pytest.raises(ModuleNotFoundError):
        __import__(old)
    process = subprocess.run(
        [sys.executable, "-m", old, "x"], cwd=ROOT, check=False, capture_output=True, text=True
    )
    assert process.returncode == 2
    assert process.stderr == f"error: python -m {old} is now python -m {new}\n"
