"""Digests of results, compared with those that are published."""

import json

import pytest

from industnerf import processor
from industnerf.doctor import reproducible
from industnerf.doctor.project_paths import ProjectPaths


@pytest.mark.slow
def test_this_machine_gives_the_published_bytes(root):
    (finding,) = reproducible.check(ProjectPaths.from_root(root))
    assert not finding.is_error, finding.message


@pytest.fixture
def paths(tmp_path, monkeypatch) -> ProjectPaths:
    """A working copy where two digests are published, and both are as published."""
    versions = reproducible.installed_versions()
    published = {"processor": "Abacus", "isa": "beads", "versions": versions}
    path = tmp_path / reproducible.DIGESTS
    path.parent.mkdir()
    path.write_text(json.dumps(published | {"digests": {"sums": "1", "nets": "2"}}))
    monkeypatch.setattr(
        reproducible, "compute_digests", lambda root: iter([("sums", "1"), ("nets", "2")])
    )
    return ProjectPaths.from_root(tmp_path)


def test_equal_digests_are_nothing_wrong(paths):
    (finding,) = reproducible.check(paths)
    assert not finding.is_error
    assert processor.isa() in finding.message


def test_what_differs_is_named_with_both_machines(paths, monkeypatch):
    monkeypatch.setattr(
        reproducible, "compute_digests", lambda root: iter([("sums", "1"), ("nets", "3")])
    )
    (finding,) = reproducible.check(paths)
    assert finding.is_error
    assert finding.message.endswith("(Abacus, beads) of nets")


def test_another_version_is_named(paths, monkeypatch):
    monkeypatch.setattr(reproducible, "compute_digests", lambda root: iter([("sums", "0")]))
    monkeypatch.setattr(reproducible, "installed_versions", lambda: {"numpy": "99"})
    (finding,) = reproducible.check(paths)
    assert "numpy is 99 and was" in finding.message


def test_every_operation_gives_the_same_bytes_twice():
    for name, operation in reproducible.OPERATIONS.items():
        first, second = operation(), operation()
        assert [a.tobytes() for a in first] == [b.tobytes() for b in second], name
