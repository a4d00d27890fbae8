"""Which folder a report goes to, and what is left alone there."""

import pytest

from industnerf.errors import BadParams
from industnerf.outside.reports import begin, folder_for


@pytest.fixture
def places(tmp_path):
    """Two folders of one name."""
    for name in ("a", "b"):
        (tmp_path / name / "clouds").mkdir(parents=True)
    return tmp_path / "a/clouds", tmp_path / "b/clouds"


def test_two_places_of_one_name_have_a_folder_each_and_keep_it(tmp_path, places):
    root = tmp_path / "score"
    for _ in range(2):
        for place, name in zip(places, ("clouds", "clouds-2"), strict=True):
            folder = folder_for(root, place, "", [place])
            assert folder == root / name
            begin(folder, place, "")


def test_another_part_of_the_same_cloud_is_another_report(tmp_path, places):
    begin(tmp_path / "score/clouds", places[0], "gear")
    assert folder_for(tmp_path / "score", places[0], "nut", []) == tmp_path / "score/clouds-2"


def test_a_report_that_does_not_say_of_what_it_is_stays(tmp_path, places):
    (tmp_path / "score/clouds/scores").mkdir(parents=True)
    assert folder_for(tmp_path / "score", places[0], "", []) == tmp_path / "score/clouds-2"


def test_sources_in_the_folder_are_refused_also_through_a_link(tmp_path, places):
    root = tmp_path / "score"
    (root / "clouds").mkdir(parents=True)
    (root / "clouds/a.ply").touch()
    (tmp_path / "a.ply").symlink_to(root / "clouds/a.ply")
    for source in (root / "clouds", root / "clouds/a.ply", tmp_path / "a.ply"):
        with pytest.raises(BadParams, match=f"{source} lies in .*move or rename it"):
            folder_for(root, places[0], "", [source])
    assert folder_for(root, places[0], "", [places[0]]) == root / "clouds-2"


def test_of_two_that_ask_at_once_each_has_a_folder(tmp_path, places):
    """The second asks when the first has its folder, and has not begun."""
    root = tmp_path / "score"
    of = [folder_for(root, place, part, []) for place in places for part in ("", "gear")]
    assert [folder.name for folder in of] == ["clouds", "clouds-2", "clouds-3", "clouds-4"]
    assert folder_for(root, places[1], "", []) == root / "clouds-3"


def test_a_folder_that_somebody_takes_meanwhile_is_left_to_him(tmp_path, places, monkeypatch):
    root = tmp_path / "score"
    mkdir = type(root).mkdir

    def late(folder, *args, **kwargs):
        if folder == root / "clouds":
            mkdir(folder)
        mkdir(folder, *args, **kwargs)

    monkeypatch.setattr(type(root), "mkdir", late)
    assert folder_for(root, places[0], "", []) == root / "clouds-2"


def test_a_file_or_folder_of_that_name_is_left_alone(tmp_path, places):
    (tmp_path / "score/clouds-2").mkdir(parents=True)
    (tmp_path / "score/clouds").touch()
    assert folder_for(tmp_path / "score", places[0], "", []) == tmp_path / "score/clouds-3"


def test_only_what_is_made_here_is_removed(tmp_path, places):
    out = tmp_path / "out"
    for name in ("scores", "mine"):
        (out / name).mkdir(parents=True)
    begin(out, places[0], "")
    assert {path.name for path in out.iterdir()} == {"mine", "asked.json"}
