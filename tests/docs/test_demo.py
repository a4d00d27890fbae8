"""The numbers of the demo's published table agree with each other."""

from pathlib import Path

PUBLISHED = Path(__file__).parents[2] / "results/demo"
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


def test_ratios_are_those_of_their_numbers_and_the_best_stands_first():
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
