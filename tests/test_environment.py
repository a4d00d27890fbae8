"""The local file of variables, and numbers among them."""

import os

import pytest

from industnerf import environment
from industnerf.errors import BadParams


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
