"""XYZ files as programs write them."""

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.external.points import read_cloud

POINTS = [[1.5, -2.0, 3e-3], [4.0, 5.0, 6.25]]
ROWS = "1.5 -2 3e-3\n4 5 6.25\n"


@pytest.fixture
def read(tmp_path):
    def read_text(text):
        (tmp_path / "a.xyz").write_text(text)
        content = read_cloud(tmp_path / "a.xyz", 10, np.random.default_rng(0))
        return content.points, list(content.warnings)

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
    with pytest.raises(BadArtifact, match=r"a\.xyz cannot be read: no point in the file"):
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
        ("3\n" + ROWS, "its first line promises 3 points, it holds 2"),
        ("1,,3\n", "none of its 1 points is finite"),
        ("1 2 nan\n", "none of its 1 points is finite"),
    ],
)
def test_lines_that_are_no_points_are_named(read, text, reason):
    with pytest.raises(BadArtifact, match=reason):
        read(text)


@pytest.mark.parametrize(
    "text",
    [
        "id,x,y,z\n7,1.5,-2,3e-3\n8,4,5,6.25\n",
        'Point ID;"Z [mm]";"X [mm]";"Y [mm]"\n7 a;3e-3;1.5;-2\n8 b;6.25;4;5\n'.replace(" ID", ""),
        "# intensity x y z\n7 1.5 -2 3e-3\n8 4 5 6.25\n",
        "made by hand\nname\tX\tY\tZ\na\t1.5\t-2\t3e-3\nb\t4\t5\t6.25\n",
    ],
)
def test_columns_that_are_named_are_found_wherever_they_stand(read, text):
    points, warnings = read(text.replace("7 a", "7").replace("8 b", "8"))
    np.testing.assert_array_equal(points, POINTS)
    assert "x, y, z are its columns " in warnings[-1]


def test_a_row_without_the_named_columns_is_named(read):
    with pytest.raises(BadArtifact, match=r"line 2, '1,2,3', has no numbers in columns 2, 3, 4"):
        read("id,x,y,z\n1,2,3\n")


@pytest.mark.parametrize(
    "text",
    [
        "//X Y Z R G B\n1 2 3 255 0 10\n4 5 6 1 2 3\n",
        "x,y,z,r,g,b,nx,ny,nz\n1,2,3,255,0,10,0,0,1\n4,5,6,1,2,3,0,1,0\n",
        "1 2 3 255 0 10\n4 5 6 1 2 3\n",
        "2\n1 2 3 -99 255 0 10\n4 5 6 -98 1 2 3\n",  # PTS: intensity before the color
    ],
)
def test_whole_numbers_behind_the_points_are_colors(tmp_path, text):
    (tmp_path / "a.pts").write_text(text)
    content = read_cloud(tmp_path / "a.pts", 10, np.random.default_rng(0))
    assert content.colors.tolist() == [[255, 0, 10], [1, 2, 3]]


@pytest.mark.parametrize(
    "text", ["1 2 3 0 0 1\n", "1 2 3 0.5 0.1 0.2\n", "x y z i j k\n1 2 3 9 9 9"]
)
def test_normals_and_other_numbers_are_no_colors(tmp_path, text):
    (tmp_path / "a.txt").write_text(text)
    assert read_cloud(tmp_path / "a.txt", 10, np.random.default_rng(0)).colors is None
