"""Every preset composes to parameters that are complete and right."""

from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from industnerf.config import build
from industnerf.schema import Params

CONF = Path(__file__).parents[2] / "conf"
NETS = ("r2n2", "atlasnet", "occupancy")


def composed(preset: str, monkeypatch: pytest.MonkeyPatch) -> Params:
    monkeypatch.setenv("INDUSTNERF_ROOT", str(CONF.parent))
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return build(Params, OmegaConf.to_container(compose("config", [f"experiment={preset}"])))


@pytest.mark.parametrize("preset", [path.stem for path in sorted(CONF.glob("experiment/*.yaml"))])
def test_a_preset_names_itself_and_is_valid(preset, monkeypatch):
    assert composed(preset, monkeypatch).preset == preset


@pytest.mark.parametrize(
    ("preset", "size"), [("gpu", "full"), ("demo", "tiny"), ("smoke", "tiny"), ("leakage", "cpu")]
)
def test_the_nets_say_which_size_they_have(preset, size, monkeypatch):
    methods = composed(preset, monkeypatch).method
    assert {getattr(methods, name).size for name in NETS} == {size}
