"""The content-addressed store: one folder per finished result, whole or absent.

    <root>/<step>/<key>/out/...          what the step wrote, read-only
    <root>/<step>/<key>/cost.json        what it cost; never part of a key
    <root>/<step>/<key>/origin.json      with what it was made; never part of a key
    <root>/<step>/<key>/manifest.json    what all of it is, see `manifest.py`
    <root>/<step>/.damaged-<key>-<time>  what was found otherwise, for whoever wants to know why

`dvc repro`, sweeps and workers on other machines share it.  A key is a hash of the step, its
parameters, its code, the versions of the libraries which that imports, and the content of its
inputs.  Not in it are processor and GPU: where these round differently, reports say so.
"""

import fcntl
import hashlib
import json
import os
import re
import shutil
import socket
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from industnerf import environment
from industnerf.code_hash import code_digest, library_versions
from industnerf.content import RecordedDigests, content_digest
from industnerf.manifest import find_damage, fsync, read_contents, write_manifest
from industnerf.origin import Origin


@dataclass(frozen=True)
class Cost:
    """What making one result took.

    Processor seconds are those of all threads, and of child processes that have ended: a busy
    machine does not double them.  Results of older code lack them.
    """

    seconds: float  # by the clock on the wall
    peak_mb: float
    device: str
    extra_seconds: float = 0.0  # further ones, for what only tables ask for: pictures of Table 2
    cpu_seconds: float | None = None  # user and system time
    extra_cpu_seconds: float | None = None  # likewise, of `extra_seconds`

    @property
    def processor_seconds(self) -> float:
        """`cpu_seconds`, or the wall seconds of an older result."""
        return self.seconds if self.cpu_seconds is None else self.cpu_seconds

    @property
    def extra_processor_seconds(self) -> float:
        """`extra_cpu_seconds`, or the wall seconds of an older result."""
        return self.extra_seconds if self.extra_cpu_seconds is None else self.extra_cpu_seconds


KEY_PATTERN = re.compile(r"[0-9a-f]{32}")


def store_key(
    stage: str,
    settings: Any,
    modules: tuple[str, ...],
    inputs: Iterable[Path],
    recorded: RecordedDigests | None = None,
) -> str:
    """The key of the result that the code of `modules` makes from `settings` and `inputs`.

    Of inputs whose digest is `recorded` nothing is read.  Builds of one version of a library, such
    as those for a CPU and for a GPU, are not told apart.
    """
    code = [code_digest(name) for name in modules]
    libraries = {
        name: version.partition("+")[0] for name, version in library_versions(modules).items()
    }
    text = json.dumps(
        [stage, settings, code, libraries, content_digest(inputs, recorded)],
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
        """The store in INDUSTNERF_STORE, else in `.store`; both relative to the main checkout."""
        name = environment.get_str("INDUSTNERF_STORE") or ".store"
        return Store(environment.main_checkout() / name)

    def result_path(self, stage: str, key: str) -> Path:
        """Where the result is, if it is there."""
        return self.root / stage / key / "out"

    def has(self, stage: str, key: str) -> bool:
        """Whether the result is finished and whole; a damaged one is set aside, and it is said."""
        entry = self.root / stage / key
        with suppress(FileNotFoundError):  # another process sets it aside
            damage = find_damage(entry) if entry.is_dir() else ""
            if not damage:
                return entry.is_dir()
            aside = entry.with_name(f".damaged-{key}-{time.time_ns()}")
            entry.rename(aside)  # not removed: it may tell what happened
            if not find_damage(aside):  # another process has made it anew meanwhile
                aside.rename(entry)
                return True
            message = f"store: a damaged result is set aside and made anew: {aside}: it {damage}"
            print(message, file=sys.stderr)
        return False

    def scratch_dir(self, stage: str, key: str) -> Path:
        """A folder for what an interrupted result resumes from; gone once the result is there."""
        return self.root / stage / f".resume-{key}"

    def cost(self, stage: str, key: str) -> Cost | None:
        """What the result cost, or None where that is not known here."""
        try:
            text = (self.root / stage / key / "cost.json").read_text(encoding="utf-8")
            return Cost(**json.loads(text))
        except (OSError, ValueError, TypeError):  # gone or torn since the result was used
            return None

    def origin(self, stage: str, key: str) -> Origin | None:
        """With what the result was made, or None where that is not known here."""
        return Origin.load(self.root / stage / key)

    def contents(self, stage: str, key: str) -> dict[str, str]:
        """The digest of each file and folder of the result, and of each in an archive of it."""
        return read_contents(self.root / stage / key)

    def put(
        self,
        stage: str,
        key: str,
        make: Callable[[Path], Cost],
        libraries: Mapping[str, str] | None = None,
    ) -> None:
        """Let `make`, which uses `libraries`, fill a folder; move it into place in one rename.

        A killed process leaves a `.draft-*` folder, never half a result.  If another worker was
        faster, its result stays and this one is dropped: they are equal.
        """
        (self.root / stage).mkdir(parents=True, exist_ok=True)
        draft = self.root / stage / f".draft-{key}-{socket.gethostname()}-{os.getpid()}"
        shutil.rmtree(draft, ignore_errors=True)
        try:
            (draft / "out").mkdir(parents=True)
            cost = make(draft / "out")
            (draft / "cost.json").write_text(json.dumps(asdict(cost)))
            Origin.here(libraries or {}).save(draft)
            write_manifest(draft)
            self.has(stage, key)  # a damaged one must not stand in the way
            draft.rename(self.root / stage / key)
            fsync(self.root / stage)
        except Exception:  # it may have taken from under this one what both resumed from
            if not self.has(stage, key):
                raise
        finally:
            shutil.rmtree(draft, ignore_errors=True)
        shutil.rmtree(self.scratch_dir(stage, key), ignore_errors=True)

    def checkout(self, stage: str, key: str, target: Path) -> None:
        """Put the result at `target`: clones, links or copies, by what the disk can do."""
        if target.exists():
            shutil.rmtree(target)
        shutil.copytree(self.result_path(stage, key), target, copy_function=_clone_link_or_copy)


FICLONE = 0x40049409  # linux/fs.h: another file of the same blocks, until one of them is written to


def _clone_link_or_copy(source: str, target: str) -> None:
    """Links last: whoever may write to read-only files writes through them into the store."""
    try:
        with open(source, "rb") as original, open(target, "xb") as clone:
            fcntl.ioctl(clone, FICLONE, original.fileno())
        shutil.copystat(source, target)
        return
    except OSError:  # XFS and Btrfs can, ext4 cannot
        Path(target).unlink(missing_ok=True)
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)
