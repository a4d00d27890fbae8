"""What nets owe to parts like those they are asked about, beside the floor."""

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.docs.leakage import leakage_block

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
def folder(tmp_path):
    for name, text in (("sweep.csv", SWEEP), ("table1.csv", STUDY), ("table1.md", TEXT)):
        (tmp_path / name).write_text(text)
    return tmp_path


def test_the_floor_stands_first_and_mm_only_where_the_study_measured_the_same(folder):
    """8.005, the sweep's, would round to another second decimal than the study's Table 1 has."""
    _, _, floor, r2n2, atlasnet = leakage_block(folder, folder).splitlines()
    assert floor == "| floor | 0.0100 |  | 1 | 0.0100 | 1 | 0.0100 | 1 |"
    assert r2n2 == (
        "| `r2n2` | 0.0800 (0.0700 to 0.0900) | 13.8 | 8.00 | 0.0600 (0.0500 to 0.0700) | 6.00 "
        "| 0.0200 (0.0100 to 0.0300) | 2.00 |"
    )
    assert atlasnet.startswith("| `atlasnet` | 0.0900 (0.0800 to 0.1000) |  | 9.00 |")


def test_a_method_that_a_point_lacks_is_named(folder):
    table = folder / "sweep.csv"
    lines = table.read_text().splitlines(keepends=True)
    table.write_text("".join(line for line in lines if not line.startswith("1,part,r2n2,")))
    with pytest.raises(BadArtifact, match=r"sweep\.csv has no r2n2 at split\.hold_out part"):
        leakage_block(folder, folder)
