"""Generated blocks of documents: what stands between two comments is written, the rest is kept."""

import re
from collections.abc import Mapping
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.errors import BadArtifact


def replace_block(text: str, name: str, content: str) -> str:
    """`text` with `content` between `<!-- name -->` and `<!-- end name -->`.

    Raises BadArtifact if there is not exactly one such place.
    """
    head, _, tail = _split(text, name)
    return f"{head}{content}{tail}"


def read_block(text: str, name: str) -> str:
    """What stands between `<!-- name -->` and `<!-- end name -->`; raises as `replace_block`."""
    return _split(text, name)[1]


def write_blocks(path: Path, blocks: Mapping[str, str]) -> None:
    """Replace the named blocks of the document at `path`; raises as `replace_block`."""
    text = path.read_text(encoding="utf-8")
    for name, content in blocks.items():
        text = replace_block(text, name, content)
    write_text(path, text)


def _split(text: str, name: str) -> tuple[str, str, str]:
    match = re.fullmatch(rf"(.*<!-- {name} -->\n)(.*)(<!-- end {name} -->.*)", text, re.DOTALL)
    if match is None or text.count(f"<!-- {name} -->") != 1:
        raise BadArtifact(
            f"there must be one place between <!-- {name} --> and <!-- end {name} -->"
        )
    return match[1], match[2], match[3]
