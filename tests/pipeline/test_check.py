"""What `make repro` looks at before DVC starts."""

import shutil
from pathlib import Path

import pytest

from industnerf.errors import BadParams
from pipeline import check

ROOT = Path(__file__).parents[2]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """As much of a working copy as is looked at."""
    for name in ("params.yaml", "dvc.yaml"):
        shutil.copy(ROOT / name, tmp_path)
    for folder in (".dvc", "data/embedded"):
        (tmp_path / folder).mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_nothing_is_wrong(project: Path):
    check.main()


def test_wrong_values_end_it(project: Path):
    params = project / "params.yaml"
    params.write_text(params.read_text().replace("preset: study", "preset: [1, 2]"))
    with pytest.raises(BadParams, match="preset"):
        check.main()


def test_parts_that_are_not_there_end_it(project: Path):
    (project / "data" / "embedded").rmdir()
    with pytest.raises(BadParams, match="data/embedded"):
        check.main()


def test_a_lock_file_cut_short_is_set_aside(project: Path, capsys: pytest.CaptureFixture[str]):
    (project / "dvc.lock").touch()
    check.main()
    assert not (project / "dvc.lock").exists()
    assert "dvc.lock: has 0 characters" in capsys.readouterr().err
