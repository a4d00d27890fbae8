"""Which folder a report goes to, and what is left alone there."""

import pytest

from industnerf.errors import BadParams
from industnerf.external.report_folders import report_folder, start_report


@pytest.fixture
def clouds_folders(tmp_path):
    """Two folders of one name."""
    for name in ("a", "b"):
        (tmp_path / name / "clouds").mkdir(parents=True)
    return tmp_path / "a/clouds", tmp_path / "b/clouds"


def test_two_places_of_one_name_have_a_folder_each_and_keep_it(tmp_path, clouds_folders):
    root = tmp_path / "score"
    for _ in range(2):
        for clouds, name in zip(clouds_folders, ("clouds", "clouds-2"), strict=True):
            folder = report_folder(root, clouds, "", [clouds])
            assert folder == root / name
            start_report(folder, clouds, "")


def test_another_part_of_the_same_cloud_is_another_report(tmp_path, clouds_folders):
    start_report(tmp_path / "score/clouds", clouds_folders[0], "gear")
    assert (
        report_folder(tmp_path / "score", clouds_folders[0], "nut", [])
        == tmp_path / "score/clouds-2"
    )


def test_a_report_that_does_not_say_of_what_it_is_stays(tmp_path, clouds_folders):
    (tmp_path / "score/clouds/scores").mkdir(parents=True)
    assert (
        report_folder(tmp_path / "score", clouds_folders[0], "", []) == tmp_path / "score/clouds-2"
    )


def test_sources_in_the_folder_are_refused_also_through_a_link(tmp_path, clouds_folders):
    root = tmp_path / "score"
    (root / "clouds").mkdir(parents=True)
    (root / "clouds/a.ply").touch()
    (tmp_path / "a.ply").symlink_to(root / "clouds/a.ply")
    for source in (root / "clouds", root / "clouds/a.ply", tmp_path / "a.ply"):
        with pytest.raises(BadParams, match=f"{source} lies in .*move or rename it"):
            report_folder(root, clouds_folders[0], "", [source])
    assert report_folder(root, clouds_folders[0], "", [clouds_folders[0]]) == root / "clouds-2"


def test_of_two_that_ask_at_once_each_has_a_folder(tmp_path, clouds_folders):
    """The second asks when the first has its folder, and has not begun."""
    root = tmp_path / "score"
    folder_of = [
        report_folder(root, clouds, part, []) for clouds in clouds_folders for part in ("", "gear")
    ]
    assert [folder.name for folder in folder_of] == ["clouds", "clouds-2", "clouds-3", "clouds-4"]
    assert report_folder(root, clouds_folders[1], "", []) == root / "clouds-3"


def test_a_folder_that_somebody_takes_meanwhile_is_left_to_him(
    tmp_path, clouds_folders, monkeypatch
):
    root = tmp_path / "score"
    mkdir = type(root).mkdir

    def late(folder, *args, **kwargs):
        if folder == root / "clouds":
            mkdir(folder)
        mkdir(folder, *args, **kwargs)

    monkeypatch.setattr(type(root), "mkdir", late)
    assert report_folder(root, clouds_folders[0], "", []) == root / "clouds-2"


def test_a_file_or_folder_of_that_name_is_left_alone(tmp_path, clouds_folders):
    (tmp_path / "score/clouds-2").mkdir(parents=True)
    (tmp_path / "score/clouds").touch()
    assert (
        report_folder(tmp_path / "score", clouds_folders[0], "", []) == tmp_path / "score/clouds-3"
    )


def test_only_what_is_made_here_is_removed(tmp_path, clouds_folders):
    out = tmp_path / "out"
    for name in ("scores", "mine"):
        (out / name).mkdir(parents=True)
    start_report(out, clouds_folders[0], "")
    assert {path.name for path in out.iterdir()} == {"mine", "request.json"}
