"""Which results were made where: of one make, and of several."""

from dataclasses import replace
from pathlib import Path

import pytest

from industnerf import processor
from industnerf.artifacts.files import write_json
from industnerf.origin import Origin
from industnerf.report.publish.origins import OriginRow, origins_line, origins_md, read_origins
from industnerf.report.study import StudyFolders
from industnerf.store import Cost, Store

HERE = Origin({"numpy": "2.4", "torch": "2.13"}, "3.11", "AMD EPYC", "x86-64-v3")
ROW = OriginRow("reconstruct", "industnerf", 3, HERE, "cpu")


def test_results_of_one_make_are_one_sentence():
    other_stage = replace(ROW, stage="truth", count=1, origin=replace(HERE, libraries={}))
    assert origins_line([ROW, other_stage]) == (
        "All 4 results were made on AMD EPYC (x86-64-v3), numpy 2.4, torch 2.13"
    )


def test_without_a_store_nothing_is_said():
    assert origins_line([]) == ""


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            {"origin": replace(HERE, processor="Intel Xeon")},
            "3 on AMD EPYC (x86-64-v3), 1 on Intel Xeon (x86-64-v3)",
        ),
        ({"device": "cuda"}, "3 on AMD EPYC (x86-64-v3), 1 on AMD EPYC (x86-64-v3, a GPU)"),
        (
            {"origin": replace(HERE, libraries={"torch": "2.14"})},
            "3 with torch 2.13, 1 with torch 2.14",
        ),
    ],
)
def test_a_mixture_is_said(change, sentence):
    mixture = [ROW, replace(ROW, count=1, **change)]
    assert origins_line(mixture).startswith(
        f"The 4 results are a mixture: {sentence}; origins.md has the stages"
    )
    assert origins_md(mixture).count("| reconstruct |") == 2


@pytest.mark.parametrize(
    ("change", "has_other_bytes"),
    [
        ({}, False),
        ({"origin": replace(HERE, processor="Intel Xeon")}, False),
        ({"origin": replace(HERE, isa="aarch64-native")}, True),
        ({"device": "cuda"}, True),
    ],
)
def test_bytes_that_differ_from_the_published_ones_are_said_with_their_spread(
    change, has_other_bytes
):
    line = origins_line([replace(ROW, **change)])
    assert ("EMD moves by up to 1 %" in line) == has_other_bytes


def test_the_store_says_who_made_what(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "store"))
    folders = StudyFolders(*[tmp_path / name for name in StudyFolders.__dataclass_fields__])
    keys = {"a": "1" * 32, "b": "2" * 32, "c": "3" * 32}
    for folder in ("solids", "parts", "views", "truth", "procedural", "scores/hull"):
        write_json(tmp_path / folder / "index.json", {"schema": 1, "step": "s", "keys": {}})
    write_json(tmp_path / "clouds/hull/index.json", {"schema": 1, "step": "s", "keys": keys})
    for key, model in zip(keys.values(), ("AMD", "Intel", "Intel"), strict=True):
        monkeypatch.setattr(processor, "model", lambda model=model: model)
        store = Store.from_environment()
        store.put("reconstruct", key, lambda _: Cost(1.0, 1.0, "cpu"), {"numpy": "2.4"})
    rows = read_origins(folders, ["hull"])
    assert [(row.stage, row.method, row.count, row.origin.processor) for row in rows] == [
        ("reconstruct", "hull", 1, "AMD"),
        ("reconstruct", "hull", 2, "Intel"),
    ]
