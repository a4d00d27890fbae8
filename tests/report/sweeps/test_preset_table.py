"""Where the results of sweeps are published."""

from importlib.util import find_spec

from industnerf.report.sweeps.preset_table import multirun_presets, publishing_module


def test_the_module_that_publishes_a_sweep_exists(root):
    names = multirun_presets(root)
    assert {"readings", "seeds", "leakage"} <= names
    assert [name for name in names if find_spec(publishing_module(name)) is None] == []
