"""transforms.json: which frames are used, and a sentence where it is not what it should be."""

import json

import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.camera_files import read_camera_file
from industnerf.reconstruct.camera_files.frames import normalize_path
from tests.reconstruct import sample_images


@pytest.fixture
def transforms():
    return sample_images.transforms_content(sample_images.cameras())


def load(tmp_path, transforms, all_frames=False):
    """The frames to use, and all that are listed."""
    camera_file = read_camera_file(sample_images.write_json_file(tmp_path / "t.json", transforms))
    return camera_file.frames_to_use(all_frames=all_frames), camera_file.frames


def test_frames_keep_their_order_and_number(tmp_path, transforms):
    transforms["frames"].reverse()
    used_frames, listed_frames = load(tmp_path, transforms)
    assert [(frame.index, frame.name) for frame in used_frames] == [
        (i, f"rgb/{4 - i:03d}.png") for i in range(5)
    ]
    assert listed_frames == used_frames
    assert str(used_frames[1]) == "frame 1 (rgb/003.png)"


def test_only_training_frames_unless_all_are_asked_for(tmp_path, transforms):
    transforms["train_filenames"] = ["./rgb/003.png", "rgb\\001.png"]
    used_frames, listed_frames = load(tmp_path, transforms)
    assert [frame.index for frame in used_frames] == [1, 3]
    assert [frame.index for frame in listed_frames] == [0, 1, 2, 3, 4]
    assert load(tmp_path, transforms, all_frames=True) == (listed_frames, listed_frames)


@pytest.mark.parametrize(
    ("written", "expected"),
    [("./a.png", "a.png"), (".\\rgb\\a", "rgb/a"), (".//./a", "a"), ("../a", "../a"), ("a", "a")],
)
def test_names_are_written_in_many_ways(written, expected):
    assert normalize_path(written) == expected


def test_a_byte_order_mark_is_no_fault(tmp_path, transforms):
    path = tmp_path / "t.json"
    path.write_text(json.dumps(transforms), encoding="utf-8-sig")
    assert len(read_camera_file(path).frames) == 5


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"frames": []}, "`frames` is missing or empty"),
        ({"frames": {"0": 1}}, "`frames` is missing or empty"),
        ({"frames": [{"file_path": "a"}, 7]}, "frame 0 (a) has no `transform_matrix`"),
        ({"frames": [7]}, "frame 0 is no object"),
        ({"frames": [{"transform_matrix": []}]}, "frame 0 has no `file_path`"),
        ({"frames": [{"file_path": "./"}]}, "frame 0 has no `file_path`"),
        ({"train_filenames": ["rgb/9.png"]}, "'rgb/9.png', which no frame has"),
        ({"train_filenames": "rgb/001.png"}, "`train_filenames` must be a list of names"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, transforms, change, complaint):
    with pytest.raises(BadArtifact) as refusal:
        load(tmp_path, transforms | change)
    assert complaint in str(refusal.value)
    assert "t.json" in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "complaint"), [("{", "no[t]? readable JSON"), ("[1]", "holds a list")]
)
def test_other_files_are_refused(tmp_path, text, complaint):
    (tmp_path / "t.json").write_text(text)
    with pytest.raises(BadArtifact, match=complaint):
        read_camera_file(tmp_path / "t.json")


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    missing, folder = (tmp_path / "none.json", "No such file"), (tmp_path, "holds no cameras")
    for path, reason in (missing, folder):
        with pytest.raises(BadArtifact, match=reason):
            read_camera_file(path)
