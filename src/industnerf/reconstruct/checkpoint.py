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

from industnerf.artifacts.whole import written_whole
from industnerf.errors import BadArtifact

MAGIC = b"industnerf checkpoint 1\n"
Origin = Mapping[str, str]  # a digest of each thing that a run depends on, by name


def save(path: Path, state: dict[str, Any], origin: Origin) -> None:
    """Write `state`; raises BadArtifact if `path` cannot be written.

    A state that holds more than plain data is refused here, not when someone wants to go on.
    """
    blob = io.BytesIO()
    torch.save(state, blob)
    payload = blob.getvalue()
    _plain(payload)
    head = {"origin": dict(origin), "state": hashlib.sha256(payload).hexdigest()}
    with written_whole(path) as draft:
        draft.write_bytes(MAGIC + json.dumps(head).encode() + b"\n" + payload)


def load(path: Path, origin: Origin) -> dict[str, Any]:
    """The state in `path`; raises BadArtifact if it is torn, or of another run than `origin`.

    Nothing but plain data is unpickled, so a file from elsewhere can run no code.
    """
    head, payload = _parts(path)
    if hashlib.sha256(payload).hexdigest() != head["state"]:
        raise BadArtifact(f"{path} is torn: its state is incomplete; --fresh starts anew")
    other = [name for name in origin if head["origin"].get(name) != origin[name]]
    if other:
        raise BadArtifact(
            f"{path} belongs to another run: {', '.join(other)} differ; --fresh drops it and "
            "starts anew, --checkpoint names another file"
        )
    return _plain(payload)


def _plain(payload: bytes) -> dict[str, Any]:
    return torch.load(io.BytesIO(payload), map_location="cpu", weights_only=True)


def is_checkpoint(path: Path) -> bool:
    """Whether the file starts as ours do, torn or not: what else may be there is not ours."""
    with path.open("rb") as file:
        start = file.read(len(MAGIC))
    return MAGIC.startswith(start)


def _parts(path: Path) -> tuple[dict[str, Any], bytes]:
    magic, _, rest = path.read_bytes().partition(b"\n")
    line, _, payload = rest.partition(b"\n")
    try:
        head = json.loads(line)
        if magic + b"\n" == MAGIC and {"origin", "state"} <= head.keys():
            return head, payload
    except (ValueError, AttributeError):
        pass
    raise BadArtifact(f"{path} is torn, or no checkpoint; --fresh starts anew")
