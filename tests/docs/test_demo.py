"""The demo's table, in the README as `make readme` published it: no number that disagrees."""

from pathlib import Path

from industnerf.report.docs.readme_tables import demo_block

from industnerf.report.docs.markdown_blocks import read_block

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / "results/demo"
ROUNDING = 0.5e-4, 0.5e-2  # half of the last digit of an EMD, and of a ratio


def rows(text: str) -> list[dict[str, str]]:
    head, _, *lines = (
        [cell.strip() for cell in line.strip("|\n ").split("|")]
        for line in text.splitlines()
        if line.startswith("|")
    )
    return [dict(zip(head, line, strict=False)) for line in lines]


def is_consistent(ratio: str, emd: str, unit: str) -> bool:
    """Whether `ratio` can be `emd` over `unit`, as all three are rounded."""
    value, above, below = float(ratio), float(emd), float(unit)
    least = (above - ROUNDING[0]) / (below + ROUNDING[0]) - ROUNDING[1]
    most = (above + ROUNDING[0]) / (below - ROUNDING[0]) + ROUNDING[1]
    return least <= value <= most


def test_the_readme_has_the_published_one():
    """If not: make readme"""
    assert demo_block(PUBLISHED) == read_block((ROOT / "README.md").read_text(), "demo")


def test_ratios_are_those_of_the_numbers_beside_them_and_the_best_stands_first():
    table_rows = rows((PUBLISHED / "table1.md").read_text())
    (paper_method_row,) = [row for row in table_rows if row["method"] == "industnerf"]
    for row in table_rows:
        assert is_consistent(row["x floor"], row["EMD (even)"], row["floor"]), row
        assert is_consistent(
            row["x industnerf"], row["EMD (even)"], paper_method_row["EMD (even)"]
        ), row
        assert row["failed"] != "0" or row["without failures"] == row["EMD (even)"]
        low, high = map(float, row["95 %"].split(" to "))
        assert low <= float(row["EMD (even)"]) <= high
    emds = [float(row["EMD (even)"]) for row in table_rows]
    assert emds == sorted(emds)
    assert len({row["floor"] for row in table_rows}) == 1


def test_a_ratio_of_other_numbers_is_found():
    assert is_consistent("2.00", "0.0200", "0.0100")
    assert not is_consistent("2.04", "0.0200", "0.0100")
