"""Where a run stands, in one file, bound to what it was made from.

line 1   what the file is
line 2   JSON: the digests of what the run was given, and the digest of the state
then     the state, by torch.save: tensors, numbers, texts, lists and dicts, and nothing else
"""

import hashlib
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from industnerf.artifacts.files import atomic_write
from industnerf.errors import BadArtifact

MAGIC = b"industnerf checkpoint 1\n"
Fingerprint = Mapping[str, str]  # a digest of each thing that a run depends on, by name


def save(path: Path, state: dict[str, Any], fingerprint: Fingerprint) -> None:
    """Write `state`; raises BadArtifact if `path` cannot be written.

    A state that holds more than plain data is refused here, not when someone wants to go on.
    """
    buffer = io.BytesIO()
    torch.save(state, buffer)
    payload = buffer.getvalue()
    _load_weights_only(payload)
    header = {"origin": dict(fingerprint), "state": hashlib.sha256(payload).hexdigest()}
    with atomic_write(path) as draft:
        draft.write_bytes(MAGIC + json.dumps(header).encode() + b"\n" + payload)


def load(path: Path, fingerprint: Fingerprint) -> dict[str, Any]:
    """The state in `path`; raises BadArtifact if it is torn, or of another run than `origin`.

    Nothing but plain data is unpickled, so a file from elsewhere can run no code.
    """
    header, payload = _read_header(path)
    if hashlib.sha256(payload).hexdigest() != header["state"]:
        raise BadArtifact(f"{path} is torn: its state is incomplete; --no-resume starts anew")
    mismatched = [name for name in fingerprint if header["origin"].get(name) != fingerprint[name]]
    if mismatched:
        raise BadArtifact(
            f"{path} belongs to another run: {', '.join(mismatched)} differ; --no-resume drops it and "
            "starts anew, --checkpoint names another file"
        )
    return _load_weights_only(payload)


def _load_weights_only(payload: bytes) -> dict[str, Any]:
    return torch.load(io.BytesIO(payload), map_location="cpu", weights_only=True)


def is_checkpoint(path: Path) -> bool:
    """Whether the file starts as ours do, torn or not: what else may be there is not ours."""
    with path.open("rb") as file:
        start = file.read(len(MAGIC))
    return MAGIC.startswith(start)


def _read_header(path: Path) -> tuple[dict[str, Any], bytes]:
    magic, _, rest = path.read_bytes().partition(b"\n")
    header_line, _, payload = rest.partition(b"\n")
    try:
        header = json.loads(header_line)
        if magic + b"\n" == MAGIC and {"origin", "state"} <= header.keys():
            return header, payload
    except (ValueError, AttributeError):
        pass
    raise BadArtifact(f"{path} is torn, or no checkpoint; --no-resume starts anew")
