"""The local file of variables, and numbers among them."""

import os
import subprocess

import pytest

from industnerf import environment
from industnerf.errors import BadParams
from industnerf.store import Store
from industnerf.tracking import database_dir


@pytest.fixture
def file(tmp_path, monkeypatch):
    """Writes .industnerf.env; what is taken over from it is forgotten afterwards."""
    monkeypatch.setattr(os, "environ", dict(os.environ))

    def write(text):
        (tmp_path / ".industnerf.env").write_text(text)
        return tmp_path / ".industnerf.env"

    return write


def test_the_environment_wins_over_the_file(file):
    os.environ["INDUSTNERF_WORKERS"] = "3"
    environment.read_local_file(
        file("# mine\n\nINDUSTNERF_WORKERS=5\nINDUSTNERF_SLURM_GRES=gpu:1 \n")
    )
    assert os.environ["INDUSTNERF_WORKERS"] == "3"
    assert os.environ["INDUSTNERF_SLURM_GRES"] == "gpu:1"


def test_no_file_changes_nothing(tmp_path):
    before = dict(os.environ)
    environment.read_local_file(tmp_path / "absent")
    assert dict(os.environ) == before


def git(folder, *command):
    names = ("-c", "user.name=n", "-c", "user.email=e@example.org")
    subprocess.run(["git", *names, *command], cwd=folder, check=True)


def test_a_checkout_beside_the_main_one_has_its_store_and_its_file(tmp_path, monkeypatch):
    """DVC runs queued experiments in temporary ones; without the store they would start anew."""
    main, worktree = tmp_path / "main", tmp_path / "worktree"
    temporary = main / ".dvc/tmp/exps/standalone/tmp1"
    temporary.mkdir(parents=True)
    git(main, "init", "-q")
    git(main, "commit", "-q", "--allow-empty", "-m", "first")
    git(main, "worktree", "add", "-q", str(worktree))
    git(temporary, "init", "-q")
    (main / ".industnerf.env").write_text("INDUSTNERF_SLURM_GRES=gpu:7")
    monkeypatch.delenv("INDUSTNERF_STORE", raising=False)
    monkeypatch.delenv("INDUSTNERF_MLFLOW", raising=False)
    for folder in (main, worktree, temporary):
        monkeypatch.chdir(folder)
        monkeypatch.setattr(os, "environ", dict(os.environ))
        environment.read_local_file()
        assert os.environ.pop("INDUSTNERF_SLURM_GRES") == "gpu:7"
        assert Store.from_environment().root == main / ".store"
        assert database_dir() == main
    monkeypatch.setenv("INDUSTNERF_STORE", "other")
    assert Store.from_environment().root == main / "other"
    monkeypatch.setenv("INDUSTNERF_STORE", str(tmp_path / "absolute"))
    assert Store.from_environment().root == tmp_path / "absolute"


def test_the_project_of_a_preset_has_the_store_of_its_checkout(tmp_path):
    """Else `dvc repro` in runs/<preset> would make anew what `pipeline.preset` has made."""
    project = tmp_path / "runs" / "demo"
    project.mkdir(parents=True)
    (tmp_path / "dvc.yaml").write_text("stages: {}")
    (project / "dvc.yaml").symlink_to("../../dvc.yaml")
    assert environment.main_checkout(project) == tmp_path


def test_a_folder_of_its_own_is_its_own_main_checkout(tmp_path):
    git(tmp_path, "init", "-q")
    (tmp_path / "runs/demo").mkdir(parents=True)
    for folder in (tmp_path, tmp_path / "runs/demo"):
        assert environment.main_checkout(folder) == folder


@pytest.mark.parametrize(
    "line", ["INDUSTNERF_RUNNER submitit", "PATH=/bin", "export INDUSTNERF_A=1"]
)
def test_a_line_that_means_nothing_is_named(file, line):
    path = file(f"# mine\n{line}\n")
    with pytest.raises(BadParams, match=rf"{path}:2: '{line}' is no NAME=value"):
        environment.read_local_file(path)


@pytest.mark.parametrize("value", ["many", "0", "-1", "1.5", "1e3", "²", " 4"])
def test_what_is_no_number_is_refused(monkeypatch, value):
    monkeypatch.setenv("INDUSTNERF_WORKERS", value)
    with pytest.raises(BadParams, match=r"INDUSTNERF_WORKERS is .*, must be a number of processes"):
        environment.get_positive_int("INDUSTNERF_WORKERS", "processes")


def test_an_empty_variable_is_as_good_as_none(monkeypatch):
    monkeypatch.setenv("INDUSTNERF_WORKERS", "")
    assert environment.get_positive_int("INDUSTNERF_WORKERS", "processes", 7) == 7
    assert environment.get_str("INDUSTNERF_WORKERS") is None
