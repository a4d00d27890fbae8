"""A checkpoint is whole, plain and of this run, or a sentence says what it is."""

import pickle

import numpy as np
import pytest
import torch

from industnerf.errors import BadArtifact
from industnerf.reconstruct.checkpoint import MAGIC, is_checkpoint, load, save

STATE = {"step": 7, "level": "coarse", "net": {"w": torch.arange(300.0)}, "seen": [1, 2.5, None]}
FINGERPRINT = {"images": "a", "settings": "b"}


@pytest.fixture
def path(tmp_path):
    save(tmp_path / "c", STATE, FINGERPRINT)
    return tmp_path / "c"


def test_a_state_survives_its_file(path):
    state = load(path, FINGERPRINT)
    torch.testing.assert_close(state.pop("net"), STATE["net"], rtol=0, atol=0)
    assert state == {key: value for key, value in STATE.items() if key != "net"}


@pytest.mark.parametrize("share", [0.0, 0.001, 0.02, 0.5, 0.999])
def test_a_torn_file_is_refused_and_still_ours(path, share):
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(BadArtifact, match=r"c is torn.* --no-resume starts anew"):
        load(path, FINGERPRINT)
    assert is_checkpoint(path)


def test_another_version_is_refused(path):
    path.write_bytes(path.read_bytes().replace(b"checkpoint 1", b"checkpoint 9", 1))
    with pytest.raises(BadArtifact, match="torn, or no checkpoint"):
        load(path, FINGERPRINT)


def test_a_changed_byte_is_seen(path):
    data = bytearray(path.read_bytes())
    data[-100] ^= 1
    path.write_bytes(data)
    with pytest.raises(BadArtifact, match="torn"):
        load(path, FINGERPRINT)


def test_another_runs_checkpoint_is_refused_with_what_differs(path):
    with pytest.raises(BadArtifact, match="another run: settings differ; --no-resume"):
        load(path, FINGERPRINT | {"settings": "c"})
    with pytest.raises(BadArtifact, match="another run: images, seed differ"):
        load(path, {"images": "z", "settings": "b", "seed": "0"})


@pytest.mark.parametrize("content", [b"\x89PNG and more", b"x", MAGIC.replace(b"1", b"9")])
def test_other_files_are_not_ours(tmp_path, content):
    (tmp_path / "photo.png").write_bytes(content)
    assert not is_checkpoint(tmp_path / "photo.png")
    with pytest.raises(BadArtifact, match="torn, or no checkpoint"):
        load(tmp_path / "photo.png", FINGERPRINT)


def test_what_could_not_be_read_back_is_not_written(path):
    """Arrays and objects need code to be unpickled; a file from elsewhere shall run none."""
    before = path.read_bytes()
    for thing in (np.zeros(3), object()):
        with pytest.raises(pickle.UnpicklingError):
            save(path, {"thing": thing}, FINGERPRINT)
    assert path.read_bytes() == before
