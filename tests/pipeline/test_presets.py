"""Every preset composes to parameters that are complete and right."""

from dataclasses import asdict
from pathlib import Path
from typing import get_args, get_type_hints

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from industnerf.config import build, load_params
from industnerf.schema import Params
from industnerf.schema.readings import Readings

CONF = Path(__file__).parents[2] / "conf"
NETS = ("r2n2", "atlasnet", "occupancy")


def composed(preset: str, monkeypatch: pytest.MonkeyPatch) -> Params:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return build(Params, OmegaConf.to_container(compose("config", [f"experiment={preset}"])))


@pytest.mark.parametrize("preset", [path.stem for path in sorted(CONF.glob("experiment/*.yaml"))])
def test_a_preset_names_itself_and_is_valid(preset, monkeypatch):
    assert composed(preset, monkeypatch).preset == preset


def of_reading(name: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        values = OmegaConf.to_container(compose("config", [f"reading={name}"]))
    return asdict(build(Params, values).method.industnerf.readings)


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
