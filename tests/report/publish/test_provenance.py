"""What a published result says of where it comes from, and what it must not say."""

import json
import platform
import subprocess

import pytest

from industnerf.errors import BadArtifact
from industnerf.report.publish.provenance import (
    PACKAGES,
    build_provenance,
    environment,
    provenance_line,
)


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with one commit, and the process in it."""
    monkeypatch.chdir(tmp_path)
    git("init", "-q")
    for name in ("code.py", "README.md", "dvc.lock"):
        (tmp_path / name).write_text("as committed\n")
    git("add", "-A")
    git("-c", "user.name=n", "-c", "user.email=e@example.org", "commit", "-q", "-m", "first")
    return tmp_path


def git(*arguments):
    return subprocess.run(["git", *arguments], check=True, capture_output=True, text=True).stdout


def test_a_clean_tree_is_said_to_be_clean(repository):
    provenance = build_provenance("make repro")
    assert provenance["command"] == "make repro"
    assert provenance["commit"] == git("rev-parse", "HEAD").strip()
    assert (provenance["clean"], provenance["changed"]) == (True, [])


def test_what_differs_is_named(repository):
    (repository / "code.py").write_text("changed\n")
    (repository / "new.py").write_text("new\n")
    provenance = build_provenance("make repro")
    assert (provenance["clean"], provenance["changed"]) == (False, ["code.py", "new.py"])


def test_what_is_written_afterwards_does_not_count(repository):
    for name in ("README.md", "dvc.lock", "results/study/table1.csv"):
        (repository / name).parent.mkdir(parents=True, exist_ok=True)
        (repository / name).write_text("changed\n")
    assert build_provenance("make repro")["clean"]


def test_without_a_commit_nothing_is_published(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    with pytest.raises(BadArtifact, match="no commit to publish under"):
        build_provenance("make repro")


def test_a_stamp_names_the_commit_seen_from_any_folder(repository, monkeypatch):
    (repository / "runs").mkdir()
    monkeypatch.chdir(repository / "runs")
    commit = f"commit {git('rev-parse', 'HEAD')[:7]}"
    assert f", {commit}, " in provenance_line()
    (repository / "code.py").write_text("changed\n")
    assert f", {commit} with changes, " in provenance_line()


def test_a_stamp_without_a_repository_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    assert ", commit none, " in provenance_line()


def test_the_environment_names_versions_and_no_host():
    recorded = environment()
    assert set(recorded["packages"]) == set(PACKAGES)
    assert recorded["cores"] >= 1
    text = json.dumps(recorded)
    assert platform.node() not in text
    assert "/home" not in text
    assert "/usr" not in text
