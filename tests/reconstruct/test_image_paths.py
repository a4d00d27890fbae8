"""Photographs are found by the names that tools give them."""

from pathlib import Path

import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files.frames import Frame
from industnerf.reconstruct.image_paths import (
    ImageFinder,
    find_images,
    no_such_photograph,
    protected_paths,
    unlisted_images,
)


def make_frame(name, number=0):
    return Frame(number, name, {}, None)


@pytest.fixture
def finder(tmp_path):
    """`images` has what `beside` has, and one more."""
    for name in ("images/1.png", "images/sub/2.JPG", "beside/rgb/1.png", "beside/rgb/3.0.jpeg"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    return ImageFinder((tmp_path / "images", tmp_path / "beside"))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("1.png", "images/1.png"),
        ("1", "images/1.png"),
        ("sub/2", "images/sub/2.JPG"),
        ("rgb/1.png", "images/1.png"),  # the first folder goes before the fuller name
        ("rgb/3.0", "beside/rgb/3.0.jpeg"),  # a dot is no extension
        ("../images/1", "images/1.png"),
        ("/elsewhere/images/sub/2.JPG", "images/sub/2.JPG"),
    ],
)
def test_a_photograph_is_where_a_user_would_look(finder, tmp_path, name, expected):
    assert finder.find(name).resolve() == (tmp_path / expected).resolve()


def test_an_absolute_name_is_itself(finder, tmp_path):
    (tmp_path / "beside/1.png").touch()
    name = str(tmp_path / "beside/1.png")
    assert finder.find(name) == Path(name)


@pytest.mark.parametrize("name", ["7.png", "sub", "/", ".."])
def test_a_missing_photograph_is_named_with_the_folders_searched(finder, name):
    assert finder.find(name) is None
    with pytest.raises(BadArtifact) as refusal:
        find_images([make_frame(name, 4)], finder)
    assert str(refusal.value) == no_such_photograph(make_frame(name, 4), finder)
    assert f"frame 4 ({name})" in str(refusal.value)
    assert all(str(folder) in str(refusal.value) for folder in finder.folders)


def test_two_frames_cannot_share_a_photograph(finder):
    with pytest.raises(BadArtifact, match=r"frame 0 \(1\) and frame 2 \(left/1.png\) are the same"):
        find_images([make_frame("1"), make_frame("sub/2", 1), make_frame("left/1.png", 2)], finder)


def test_images_beside_the_photographs_are_unnamed_if_no_frame_has_them(finder, tmp_path):
    for name in ("images/2.png", "images/0.JPG", "images/notes.txt", "beside/4.png"):
        (tmp_path / name).touch()
    (tmp_path / "images/folder.png").mkdir()
    frames = [
        make_frame("1"),
        make_frame("sub/2", 1),
        make_frame("rgb/2.png", 2),
        make_frame("9", 3),
    ]
    image_paths = find_images(frames[:1], finder)
    # frame 2 is not used and has 2.png nevertheless; frame 3 has none; in beside no photograph is
    assert unlisted_images(image_paths, protected_paths(frames, finder)) == [
        tmp_path / "images/0.JPG"
    ]
    assert unlisted_images(image_paths, protected_paths(frames[:1], finder)) == [
        tmp_path / f"images/{n}" for n in ("0.JPG", "2.png")
    ]


def test_an_image_that_another_goes_before_is_named_all_the_same(finder, tmp_path):
    """Frame 0's is in both folders, and that of `beside` has frame 1's for a neighbor."""
    frames = [make_frame("rgb/1.png"), make_frame("rgb/3.0", 1)]
    image_paths = find_images(frames, finder)
    both_paths = [tmp_path / "images/1.png", tmp_path / "beside/rgb/1.png"]
    assert protected_paths(frames[:1], finder) == both_paths
    assert image_paths == [both_paths[0], tmp_path / "beside/rgb/3.0.jpeg"]
    assert unlisted_images(image_paths, protected_paths(frames, finder)) == []


GEHAEUSE = ("Geh\u00e4use_1.PNG", "Geha\u0308use_1.PNG")  # as Windows spells it, and as macOS did


@pytest.mark.parametrize("written", GEHAEUSE)
@pytest.mark.parametrize("on_disk", GEHAEUSE)
def test_a_name_matches_whatever_its_unicode_form_and_case(tmp_path, written, on_disk):
    (tmp_path / "Bilder").mkdir()
    (tmp_path / "Bilder" / on_disk).touch()
    finder = ImageFinder((tmp_path,))
    frames = [make_frame(f"{folder}/{written.lower()}") for folder in ("Bilder", "bilder", "other")]
    paths = find_images(frames[:1], finder)
    assert paths == [tmp_path / "Bilder" / on_disk]
    assert finder.find(f"bilder/{written.lower()}") == paths[0]
    assert finder.find(f"bilder/{written.lower().removesuffix('.png')}") == paths[0]
    assert unlisted_images(paths, protected_paths(frames[:1], finder)) == []


def test_an_exact_name_goes_before_one_that_differs_in_case(tmp_path):
    for name in ("a.png", "A.png"):
        (tmp_path / name).touch()
    if len(list(tmp_path.iterdir())) < 2:
        pytest.skip("this disk ignores case itself")
    finder = ImageFinder((tmp_path,))
    assert [finder.find(name) for name in ("a.png", "A.png")] == [
        tmp_path / "a.png",
        tmp_path / "A.png",
    ]
    assert finder.find("a.PNG") is None  # it may be either


def test_missing_photographs_are_none(tmp_path):
    (tmp_path / "1.png").touch()
    frames = [make_frame("1.png"), make_frame("2.png", 1)]
    assert find_images(frames, ImageFinder((tmp_path,))) == [tmp_path / "1.png", None]
