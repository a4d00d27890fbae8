"""docs/reference/sweeps.md: its table is what the presets and the published sweeps say."""

import re
from pathlib import Path

import pytest

from industnerf.report.sweeps.preset_table import (
    RESULT_LINKS,
    multirun_presets,
    sweep_presets,
)

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs/reference/sweeps.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("preset", sweep_presets(ROOT), ids=lambda preset: preset.name)
def test_every_sweep_answers_a_limitation_and_states_its_time(preset):
    before, _ = TEXT.split("## What was run")
    assert f"`{preset.name}`" in before or preset.name in before
    assert re.fullmatch(r"About \d+ minutes on 2 cores", preset.time)
    assert preset.question


def test_every_preset_that_sweeps_has_its_line_and_where_its_result_stands():
    _, after = TEXT.split("## What was run")
    lines = re.findall(r"^    python -m pipeline\.sweep --multirun .*", after, re.MULTILINE)
    named = [re.findall(r"(?:preset|experiment)=([\w-]+)", line)[-1] for line in lines]
    assert sorted(named) == sorted(multirun_presets(ROOT))
    assert set(RESULT_LINKS) == multirun_presets(ROOT) - {
        preset.name for preset in sweep_presets(ROOT)
    }
    for link in RESULT_LINKS.values():
        (target,) = re.findall(r"\]\((.*)\)", link)
        assert (ROOT / "docs/reference" / target).exists()


def test_every_preset_that_is_named_is_there():
    named = set(re.findall(r"`(sweep-[\w-]+|leakage)`", TEXT))
    assert named == {preset.name for preset in sweep_presets(ROOT)}
