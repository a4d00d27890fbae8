"""Benchmarks are run by hand, and rarely: what they import must not leave them behind."""

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import create_autospec

import numpy as np
import pytest

from industnerf.artifacts.split import SplitAssignment, save_split
from industnerf.config import load_params

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture(autouse=True)
def benchmarks_on_path(monkeypatch):
    """As if a script of benchmarks/ were run: they import each other by plain name."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    yield
    for path in BENCHMARKS.glob("*.py"):
        sys.modules.pop(path.stem, None)


@pytest.mark.parametrize("name", sorted(path.stem for path in BENCHMARKS.glob("*.py")))
def test_a_benchmark_can_be_imported(name):
    assert Path(importlib.import_module(name).__file__).parent == BENCHMARKS


def test_r2n2_learns_once_and_is_asked_with_one_to_five_views(root, tmp_path, monkeypatch):
    module = importlib.import_module("r2n2_views")
    save_split(
        tmp_path / "split.json",
        {
            "a": SplitAssignment("test", 0),
            "b": SplitAssignment("test", 1),
            "c": SplitAssignment("dev", 0),
        },
    )
    run = create_autospec(module.run)
    emd = create_autospec(module.mean_emd, side_effect=lambda job, *_: job.settings.max_views / 10)
    monkeypatch.setattr(module, "run", run)
    monkeypatch.setattr(module, "mean_emd", emd)
    settings = load_params(root / "params.yaml").method.r2n2
    emds = module.emd_by_view_count(module.Job(tmp_path, "r2n2", 0, 1, settings))
    assert emds == {views: {"a": views / 10} for views in (1, 2, 3, 4, 5)}
    assert run.call_count == 1
    assert {call.args[1] for call in emd.call_args_list} == {run.return_value.state}


def test_solids_that_copy_parts_come_nearer_than_parts_of_other_families():
    module, rng = importlib.import_module("leakage"), np.random.default_rng(0)

    def rod(axis):
        """A rod along an axis, and pictures that tell which."""
        points = 0.02 * rng.random((2048, 3))
        points[:, axis] = rng.random(2048)
        image = np.zeros((64, 64, 3), np.uint8)
        image[16:48, 16 : 24 + 12 * axis] = 255
        return SimpleNamespace(
            surface_pool=lambda rng: points, rgb=lambda px, count: np.stack(count * [image])
        )

    parts, unlike = [rod(0), rod(1)], [rod(2), rod(2)]
    shapes, others = module.Shapes(parts), module.Shapes(unlike)
    emds = module.emds_by_set(shapes, {"a": "A", "b": "B"}, shapes, others)
    chance = emds[module.CHANCE]
    assert all(emds["all abstract solids"][part] < chance[part] / 10 for part in chance)
    resembling = emds["as many that resemble families"]
    assert all(resembling[part] == pytest.approx(chance[part], rel=0.1) for part in chance)
