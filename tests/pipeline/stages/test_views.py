"""What the stage `views` says that its results depend on."""

from dataclasses import replace
from pathlib import Path

import pytest

from industnerf import config
from pipeline.stages import views


@pytest.fixture
def settings_of(root, monkeypatch):
    """The settings in the store's key, for one seed and one change of `views`."""
    params = config.load_params(root / "params.yaml")
    tasks = []
    monkeypatch.setattr(views, "run_stage", lambda step, new, *_, **__: tasks.extend(new))
    monkeypatch.setattr(views, "read_index", lambda folder: {"p": "key"})
    monkeypatch.setattr(views, "read_failures", lambda folder: {})

    def settings(seed: int, **changes: object) -> object:
        changed_params = replace(params, seed=seed, views=replace(params.views, **changes))
        stage_params = config.load_stage("views", root / "dvc.yaml").select_params(changed_params)
        views.main(stage_params, str(Path("parts")), str(Path("out")))
        return tasks[-1].settings

    return settings


def test_a_seed_that_no_knob_needs_is_in_no_key(settings_of):
    assert settings_of(0) == settings_of(1)
    assert settings_of(0, background="gray") == settings_of(1, background="gray")


def test_a_seed_that_a_knob_needs_is_in_the_key(settings_of):
    assert settings_of(0, background="random") != settings_of(1, background="random")
    assert settings_of(0, background="random") == settings_of(0, background="random")
