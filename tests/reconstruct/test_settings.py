"""Settings from params.yaml and the command line."""

import pytest

from industnerf.config import DEFAULT_PARAMS, load_params
from industnerf.errors import BadParams
from industnerf.reconstruct.settings import resolve_config
from tests.conftest import ROOT

PARAMS = ROOT / "params.yaml"


def test_settings_are_those_of_params_yaml():
    config, params = resolve_config("hull", [], PARAMS), load_params(PARAMS)
    assert (config.settings, config.seed) == (params.method.hull, params.seed)


def test_the_command_line_goes_first():
    config = resolve_config(
        "hull", ["method.hull.points=77", "method.hull.cell_px=1e-1", "seed=5"], PARAMS
    )
    assert (config.settings.points, config.settings.cell_px, config.seed) == (77, 0.1, 5)


def test_sections_within_a_method_are_reached():
    config = resolve_config("hull_rgb", ["method.hull_rgb.hull.points=9"], PARAMS)
    assert config.settings.hull.points == 9
    assert "method.hull_rgb.hull.points = 9" in config.format_lines()
    assert "seed = 0" in config.format_lines()


@pytest.mark.parametrize(
    ("override", "complaint"),
    [
        ("method.hull.point=7", "method.hull.point is unknown; there are cell_px, points"),
        ("method.hull.points", "must be KEY=VALUE"),
        ("method.hull.points=7.5", "must be a whole number"),
        ("method.hull.points=many", "method.hull.points is 'many', must be a whole number"),
        ("method.hull.points=0", "at least 1"),
        ("method.hull.points.x=1", "points is a value, not a section"),
        ("method.ball.points=7", "only seed and method.hull.* have a say here"),
        ("views.count=7", "only seed and method.hull.* have a say here"),
    ],
)
def test_what_cannot_be_is_refused(override, complaint):
    with pytest.raises(BadParams) as refusal:
        resolve_config("hull", [override], PARAMS)
    assert complaint in str(refusal.value)


@pytest.mark.parametrize("key", ["levels[0].steps", "levels[0]", "levels.0.steps"])
def test_a_list_is_given_as_a_whole(key):
    with pytest.raises(BadParams) as refusal:
        resolve_config("industnerf_plus", [f"method.industnerf_plus.{key}=5"], PARAMS)
    assert (
        "method.industnerf_plus.levels is a list, which is given as a whole, as JSON: --set "
        in (str(refusal.value))
    )


def test_what_there_is_beside_an_unknown_section_is_listed():
    with pytest.raises(BadParams, match=r"hull.hul.points is unknown; there are cell_px, "):
        resolve_config("hull", ["method.hull.hul.points=5"], PARAMS)


def test_elsewhere_the_shipped_values_hold(tmp_path, monkeypatch):
    """In any folder of photographs; a params.yaml that is there goes first."""
    monkeypatch.chdir(tmp_path)
    assert resolve_config("hull", []).source == DEFAULT_PARAMS == PARAMS
    (tmp_path / "params.yaml").write_text("seed: 1")
    with pytest.raises(BadParams, match=r"params.yaml: \w+ is missing"):
        resolve_config("hull", [])
    with pytest.raises(BadParams, match=r"--params .*none.yaml is missing$"):
        resolve_config("hull", [], tmp_path / "none.yaml")
