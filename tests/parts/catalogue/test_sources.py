"""Which files are read, which parts they become, and what each is called."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from industnerf.artifacts.part import UNSPECIFIED, Mesh
from industnerf.artifacts.solids import Solid, Solids
from industnerf.errors import BadParams
from industnerf.parts.catalogue.sources import embedded_parts, user_parts
from industnerf.parts.io.cad_files import file_ids, find_cad_files, require_path, unread_files
from industnerf.schema import RepairParams

REPAIR = RepairParams(1e-6, 0.0, 0.0, 0.0, False, False, False, 0)


def params(**changes):
    values = {"pattern": "**/*", "select": [], "split_bodies": False, "repair": REPAIR}
    return SimpleNamespace(**(values | changes))


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "cad"
    hidden = (".hidden.stl", ".trash/old.stl")
    for name in ("A b.STL", "sub/c.step", "sub/c.obj", "sub/c.mtl", "notes.txt", *hidden):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    return folder


def ids(files):
    return [(file.file_id, file.family) for file in files]


def test_a_folder_gives_its_cad_files_and_passes_over_the_rest(folder):
    files = find_cad_files(folder, "**/*", [])
    assert ids(files) == [("a-b", "own"), ("sub-c-obj", "sub"), ("sub-c-step", "sub")]
    assert files[0].path == folder / "A b.STL"


def test_what_is_passed_over_has_a_name_but_for_sidecars(folder):
    (folder / "sub/c.obj").write_text("mtllib c.mtl\nv 0 0 0\n")
    unread = unread_files(folder, folder.glob("**/*"))
    assert [path.name for path in unread] == ["notes.txt"]
    (folder / "sub/c.obj").write_text("v 0 0 0\n")
    assert [path.name for path in unread_files(folder, folder.glob("sub/*"))] == ["c.mtl"]


def test_a_pattern_and_select_choose_among_them(folder):
    assert ids(find_cad_files(folder, "sub/*.step", [])) == [("sub-c", "sub")]
    # a solid of a file asks for the file; a name that is only the beginning of an id does not
    assert ids(find_cad_files(folder, "**/*", ["sub-c-obj-bolt-2"])) == [("sub-c-obj", "sub")]
    assert ids(find_cad_files(folder, "**/*", ["sub"])) == []


def test_a_file_whose_name_begins_another_is_not_read_for_it(tmp_path):
    for name in ("bracket.stl", "bracket-large.stl"):
        (tmp_path / name).touch()

    def selected_ids(*select):
        return {file.file_id for file in find_cad_files(tmp_path, "**/*", [*select])}

    assert selected_ids("bracket-large") == {"bracket-large"}
    assert selected_ids("bracket") == {"bracket"}
    assert selected_ids("bracket-bolt") == {"bracket"}  # a solid of it, perhaps
    assert selected_ids("bracket-large-bolt") == {"bracket", "bracket-large"}  # of either


def test_one_file_is_taken_under_any_name(folder):
    assert ids(find_cad_files(folder / "notes.txt", "**/*", [])) == [("notes", "own")]


def test_ids_come_from_paths_and_distinguish_types(tmp_path):
    names = ["A b.stl", "sub/A b.stl", "sub/c.STL", "sub/c.obj"]
    file_names = file_ids(tmp_path, [tmp_path / name for name in names])
    assert file_names == ["a-b", "sub-a-b", "sub-c-stl", "sub-c-obj"]
    with pytest.raises(BadParams, match="share the id 'a-b-stl'; rename one"):
        file_ids(tmp_path, [tmp_path / "a-b.stl", tmp_path / "a b.stl"])


def test_what_is_not_there_is_named_and_a_pattern_is_taken_apart(folder):
    with pytest.raises(BadParams, match=r"no file in .* matches parts.pattern 'x/\*' and ends in"):
        find_cad_files(folder, "x/*", [])
    with pytest.raises(BadParams, match="neither a folder nor a file"):
        find_cad_files(folder / "gone", "**/*", [])
    with pytest.raises(BadParams, match=r'write path: my/cad and pattern: "\*\*/\*\.step"'):
        require_path(Path("my/cad/**/*.step"))
    with pytest.raises(BadParams, match=r"parts\.pattern: '/etc/"):
        find_cad_files(folder, "/etc/*", [])


def solids_in(folder, *names):
    mesh = Mesh.with_one_appearance(np.eye(3), np.array([(0, 1, 2)], np.int32))
    folder.mkdir(parents=True)
    Solids(
        "f", "STEP", "mm, stated", (UNSPECIFIED,), (), tuple(Solid(n, mesh) for n in names)
    ).save(folder)


@pytest.fixture
def read(folder, tmp_path):
    """Two of the three files were read; the third failed."""
    solids_in(tmp_path / "solids" / "a-b", "solid 1")
    solids_in(tmp_path / "solids" / "sub-c-step", "nut", "Bolt M8", "nut")
    return tmp_path / "solids"


def parts(folder, read, **changes):
    read_ids = {path.name for path in read.iterdir()}
    return user_parts(folder, read, read_ids, params(**changes))


def test_a_file_is_a_part(folder, read):
    tasks = parts(folder, read)
    assert [part.part_id for part in tasks] == ["a-b", "sub-c-step"]
    assert [part.settings for part in tasks] == [
        ["a-b", "own", None, REPAIR],
        ["sub-c-step", "sub", None, REPAIR],
    ]
    assert tasks[0].make.args == (read / "a-b", "a-b", "own", None, REPAIR)
    assert [path.name for path in tasks[0].files] == ["solids.json", "solids.npz"]


def test_or_every_solid_of_several_is(folder, read):
    tasks = parts(folder, read, split_bodies=True)
    split = ["sub-c-step-nut-1", "sub-c-step-bolt-m8", "sub-c-step-nut-3"]
    assert [(part.part_id, part.settings[2]) for part in tasks] == [
        ("a-b", None),
        *zip(split, range(3), strict=True),
    ]


def test_names_that_collide_become_numbers(folder, tmp_path):
    solids_in(tmp_path / "solids" / "a-b", "nut", "nut", "nut 1")
    tasks = parts(folder, tmp_path / "solids", split_bodies=True)
    assert [part.part_id for part in tasks] == ["a-b-1", "a-b-2", "a-b-3"]


def test_select_names_parts_or_whole_files_and_refuses_what_is_not_there(folder, read):
    def selected_ids(*names):
        return [part.part_id for part in parts(folder, read, split_bodies=True, select=[*names])]

    assert selected_ids("sub-c-step-nut-3") == ["sub-c-step-nut-3"]
    assert len(selected_ids("sub-c-step")) == 3
    assert selected_ids("sub-c-obj") == []  # it is there, and failed to be read
    with pytest.raises(BadParams, match=r"parts\.select: 'gear' is not among a-b, sub-c-obj, sub"):
        selected_ids("gear")


def test_two_parts_of_one_id_are_refused(folder, read, tmp_path):
    (folder / "sub c step bolt m8.stl").touch()
    solids_in(read / "sub-c-step-bolt-m8", "x")
    with pytest.raises(BadParams, match="two parts share the id 'sub-c-step-bolt-m8'"):
        parts(folder, read, split_bodies=True)


def test_a_part_with_the_name_of_a_file_that_failed_is_refused(folder, read):
    (folder / "sub c step bolt m8.stl").touch()
    with pytest.raises(BadParams, match="two parts share the id 'sub-c-step-bolt-m8'"):
        parts(folder, read, split_bodies=True)


def test_an_unselected_file_causes_no_duplicate_id(folder, read):
    """It was not read, as those that failed were not."""
    (folder / "sub c step bolt m8.stl").touch()
    tasks = parts(folder, read, split_bodies=True, select=["sub-c-step"])
    assert len(tasks) == 3


def test_a_folder_without_a_catalogue_names_the_key_to_set(tmp_path):
    with pytest.raises(BadParams, match=r"holds no catalogue\.json.*set parts\.source: path"):
        embedded_parts(tmp_path, [])
