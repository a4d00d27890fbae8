"""Documents with a part that is generated: it stands between two comments."""

import re

from industnerf.errors import BadArtifact


def replace_block(text: str, name: str, content: str) -> str:
    """`text` with `content` between `<!-- name -->` and `<!-- end name -->`.

    Raises BadArtifact if there is not just one such place.
    """
    head, _, tail = _split(text, name)
    return f"{head}{content}{tail}"


def read_block(text: str, name: str) -> str:
    """What stands between `<!-- name -->` and `<!-- end name -->`."""
    return _split(text, name)[1]


def _split(text: str, name: str) -> tuple[str, str, str]:
    match = re.fullmatch(rf"(.*<!-- {name} -->\n)(.*)(<!-- end {name} -->.*)", text, re.DOTALL)
    if match is None or text.count(f"<!-- {name} -->") != 1:
        raise BadArtifact(
            f"there must be one place between <!-- {name} --> and <!-- end {name} -->"
        )
    return match[1], match[2], match[3]
