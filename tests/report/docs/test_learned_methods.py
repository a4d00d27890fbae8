"""Methods that learn from other parts: beside their baselines, and what leakage does to them."""

import json

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.docs.learned_methods import leakage_block, networks_block
from tests.report.report_samples import PROVENANCE

COSTS = """\
stage,method,part_id,seconds,peak_mb,device,extra_seconds
train,r2n2,fold-0,120,9,cpu,0
train,r2n2,fold-1,240,9,cpu,0
"""
SWEEP = """\
point,split.hold_out,method,split,emd,low,high,x floor
0,family,r2n2,test,0.08000,0.07000,0.09000,8.005
0,family,atlasnet,test,0.09000,0.08000,0.10000,9.000
0,family,r2n2,dev,0.50000,0.50000,0.50000,2.000
1,part,r2n2,test,0.06000,0.05000,0.07000,6.000
1,part,atlasnet,test,0.07000,0.06000,0.08000,7.000
2,none,r2n2,test,0.02000,0.01000,0.03000,2.000
2,none,atlasnet,test,0.03000,0.02000,0.04000,3.000
"""
STUDY = """\
method,split,emd_even
r2n2,test,0.080004
atlasnet,test,0.0912
r2n2,dev,0.5
"""
TEXT = """\
| method | split | EMD, mm | x floor |
| --- | --- | --- | --- |
| r2n2 | test | 13.8 | 8.00 |
| atlasnet | test | 14.6 | 9.12 |
| r2n2 | dev | 99.0 | 2.00 |
"""


@pytest.fixture
def sweep_folder(tmp_path):
    for name, text in (("sweep.csv", SWEEP), ("table1.csv", STUDY), ("table1.md", TEXT)):
        (tmp_path / name).write_text(text)
    return tmp_path


def test_the_floor_stands_first_and_mm_only_where_the_study_measured_the_same(sweep_folder):
    """8.005, the sweep's, would round to another second decimal than the study's Table 1 has."""
    _, _, floor, r2n2, atlasnet = leakage_block(sweep_folder, sweep_folder).splitlines()
    assert floor == "| floor | 0.0100 |  | 1 | 0.0100 | 1 | 0.0100 | 1 |"
    assert r2n2 == (
        "| `r2n2` | 0.0800 (0.0700 to 0.0900) | 13.8 | 8.00 | 0.0600 (0.0500 to 0.0700) | 6.00 "
        "| 0.0200 (0.0100 to 0.0300) | 2.00 |"
    )
    assert atlasnet.startswith("| `atlasnet` | 0.0900 (0.0800 to 0.1000) |  | 9.00 |")


def test_a_method_that_a_point_lacks_is_named(sweep_folder):
    table = sweep_folder / "sweep.csv"
    lines = table.read_text().splitlines(keepends=True)
    table.write_text("".join(line for line in lines if not line.startswith("1,part,r2n2,")))
    with pytest.raises(BadArtifact, match=r"sweep\.csv has no r2n2 at split\.hold_out part"):
        leakage_block(sweep_folder, sweep_folder)


def test_a_net_stands_beside_what_it_must_beat(tmp_path):
    names = {"industnerf": 0.02, "r2n2": 0.08, "retrieval": 0.06}
    head = "method,split,emd_even,ci_low,ci_high,parameters,steps,size,num_train_parts,paper_emd"
    head += ",emd_mm"
    lines = [
        f"{name},test,{emd},0.01,0.1,77,9,{'cpu' if name == 'r2n2' else ''},"
        f"{0 if name == 'industnerf' else 73},{'' if name == 'retrieval' else emd / 2},{100 * emd}"
        for name, emd in names.items()
    ]
    (tmp_path / "table1.csv").write_text("\n".join([head, *lines]) + "\n")
    rows = [("a", "r2n2", 0.05), ("b", "r2n2", 0.11), ("a", "retrieval", 0.06)]
    rows += [("b", "retrieval", 0.06)]
    scores = [f"{part},{method},test,emd,P1-even,{emd}" for part, method, emd in rows]
    head = "part_id,method,split,metric,protocol,value"
    (tmp_path / "scores.csv").write_text("\n".join([head, *scores]) + "\n")
    (tmp_path / "cost.csv").write_text(COSTS + "train,retrieval,fold-0,6,9,cpu,0\n")
    for name, content in (("made", PROVENANCE), ("environment", {"cores": 2, "cpu": "chip"})):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    markdown_text = networks_block(tmp_path)
    assert "2 cores of chip, 2026-01-02, commit 0123456." in markdown_text
    net = "| `r2n2` | cpu | 77 | 3.0 | 9 | 0.0800 (0.0100 to 0.1000) | 8.00 | 4.00 | 0.0400, 4.00 |"
    assert f"{net} 50 % |  |" in markdown_text
    assert (
        "| `retrieval` |  |  | 0.1 |  | 0.0600 (0.0100 to 0.1000) | 6.00 | 3.00 |  |  |  |"
        in markdown_text
    )
