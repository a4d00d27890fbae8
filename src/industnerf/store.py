"""The content-addressed store: one folder per finished result, whole or absent.

    <root>/<step>/<key>/out/...      what the step wrote, read-only
    <root>/<step>/<key>/cost.json    what it cost; never part of a key, never hashed

`dvc repro`, sweeps and workers on other machines share it.  A key is a hash of the step, its
parameters, its code and the content of its inputs.  Not in it are the libraries and the kind of
processor: on another, the same entry may differ in its last digits.
"""

import hashlib
import json
import os
import re
import shutil
import socket
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from industnerf import environment
from industnerf.code import code_digest


@dataclass(frozen=True)
class Cost:
    """What making one result took."""

    seconds: float
    peak_mb: float
    device: str
    aside_s: float = 0.0  # further seconds, for what only the tables ask for: pictures of Table 2


KEY = re.compile(r"[0-9a-f]{32}")


def content_digest(paths: Iterable[Path]) -> str:
    """A digest of files and folders by relative name and content."""
    digest = hashlib.sha256()
    for path in paths:
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        for file in files:
            head = f"{file.relative_to(path.parent)}\n{file.stat().st_size}\n"
            digest.update(head.encode(errors="surrogateescape"))  # names of files are any bytes
            digest.update(file.read_bytes())
    return digest.hexdigest()


def key_of(step: str, settings: Any, modules: Iterable[str], inputs: Iterable[Path]) -> str:
    """The key of the result that the code of `modules` makes from `settings` and `inputs`."""
    text = json.dumps(
        [step, settings, [code_digest(name) for name in modules], content_digest(inputs)],
        sort_keys=True,
        default=asdict,
    )
    return hashlib.sha256(text.encode()).hexdigest()[:32]


class Store:
    """A folder of finished results."""

    def __init__(self, root: Path) -> None:
        self.root = root

    @staticmethod
    def from_environment() -> "Store":
        """The store in INDUSTNERF_STORE, else in `.store` of the current folder."""
        return Store(Path(environment.text("INDUSTNERF_STORE") or ".store").absolute())

    def out(self, step: str, key: str) -> Path:
        """Where the result is, if it is there."""
        return self.root / step / key / "out"

    def has(self, step: str, key: str) -> bool:
        """Whether the result is finished."""
        return self.out(step, key).is_dir()

    def scratch(self, step: str, key: str) -> Path:
        """A folder for what an interrupted result resumes from; gone once the result is there."""
        return self.root / step / f".resume-{key}"

    def cost(self, step: str, key: str) -> Cost | None:
        """What the result cost, or None where that is not known here."""
        path = self.root / step / key / "cost.json"
        return Cost(**json.loads(path.read_text(encoding="utf-8"))) if path.exists() else None

    def put(self, step: str, key: str, make: Callable[[Path], Cost]) -> None:
        """Let `make` fill a folder, then move it into place in one rename.

        A killed process leaves a `.draft-*` folder, never half a result.  If another worker was
        faster, its result stays and this one is dropped: they are equal.
        """
        (self.root / step).mkdir(parents=True, exist_ok=True)
        draft = self.root / step / f".draft-{key}-{socket.gethostname()}-{os.getpid()}"
        shutil.rmtree(draft, ignore_errors=True)
        try:
            (draft / "out").mkdir(parents=True)
            cost = make(draft / "out")
            (draft / "cost.json").write_text(json.dumps(asdict(cost)))
            _flush(draft)
            draft.rename(self.root / step / key)
        except Exception:  # it may have taken from under this one what both resumed from
            if not self.has(step, key):
                raise
        finally:
            shutil.rmtree(draft, ignore_errors=True)
        shutil.rmtree(self.scratch(step, key), ignore_errors=True)

    def place(self, step: str, key: str, target: Path) -> None:
        """Put the result at `target` as read-only links, or as copies across file systems."""
        if target.exists():
            shutil.rmtree(target)
        shutil.copytree(self.out(step, key), target, copy_function=_link_or_copy)


def _link_or_copy(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def _flush(folder: Path) -> None:
    """Make every file read-only and force it to disk, so that a rename never outruns its data."""
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            path.chmod(0o444)
            descriptor = os.open(path, os.O_RDONLY)
            os.fsync(descriptor)
            os.close(descriptor)
