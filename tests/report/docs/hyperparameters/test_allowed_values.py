"""What a value may be is said as the checks have it."""

from pathlib import Path

import pytest

from industnerf import config
from industnerf.config import flatten
from industnerf.report.docs.hyperparameters.allowed_values import allowed_values


@pytest.mark.parametrize(
    ("key", "description"),
    [
        ("seed", ""),
        ("views.count", "at least 1"),
        ("views.rig", "`sphere`, `turntable`, `hemisphere`"),
        ("views.sensor.jpeg_quality", "in [0, 95]; 0 is off"),
        ("views.elevations_deg", "each in (-90, 90); a list of at least one angle"),
        ("evaluate.tolerances_mm", "each above 0"),
        ("method.nerf.levels[1].image_px", "at least 16 px"),
        ("method.nerf.readings.sample_position", "`jitter`, `center`"),
    ],
)
def test_choices_and_ranges_are_found(key: str, description: str):
    assert allowed_values(key) == description


def test_every_key_of_params_yaml_has_its_place_in_the_schema(root: Path):
    for key in flatten(config.read_yaml(root / "params.yaml"), split_lists=True):
        allowed_values(key)
