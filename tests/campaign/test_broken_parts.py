"""One broken part of twenty, in every stage."""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial, wraps
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
import trimesh
from omegaconf import OmegaConf

from industnerf.artifacts.split import load_split
from industnerf.config import build
from industnerf.errors import PartsFailed
from industnerf.schema import Params
from industnerf.stage import read_failures, read_index
from pipeline.in_process import run_pipeline
from pipeline.preset import compose_params
from tests.pipeline.conftest import SMALL

pytestmark = pytest.mark.campaign
NUM_PARTS = 20
# stage: its function that makes one part's result, and its output
STAGES = {
    "parts": ("", "parts"),
    "views": ("render_part", "views"),
    "truth": ("measure_truth", "truth"),
    "reconstruct": ("reconstruct_part", "clouds/hull"),
    "evaluate": ("score_part", "scores/hull"),
}


@pytest.fixture(scope="module")
def params(tmp_path_factory: pytest.TempPathFactory) -> Params:
    root = Path(__file__).parents[2]
    os.environ["INDUSTNERF_ROOT"] = str(root)
    values = compose_params(root, [*SMALL, "methods=[hull,oracle]"])
    built = build(Params, OmegaConf.to_container(OmegaConf.create(values)))
    names = sorted(path.stem for path in (root / "data/embedded").glob("*.npz"))[:NUM_PARTS]
    return replace(built, on_failure="report", parts=replace(built.parts, select=names))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Of all runs here: what is not broken is made once."""
    folder = tmp_path_factory.mktemp("campaign")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("INDUSTNERF_STORE", str(folder / "store"))
        patch.setenv("INDUSTNERF_RUNNER", "serial")
        yield folder


@pytest.fixture(scope="module")
def whole(params: Params, store: Path) -> Path:
    run_pipeline(params, store / "whole")
    return store / "whole"


def crash_for(intact: Callable, part: str) -> Callable:
    """`intact`, by which its code is looked up, but for one part or net."""

    @wraps(intact)
    def crash(*arguments: Any, **keywords: Any) -> Any:
        if any(isinstance(each, Path) and each.name == part for each in arguments):
            raise ZeroDivisionError("broken for the campaign")
        return intact(*arguments, **keywords)

    return crash


def break_part(monkeypatch: pytest.MonkeyPatch, stage: str, function: str, part: str) -> None:
    """Let `stage` crash for that part."""
    module = import_module(f"pipeline.stages.{stage}")
    if function:
        monkeypatch.setattr(module, function, crash_for(getattr(module, function), part))
        return
    embedded_parts = module.embedded_parts

    def broken_parts(*arguments: Any) -> list:
        return [
            replace(each, make=partial(crash_for(each.make.func, part), Path(part)))
            if each.part_id == part
            else each
            for each in embedded_parts(*arguments)
        ]

    monkeypatch.setattr(module, "embedded_parts", broken_parts)


@pytest.mark.parametrize("stage", STAGES)
def test_the_other_nineteen_are_as_without_it(
    stage: str,
    params: Params,
    whole: Path,
    store: Path,
    monkeypatch: pytest.MonkeyPatch,
    print_row: Callable[[str], None],
):
    part, (function, output) = params.parts.select[7], STAGES[stage]
    # a result of the same key must not be found: every part is made anew, with the same bytes
    monkeypatch.setenv("INDUSTNERF_STORE", str(store / f"store-{stage}"))
    break_part(monkeypatch, stage, function, part)
    folder = store / stage
    if stage == "evaluate":  # a loss: no table without it
        with pytest.raises(PartsFailed, match="1 were lost by"):
            run_pipeline(params, folder)
    else:
        run_pipeline(params, folder)
    assert list(read_failures(folder / "data" / output)) == [part]
    kept = sorted(read_index(folder / "data" / output))
    assert kept == sorted(set(params.parts.select) - {part})
    require_same(folder, whole, [f"data/{output}/{name}" for name in kept])
    ended = "ends with exit code 1" if stage == "evaluate" else "ends with the report"
    print_row(f"1 of {NUM_PARTS} broken in {stage}: 19 as without it, {ended}")


def require_same(folder: Path, whole: Path, results: list[str]) -> None:
    """Every file of `results` has the same bytes in both folders."""
    files = [path for name in results for path in (folder / name).rglob("*") if path.is_file()]
    assert len(files) >= len(results)
    for path in files:
        assert path.read_bytes() == (whole / path.relative_to(folder)).read_bytes()


def test_a_net_that_is_broken_costs_the_parts_of_its_fold(
    params: Params, store: Path, monkeypatch: pytest.MonkeyPatch, print_row: Callable[[str], None]
):
    params = replace(params, methods=["mean_shape"])
    run_pipeline(params, store / "nets")
    part = params.parts.select[7]
    broken = load_split(store / "nets/data/split.json")[part].net_name
    monkeypatch.setenv("INDUSTNERF_STORE", str(store / "store-nets"))
    folder, stage = store / "broken-nets", import_module("pipeline.stages.train")
    intact = stage.fit_method

    @wraps(intact)
    def crash(method: Any, examples: Any, target: Path, **keywords: Any) -> Any:
        if part not in {example.part_id for example in examples}:
            raise ZeroDivisionError("broken for the campaign")
        return intact(method, examples, target, **keywords)

    monkeypatch.setattr(stage, "fit_method", crash)
    run_pipeline(params, folder)
    assert list(read_failures(folder / "data/states/mean_shape")) == [broken]
    failed = read_failures(folder / "data/clouds/mean_shape")
    assert part in failed
    kept = list(read_index(folder / "data/clouds/mean_shape"))
    assert sorted([*kept, *failed]) == sorted(params.parts.select)
    require_same(folder, store / "nets", [f"data/clouds/mean_shape/{name}" for name in kept])
    print_row(
        f"1 net broken in train: {len(failed)} of {NUM_PARTS} parts failed, the rest as without it"
    )


def test_a_cad_file_that_is_broken_costs_itself(
    params: Params, store: Path, print_row: Callable[[str], None]
):
    cad = store / "cad"
    cad.mkdir()
    for number in range(NUM_PARTS):
        trimesh.creation.box((10, 20, 5 + number)).export(cad / f"box-{number:02}.stl")
    own_parts = replace(params.parts, source="path", path=str(cad), select=[])
    params = replace(params, methods=["oracle"], parts=own_parts)
    run_pipeline(params, store / "own")
    (cad / "box-07.stl").write_text("solid torn")
    run_pipeline(params, store / "own-broken")
    assert list(read_failures(store / "own-broken/data/clouds/oracle")) == ["box-07"]
    kept = list(read_index(store / "own-broken/data/clouds/oracle"))
    assert len(kept) == NUM_PARTS - 1
    results = [f"data/{name}/{part}" for name in ("parts", "clouds/oracle") for part in kept]
    require_same(store / "own-broken", store / "own", results)
    print_row(f"1 of {NUM_PARTS} broken in solids: 19 as without it, ends with the report")
