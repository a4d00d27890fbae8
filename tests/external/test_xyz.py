"""XYZ files as programs write them."""

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.external.points import read_points

POINTS = [[1.5, -2.0, 3e-3], [4.0, 5.0, 6.25]]
ROWS = "1.5 -2 3e-3\n4 5 6.25\n"


@pytest.fixture
def read(tmp_path):
    def read_text(text):
        (tmp_path / "a.xyz").write_text(text)
        return read_points(tmp_path / "a.xyz", 10, np.random.default_rng(0))

    return read_text


@pytest.mark.parametrize(
    "text",
    [
        ROWS,
        ROWS.replace("\n", "\r\n"),
        "\ufeff" + ROWS,
        "\n" + ROWS.replace("\n", "\n\n"),
        ROWS.replace(" ", "\t"),
        ROWS.replace(" ", ","),
        ROWS.replace(" ", ", "),
        ROWS.replace(" ", ";"),
        ROWS.replace(" ", " ; "),
        "1.5, -2,3e-3\n4,5, 6.25\n",
        "1.5, -2,3e-3,255,0, 10\n4, 5,6.25,1,2,3\n",
        "scan of a gear, pitch 0,5 mm\n" + ROWS,
        "gear 24\nX;Y;Z\n" + ROWS,
        "x y z\n" + ROWS,
        "X,Y,Z\n" + ROWS.replace(" ", ","),
        "//X Y Z\n" + ROWS,
        "# made by hand\n# x y z\n# three\n" + ROWS,
        "2\n" + ROWS,
        "2\na gear\n" + ROWS,
        "2\n\n" + ROWS,
        "1.5 -2 3e-3 255 0 10\n4 5 6.25 1 2 3\n",
        "1.5,-2,3e-3,255,0,10\n4,5,6.25,1,2,3\n",
        "1.5 -2 3e-3 0.1 0.2 0.3 name\n4 5 6.25\n",
    ],
)
def test_all_ways_to_write_the_same_points_are_read_alike(read, text):
    np.testing.assert_array_equal(read(text)[0], POINTS)


def test_lines_that_are_passed_over_are_named_and_comments_are_not(read):
    assert read("# made by hand\n2\n//x y z\n" + ROWS)[1] == []
    (warning,) = read("# made by hand\nscan, 0,5 mm\n\nx y z\n" + ROWS)[1]
    assert warning == "passed over before its points: line 2, 'scan, 0,5 mm'; line 4, 'x y z'"


@pytest.mark.parametrize("row", ["0,5 1,2 3,4", "0,5;1,2;3,4", "0,5\t-1\t3", "0,05,1,25,3,00"])
def test_decimal_commas_are_refused(read, row):
    with pytest.raises(BadArtifact, match=r"a\.xyz.*line 2, .* has decimal commas; write decimal"):
        read(f"x y z\n{row}\n{row}\n")


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing\n", "x y z\n", "0\n"])
def test_a_file_without_a_point_says_so(read, text):
    with pytest.raises(BadArtifact, match=r"a\.xyz: no point in the file"):
        read(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (ROWS + "1 2\n", "line 3, '1 2', does not begin with three numbers"),
        (ROWS + "1 2 x\n", "line 3, '1 2 x', does not begin"),
        ("2\nwater\nO 0 0 0\nH 0 0 1\n", "line 3, 'O 0 0 0', does not begin"),
        ("garbage,1,2\n" + ROWS, "line 1, 'garbage,1,2', does not begin"),
        ("a gear\nfoo 7 8 9\n" + ROWS, "line 2, 'foo 7 8 9', does not begin"),
        ("a\nb\nc\n" + ROWS, "line 3, 'c', does not begin"),
        (",,\n" + ROWS, "line 1, ',,', does not begin"),
        (",2,3\n" + ROWS, "1 of 3 points are not finite"),
        ("3\n" + ROWS, "its first line promises 3 points, it holds 2"),
        ("1,,3\n", "1 of 1 points are not finite"),
        ("1 2 nan\n", "1 of 1 points are not finite"),
    ],
)
def test_lines_that_are_no_points_are_named(read, text, reason):
    with pytest.raises(BadArtifact, match=reason):
        read(text)
