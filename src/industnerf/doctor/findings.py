"""What a check finds, and how sizes are said."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Finding:
    """Something about `where`: `what` says how much, `mend` is a shell command for the root.

    With a command something is wrong, and it mends that; without one it is worth knowing only,
    unless it is `wrong` in a way that only its text can help with.
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
