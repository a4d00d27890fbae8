"""params.yaml to dataclasses: every wrong key and type is an error that names it."""

import copy

import pytest
from dvc.api import params_show

from industnerf import config
from industnerf.errors import BadParams, UndeclaredParameter
from industnerf.schema import Params


@pytest.fixture
def values(root):
    return config.read_yaml(root / "params.yaml")


def changed(values, path, value):
    """A copy of `values` with one dotted key set, or removed if `value` is ..."""
    values = copy.deepcopy(values)
    *sections, name = path.split(".")
    target = values
    for section in sections:
        target = target[section]
    if value is ...:
        del target[name]
    else:
        target[name] = value
    return values


def test_pretraining_needs_solids(values):
    without = changed(values, "procedural.solids", 0)
    assert config.build(Params, without).procedural.solids == 0
    with pytest.raises(BadParams, match=r"procedural\.solids is 0, must be at least 1: pretrain"):
        config.build(Params, changed(without, "pretrain.weights", "trained"))


def test_a_network_has_weights_that_were_trained(values):
    shipped = changed(values, "method.r2n2.training.max_steps", 0)
    assert config.build(Params, shipped).method.r2n2.training.max_steps == 0
    with pytest.raises(
        BadParams, match=r"r2n2\.training\.max_steps is 0, must be at least 1 where"
    ):
        config.build(Params, changed(shipped, "pretrain.weights", "none"))
    with pytest.raises(BadParams, match=r"atlasnet\.pretraining\.max_steps is 0, must be at least"):
        config.build(Params, changed(values, "method.atlasnet.pretraining.max_steps", 0))


def test_params_yaml_is_a_whole_set_of_values(values):
    assert config.build(Params, values).views.count == values["views"]["count"]


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("views.count", "forty", "views.count is 'forty', must be a whole number"),
        ("views.count", 40.0, "views.count is 40.0, must be a whole number"),
        ("views.count", True, "views.count is True, must be a whole number"),
        ("views.count", 0, "views.count is 0, must be at least 1"),
        ("views.count", ..., "views.count is missing"),
        ("reconstruct.views", 41, "reconstruct.views is 41, must be at most the 40 of views.count"),
        ("views.cuont", 40, "views.cuont is unknown"),
        ("views", 3, "views is 3, must be a section with keys"),
        ("views.fov_deg", "wide", "views.fov_deg is 'wide', must be a number"),
        ("views.fov_deg", 180, "views.fov_deg is 180.0, must be in (0, 120)"),
        ("views.albedo", [1.0, 1.0], "views.albedo is [1.0, 1.0], must be three numbers"),
        ("views.albedo", [1.0, 1.0, "x"], "views.albedo[2] is 'x', must be a number"),
        ("views.light.intensities", [1.0], "views.light.intensities is [1.0], must be one number"),
        ("parts.source", "cloud", "parts.source is 'cloud', must be one of embedded, path"),
        ("parts.select", "gear", "parts.select is 'gear', must be a list"),
        ("methods", ["hull", "box", "hull"], "must be a list of methods, each of them once"),
        ("parts.path", "it's mine", "must be a path without an apostrophe, in which DVC"),
        ("methods", ["hul"], "methods[0] is 'hul', must be one of industnerf"),
        ("methods", [], "methods is [], must be a list of at least one method"),
        ("on_failure", True, "on_failure is True, must be one of strict, report"),
        (
            "evaluate.dense_samples",
            1,
            "evaluate.dense_samples is 1, must be at least the 4096 of points",
        ),
        (
            "method.nerf.levels",
            [
                {"steps": 5, "image_px": 64, "points": 2000},
                {"steps": -1, "image_px": 64, "points": 2000},
            ],
            "method.nerf.levels[1].steps is -1, must be at least 0",
        ),
        ("method.nerf.rays_per_step", 0, "method.nerf.rays_per_step is 0, must be at least 1"),
        (
            "method.nerf.density_bias",
            1e9,
            "method.nerf.density_bias is 1000000000.0, must be below max_raw_density",
        ),
        ("method.hull.cell_px", 0, "method.hull.cell_px is 0.0, must be in (0, 8] px"),
        (
            "method.occupancy.points_subsample",
            3,
            "method.occupancy.points_subsample is 3, must be at least 4: some of them inside",
        ),
        ("method.mlp", {}, "method.mlp is unknown"),
    ],
)
def test_a_wrong_value_is_named(values, path, value, message):
    with pytest.raises(BadParams) as refusal:
        config.build(Params, changed(values, path, value))
    assert message in str(refusal.value)
    assert "params.yaml" in str(refusal.value)


def test_a_whole_number_will_do_for_a_number(values):
    fov = config.build(Params, changed(values, "views.fov_deg", 30)).views.fov_deg
    assert isinstance(fov, float)


def test_a_missing_or_torn_file_is_named(tmp_path, monkeypatch):
    with pytest.raises(BadParams, match=r"params\.yaml is missing$"):
        config.read_yaml(tmp_path / "params.yaml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadParams, match=r"^params\.yaml is missing; run from the root"):
        config.read_yaml(config.PARAMS)
    (tmp_path / "params.yaml").write_text("views: [1, 2")
    with pytest.raises(BadParams, match="is not readable"):
        config.read_yaml(tmp_path / "params.yaml")
    (tmp_path / "params.yaml").write_text("views: 1\nviews: 2\n")
    with pytest.raises(BadParams, match="duplicate key views"):
        config.read_yaml(tmp_path / "params.yaml")


def test_a_stage_reads_what_dvc_yaml_lists_and_nothing_else(root):
    stage = config.load_stage("train", root / "dvc.yaml")
    cfg = stage.select_params(config.load_params(root / "params.yaml"))
    assert cfg.method.retrieval.points > 0
    with pytest.raises(UndeclaredParameter, match=r"stage 'train' reads 'method\.ball'"):
        cfg.method.ball  # noqa: B018
    with pytest.raises(UndeclaredParameter, match="stage 'train' reads 'views'"):
        cfg.views  # noqa: B018


def test_dvc_and_we_read_params_yaml_alike(values, root, monkeypatch):
    """YAML readers differ on 1e-3, no, 0777, 12:30: none of that may stand in the file."""
    monkeypatch.chdir(root)
    assert params_show("params.yaml", deps=False) == values


def test_sections_become_dotted_keys():
    assert config.flatten({"a": {"b": {"c": 1}, "d": [2]}, "e": 3}) == {
        "a.b.c": 1,
        "a.d": [2],
        "e": 3,
    }
