"""What a check finds, and how sizes are said."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Finding:
    """What is found at `path`; `fix` is a shell command to be run in the root.

    With a fix something is wrong.  Without one it is worth knowing only, unless `is_unfixable`:
    then the message says what to do.
    """

    path: Path
    message: str
    fix: str = ""
    is_unfixable: bool = False

    @property
    def is_error(self) -> bool:
        return self.is_unfixable or bool(self.fix)


def megabytes(size: int) -> str:
    """Such as `3.1 MB`, in 10^6 bytes."""
    return f"{size / 1e6:.1f} MB"
