"""A checkpoint is what was saved, or nothing."""

from functools import partial
from pathlib import Path

import pytest
import torch

from industnerf.errors import BadArtifact
from industnerf.learning import checkpoint

STATE = {"step": 3, "losses": [0.5, 0.25], "net": {"w": torch.arange(2000.0)}}


def test_what_is_loaded_is_what_was_saved(tmp_path):
    path = tmp_path / "of a net" / "net.pt"
    checkpoint.save(path, STATE)
    result = checkpoint.load(path)
    assert torch.equal(result["net"].pop("w"), STATE["net"]["w"])
    assert result == {"step": 3, "losses": [0.5, 0.25], "net": {}}
    assert list(path.parent.iterdir()) == [path]


def test_where_nothing_was_saved_there_is_nothing(tmp_path, capsys):
    assert checkpoint.load(tmp_path / "net.pt") is None
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("kept", [0.0, 0.01, 0.3, 0.9, 0.999])
def test_a_torn_one_is_nothing_and_is_spoken_of(tmp_path, capsys, kept):
    path = tmp_path / "net.pt"
    checkpoint.save(path, STATE)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    assert checkpoint.load(path) is None
    assert f"{path} cannot be read" in capsys.readouterr().err


@pytest.mark.parametrize("junk", [b"no checkpoint\n", bytes(range(256)) * 9, b"\x80\x02}q\x00."])
def test_so_is_what_is_no_checkpoint(tmp_path, junk):
    (tmp_path / "net.pt").write_bytes(junk)
    assert checkpoint.load(tmp_path / "net.pt") is None
    assert not (tmp_path / "net.pt").exists()


@pytest.mark.parametrize("said", [OSError(5, "Input/output error"), None])
def test_what_the_machine_cannot_read_stays(tmp_path, monkeypatch, said):
    """A disk that does not answer, or no memory: the same training may go on from it tomorrow."""
    path = tmp_path / "net.pt"
    checkpoint.save(path, STATE)
    if said:
        monkeypatch.setattr(Path, "read_bytes", partial(fail, said))
    else:
        memory_error = RuntimeError("DefaultCPUAllocator: can't allocate memory: you tried 9 bytes")
        monkeypatch.setattr(torch, "load", partial(fail, memory_error))
    with pytest.raises((OSError, MemoryError)):
        checkpoint.load(path)
    assert path.exists()


def fail(error, *_, **__):
    raise error


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "net.pt").mkdir()
    with pytest.raises(BadArtifact, match=r"net\.pt: cannot be written"):
        checkpoint.save(tmp_path / "net.pt", STATE)
